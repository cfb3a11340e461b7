#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "daemon/store.hpp"
#include "drivers/replay/trajectory_file.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/povslam/replay_output.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

const std::filesystem::path kSequence = POVSLAM_TEST_DATA "/tum_fr1_rpy";

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code = -1;
  std::string output, errors;
};

Outcome run(std::vector<std::string> arguments) {
  CLI::App app;
  Outcome outcome;
  add_replay(app, outcome.exit_code);
  arguments.insert(arguments.begin(), "replay");
  std::reverse(arguments.begin(), arguments.end());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    outcome.errors = error.what();
  }
  outcome.output = testing::internal::GetCapturedStdout();
  outcome.errors += testing::internal::GetCapturedStderr();
  return outcome;
}

class Replay : public testing::Test {
 protected:
  std::filesystem::path out(const std::string& name) { return folder_.path() / name; }
  Outcome replay(const std::string& name, std::vector<std::string> more = {}) {
    std::vector<std::string> arguments = {kSequence.string(), "--camera", "tum1", "--out", out(name).string()};
    arguments.insert(arguments.end(), more.begin(), more.end());
    return run(arguments);
  }
  TempFolder folder_;
};

TEST_F(Replay, GivesTheSameBytesTwice) {
  ASSERT_EQ(replay("a").exit_code, 0);
  ASSERT_EQ(replay("b").exit_code, 0);
  int compared = 0;
  for (const auto& file : std::filesystem::directory_iterator(out("a"))) {
    const std::string name = file.path().filename().string();
    if (name == "metrics.json") continue;
    EXPECT_EQ(content(out("a") / name), content(out("b") / name)) << name;
    ++compared;
  }
  EXPECT_GE(compared, 3);  // both trajectories and the picture
}

TEST_F(Replay, WritesEveryTrackedFrameAndItsFigures) {
  const Outcome outcome = replay("a");
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto metrics = nlohmann::json::parse(content(out("a") / "metrics.json"));
  const auto published = read_trajectory(out("a") / "trajectory.txt");
  const auto smoothed = read_trajectory(out("a") / "trajectory_smoothed.txt");
  ASSERT_TRUE(published && smoothed);
  EXPECT_EQ(metrics["frames"], metrics["tracked"].get<int>() + metrics["lost"].get<int>());
  EXPECT_EQ(published->size(), metrics["tracked"].get<std::size_t>());
  EXPECT_EQ(smoothed->size(), published->size());
  EXPECT_EQ(metrics["stages_ms"]["total"]["count"], metrics["frames"]);
  EXPECT_GE(metrics["stages_ms"]["total"]["max"], metrics["stages_ms"]["total"]["median"]);
  EXPECT_GT(metrics["peak_rss_mb"], 1.0);
  EXPECT_GT(metrics["views"]["understood"], 0);
  EXPECT_EQ(metrics["labels"]["missing"], 0) << "nobody labels";
  EXPECT_THAT(outcome.output, testing::HasSubstr(std::to_string(published->size()) + " tracked"));
  EXPECT_TRUE(std::filesystem::exists(out("a") / "trajectory.png"));
}

TEST_F(Replay, StartsLevelAtTheOriginOrWhereItIsTold) {
  ASSERT_EQ(replay("a", {"--frames", "0:2"}).exit_code, 0);
  const auto level = read_trajectory(out("a") / "trajectory.txt");
  ASSERT_TRUE(level);
  EXPECT_EQ(level->size(), 2u);
  EXPECT_LT(level->front().T_world_sensor.translation.norm(), 1e-9);
  EXPECT_LT((level->front().T_world_sensor.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d::UnitX()).norm(),
            1e-6);
  ASSERT_EQ(replay("b", {"--frames", "0:2", "--start", "1 2 3 0 0 0 1"}).exit_code, 0);
  const auto told = read_trajectory(out("b") / "trajectory.txt");
  ASSERT_TRUE(told);
  EXPECT_LT((told->front().T_world_sensor.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-6);
  EXPECT_LT(told->front().T_world_sensor.rotation.vec().norm(), 1e-6);
}

TEST_F(Replay, CountsAFrameWithoutDepthAsMissing) {
  const std::filesystem::path copy = folder_.path() / "copy";
  std::filesystem::copy(kSequence, copy, std::filesystem::copy_options::recursive);
  std::istringstream lines(content(kSequence / "depth.txt"));
  std::ofstream rest(copy / "depth.txt");
  int number = 0;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with('#') || ++number != 3) rest << line << '\n';
  }
  rest.close();
  ASSERT_EQ(run({copy.string(), "--camera", "tum1", "--out", out("a").string()}).exit_code, 0);
  ASSERT_EQ(replay("b").exit_code, 0);
  const auto metrics = nlohmann::json::parse(content(out("a") / "metrics.json"));
  const auto whole = nlohmann::json::parse(content(out("b") / "metrics.json"));
  EXPECT_EQ(metrics["frames"].get<int>() + 1, whole["frames"].get<int>());
  EXPECT_EQ(metrics["dropped"]["gap"].get<int>(), 1);
  EXPECT_EQ(whole["dropped"]["gap"].get<int>(), 0);
}

TEST_F(Replay, InRealTimeRunsTheDaemonsThreadsOverTheSameFrames) {
  const Outcome outcome = replay("a", {"--realtime"});
  ASSERT_EQ(outcome.exit_code, 0) << outcome.errors;
  const auto metrics = nlohmann::json::parse(content(out("a") / "metrics.json"));
  const auto published = read_trajectory(out("a") / "trajectory.txt");
  ASSERT_TRUE(published);
  EXPECT_EQ(published->size(), metrics["tracked"].get<std::size_t>());
  int dropped = 0;
  for (const auto& count : metrics["dropped"]) dropped += count.get<int>();
  const auto reference = replay("b");
  const auto whole = nlohmann::json::parse(content(out("b") / "metrics.json"));
  EXPECT_EQ(metrics["frames"].get<int>() + dropped, whole["frames"].get<int>());
}

TEST_F(Replay, GoesOnWithAMapOnDiskAndGivesTheSameBytesFromTheSameMap) {
  const auto map = [this](const char* name) { return (folder_.path() / name).string(); };
  ASSERT_EQ(replay("a", {"--map", map("a.db")}).exit_code, 0);
  const auto store = MapStore::open(map("a.db"), StoreMode::read_only);
  ASSERT_TRUE(store) << store.error().message;
  std::filesystem::copy_file(map("a.db"), map("b.db"));
  ASSERT_EQ(replay("b", {"--map", map("a.db")}).exit_code, 0);
  ASSERT_EQ(replay("c", {"--map", map("b.db")}).exit_code, 0);
  EXPECT_EQ(content(out("b") / "trajectory.txt"), content(out("c") / "trajectory.txt"));
  ASSERT_EQ(replay("d", {"--map", map("a.db"), "--realtime"}).exit_code, 0);
}

TEST_F(Replay, DoesNotStartOnAMapInUse) {
  const std::string map = (folder_.path() / "map.db").string();
  const auto other = MapStore::open(map, StoreMode::read_write);
  ASSERT_TRUE(other);
  for (const auto& more : {std::vector<std::string>{"--map", map}, {"--map", map, "--realtime"}}) {
    const Outcome outcome = replay("a", more);
    EXPECT_EQ(outcome.exit_code, 1);
    EXPECT_THAT(outcome.errors, testing::HasSubstr("another povslam process uses this map"));
  }
}

TEST_F(Replay, NeverWritesIntoOrAroundASequence) {
  for (const std::filesystem::path& place : {kSequence, kSequence / "results", kSequence.parent_path()}) {
    const Outcome outcome = run({kSequence.string(), "--camera", "tum1", "--out", place.string()});
    EXPECT_EQ(outcome.exit_code, 2);
    EXPECT_THAT(outcome.errors, testing::HasSubstr("--out"));
  }
  EXPECT_FALSE(std::filesystem::exists(kSequence / "results"));
  EXPECT_TRUE(make_output_folder(out("beside"), kSequence));
}

TEST_F(Replay, SaysWhichKeyNamesTheNetworkThatIsMissing) {
  const Outcome none = replay("n", {"--labels", "dnn"});
  EXPECT_EQ(none.exit_code, 1);
  EXPECT_THAT(none.errors, testing::HasSubstr("network.file: "));
  const std::string file = out("no.onnx").string();
  std::ofstream(file) << "no network";
  for (const bool realtime : {false, true}) {
    std::vector<std::string> more = {"--set", "understanding.labels=dnn", "--set", "network.file=" + file};
    if (realtime) more.emplace_back("--realtime");
    const Outcome broken = replay("n", more);
    EXPECT_EQ(broken.exit_code, 1);
    EXPECT_THAT(broken.errors, testing::HasSubstr("network.file: " + file));
  }
}

TEST_F(Replay, TellsBadUsageFromFailure) {
  EXPECT_EQ(replay("a", {"--set", "orb.num_levels=99"}).exit_code, 2);
  EXPECT_EQ(replay("a", {"--start", "here"}).exit_code, 2);
  EXPECT_EQ(replay("a", {"--frames", "x"}).exit_code, 2);
  EXPECT_THAT(replay("a", {"--mode", "mid"}).errors, testing::HasSubstr("--mode"));
  const Outcome missing = run({out("nothing").string(), "--out", out("a").string()});
  EXPECT_EQ(missing.exit_code, 1);
  EXPECT_THAT(missing.errors, testing::HasSubstr("nothing"));
}

}  // namespace
}  // namespace povslam
