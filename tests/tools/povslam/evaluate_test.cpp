#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>

#include "tools/povslam/subcommands.hpp"

#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

// A sequence of 30 frames: the camera stands 1 m high and looks along world x at a box 3 m away that leaves after frame
// 10 (seen from frame 15 on); behind it a wall at 5 m.
class Evaluate : public ::testing::Test {
 protected:
  static constexpr int kWidth = 64, kHeight = 48, kFrames = 30;

  void SetUp() override {
    folder_ = temp_folder() /
              (std::string("povslam_evaluate_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    for (const char* name : {"rgb", "depth", "instance"}) std::filesystem::create_directories(folder_ / name);
    write("camera.yaml", "width: 64\nheight: 48\nfx: 50\nfy: 50\ncx: 31.5\ncy: 23.5\ndepth_scale: 1000\nfps: 10\n");
    write("objects_truth.json",
          R"({"t0":0,"lap1_end":1.05,"objects":[{"id":1,"class":"box","size":[0.5,1,1],"change":"removed",)"
          R"("switch_time":1.2,"before":{"present":true,"position":[3.25,0,1],"yaw":0},"after":{"present":false}}]})");
    for (int i = 0; i < kFrames; ++i) add_frame(i);
    write("rgb.txt", rgb_);
    write("depth.txt", depth_);
    write("groundtruth.txt", truth_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  void add_frame(int i) {
    const bool there = i < 15;
    cv::Mat depth(kHeight, kWidth, CV_16U, cv::Scalar(5000)), instance(kHeight, kWidth, CV_16U, cv::Scalar(0));
    const cv::Rect box(23, 15, 18, 18);
    if (there) depth(box) = cv::Scalar(3000);
    if (there) instance(box) = cv::Scalar(1);
    const std::string name = std::to_string(100 + i) + ".png", stamp = std::to_string(0.1 * i);
    cv::imwrite((folder_ / "rgb" / name).string(), cv::Mat(kHeight, kWidth, CV_8UC3, cv::Scalar(9, 9, 9)));
    cv::imwrite((folder_ / "depth" / name).string(), depth);
    cv::imwrite((folder_ / "instance" / name).string(), instance);
    rgb_ += stamp + " rgb/" + name + "\n";
    depth_ += stamp + " depth/" + name + "\n";
    truth_ += stamp + " 0 0 1 -0.5 0.5 -0.5 0.5\n";
  }

  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }

  // Exit code as main gives it.
  int run(std::vector<std::string> words) {
    CLI::App app;
    int exit_code = 0;
    add_evaluate(app, exit_code);
    words.insert(words.begin(), "evaluate");
    std::reverse(words.begin(), words.end());
    try {
      app.parse(words);
    } catch (const CLI::ParseError&) {
      return 2;
    }
    return exit_code;
  }
  nlohmann::json scores(std::vector<std::string> words) {
    const std::string out = (folder_ / "scores.json").string();
    words.insert(words.end(), {"--out", out});
    EXPECT_EQ(run(words), 0);
    return nlohmann::json::parse(std::ifstream(out));
  }

  std::filesystem::path folder_;
  std::string rgb_, depth_, truth_;
};

}  // namespace

TEST_F(Evaluate, ARemovalSeenOftenEnoughIsAskedFor) {
  const std::string right =
      write("events.jsonl", R"({"type":"removed","class":"box","position":[3.3,0,1],"yaw":0,"size":[0.5,1,1]})");
  const std::string none = write("none.jsonl", "");
  EXPECT_EQ(scores({"--truth", folder_.string(), "--events", right})["events"]["recall"], 1.0);
  EXPECT_EQ(scores({"--truth", folder_.string(), "--events", none})["events"]["truth"], 1);
}

TEST_F(Evaluate, SurfaceOfTheLastLapIsComparedWithTheMap) {
  const std::string header =
      "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float z\nend_header\n";
  write("final_surface.ply", header + "5 0 1\n5 0 40\n");  // the second was never in view
  const std::string map = write("map.ply", header + "5 0 1.02\n4 0 1\n");
  const auto voxels = scores({"--truth", folder_.string(), "--map", map})["voxels"];
  EXPECT_EQ(voxels["recall"], 1.0);
  EXPECT_EQ(voxels["precision"], 0.5);
}

TEST_F(Evaluate, TheTrueTrajectoryScoresZeroAndCoversEveryFrame) {
  const std::string gt = (folder_ / "groundtruth.txt").string();
  const auto figures = scores({"--gt", gt, "--traj", gt, "--truth", folder_.string()})["trajectory"];
  EXPECT_NEAR(figures["first_fixed"]["ate_rmse_m"].get<double>(), 0.0, 1e-12);
  EXPECT_EQ(figures["frames"]["coverage"], 1.0);
  EXPECT_EQ(figures["first_fixed"]["lap1"]["poses"], 11);
}

TEST_F(Evaluate, TheFramesListDecidesWhatIsMissing) {
  const std::string traj = write("half.txt", truth_.substr(0, truth_.size() / 2));
  EXPECT_EQ(scores({"--traj", traj, "--truth", folder_.string()})["trajectory"]["frames"]["coverage"], 0.5);
}

TEST_F(Evaluate, BadUsageIsTwoAndABadFileIsOne) {
  const std::string gt = (folder_ / "groundtruth.txt").string();
  EXPECT_EQ(run({}), 2);
  EXPECT_EQ(run({"--traj", gt}), 2);
  EXPECT_EQ(run({"--events", gt}), 2);
  EXPECT_EQ(run({"--gt", gt, "--traj", gt, "--align", "sideways"}), 2);
  EXPECT_EQ(run({"--gt", gt, "--traj", gt, "--nonsense"}), 2);
  EXPECT_EQ(run({"--gt", gt, "--traj", (folder_ / "missing.txt").string()}), 1);
  EXPECT_EQ(run({"--gt", gt, "--traj", write("bad.txt", "1 2 3\n")}), 1);
  EXPECT_EQ(run({"--truth", folder_.string(), "--events", write("bad.jsonl", "{")}), 1);
  EXPECT_EQ(run({"--truth", folder_.string(), "--map", write("bad.ply", "ply\n")}), 1);
  EXPECT_EQ(run({"--gt", gt, "--traj", gt, "--plot", "/nowhere/at/all.png"}), 1);
}

}  // namespace povslam
