#include "tools/povslam/simulate.hpp"

#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "drivers/synthetic/world.hpp"

#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace fs = std::filesystem;

namespace {

class Simulate : public testing::Test {
 protected:
  void SetUp() override {
    root_ = temp_folder() / (std::string("simulate_") + testing::UnitTest::GetInstance()->current_test_info()->name());
    fs::remove_all(root_);
    fs::create_directories(root_);
  }
  void TearDown() override { fs::remove_all(root_); }

  SimulateOptions small(const char* folder, const char* scene = "boxsim") const {
    SimulateOptions options;
    options.world.scene = scene;
    options.world.camera = {96, 72, 78.75, 78.75, 47.5, 35.5, {}};
    options.world.fps = 15.0;
    options.world.frames = 4;
    options.world.labels = options.world.lidar = true;
    options.world.start_time_s = 1305031102.25;
    options.out = (root_ / folder).string();
    return options;
  }

  fs::path root_;
};

std::string content(const fs::path& file) {
  std::ifstream stream(file, std::ios::binary);
  return {std::istreambuf_iterator<char>(stream), {}};
}

std::vector<std::string> lines(const fs::path& file) {
  std::istringstream text(content(file));
  std::vector<std::string> all;
  for (std::string line; std::getline(text, line);) {
    if (!line.starts_with('#')) all.push_back(line);
  }
  return all;
}

}  // namespace

TEST_F(Simulate, WritesAWholeSequence) {
  const SimulateOptions options = small("a");
  ASSERT_EQ(run_simulate(options), 0);
  const fs::path out = options.out;
  EXPECT_EQ(lines(out / "rgb.txt").at(1), "1305031102.316667 rgb/000001.png");
  EXPECT_EQ(lines(out / "associations.txt").size(), 4U);
  EXPECT_EQ(lines(out / "label.txt").size(), 4U);
  EXPECT_EQ(lines(out / "lidar.txt").size(), 3U);
  EXPECT_EQ(lines(out / "classes.csv").at(0), "id,name,kind");
  EXPECT_NE(content(out / "camera.yaml").find("fx: 78.75\n"), std::string::npos);
  EXPECT_NE(content(out / "sensors.yaml").find("T_body_lidar:"), std::string::npos);
  const cv::Mat rgb = cv::imread((out / "rgb/000003.png").string(), cv::IMREAD_UNCHANGED);
  const cv::Mat depth = cv::imread((out / "depth/000003.png").string(), cv::IMREAD_UNCHANGED);
  const cv::Mat label = cv::imread((out / "label/000003.png").string(), cv::IMREAD_UNCHANGED);
  const cv::Mat instance = cv::imread((out / "instance/000003.png").string(), cv::IMREAD_UNCHANGED);
  EXPECT_EQ(rgb.type(), CV_8UC3);
  EXPECT_EQ(depth.type(), CV_16UC1);
  EXPECT_EQ(label.type(), CV_8UC1);
  EXPECT_EQ(instance.type(), CV_16UC1);
  EXPECT_EQ(depth.cols, 96);
}

TEST_F(Simulate, WritesTheTruthOfPosesAndObjects) {
  const SimulateOptions options = small("a");
  ASSERT_EQ(run_simulate(options), 0);
  const fs::path out = options.out;
  const auto world = synthetic::World::create(options.world);
  ASSERT_TRUE(world);
  std::istringstream pose(lines(out / "groundtruth.txt").at(2));
  double t = 0.0, x = 0.0, y = 0.0, z = 0.0;
  pose >> t >> x >> y >> z;
  const Eigen::Vector3d truth = world->T_world_camera(2.0 / 15.0).translation;
  EXPECT_LT((truth - Eigen::Vector3d(x, y, z)).norm(), 1e-6);
  const nlohmann::json json = nlohmann::json::parse(content(out / "objects_truth.json"));
  EXPECT_EQ(json["objects"].size(), 17U);
  int moved = 0;
  for (const auto& object : json["objects"]) {
    if (object["change"] != "moved") continue;
    ++moved;
    EXPECT_NE(object["before"]["position"], object["after"]["position"]);
    EXPECT_GT(object["switch_time"].get<double>(), json["t0"].get<double>());
  }
  EXPECT_EQ(moved, 6);
  const std::string ply = content(out / "final_surface.ply");
  const std::size_t count = std::stoul(ply.substr(ply.find("vertex ") + 7)), header = ply.find("end_header\n") + 11;
  EXPECT_EQ(ply.size() - header, 24 * count);
  const std::string pcd = content(out / "lidar/000000.pcd");
  const std::size_t points = std::stoul(pcd.substr(pcd.find("POINTS ") + 7)), data = pcd.find("DATA binary\n") + 12;
  EXPECT_GT(points, 1000U);
  EXPECT_EQ(pcd.size() - data, 20 * points);
}

TEST_F(Simulate, WritesTheSameBytesTwice) {
  ASSERT_EQ(run_simulate(small("a", "aisle")), 0);
  ASSERT_EQ(run_simulate(small("b", "aisle")), 0);
  int files = 0;
  for (const auto& entry : fs::recursive_directory_iterator(root_ / "a")) {
    if (!entry.is_regular_file()) continue;
    ++files;
    EXPECT_EQ(content(entry.path()), content(root_ / "b" / fs::relative(entry.path(), root_ / "a"))) << entry.path();
  }
  EXPECT_EQ(files, 4 * 4 + 3 + 11);
}

TEST_F(Simulate, ReplacesOnlyItsOwnSequencesAndOnlyWhenTold) {
  SimulateOptions options = small("a");
  ASSERT_EQ(run_simulate(options), 0);
  EXPECT_EQ(run_simulate(options), 2);
  options.force = true;
  options.world.frames = 2;
  EXPECT_EQ(run_simulate(options), 0);
  EXPECT_FALSE(fs::exists(fs::path(options.out) / "rgb/000003.png"));
  options.out = (root_ / "mine").string();
  fs::create_directories(options.out);
  std::ofstream(fs::path(options.out) / "thesis.txt") << "precious";
  EXPECT_EQ(run_simulate(options), 2);
  EXPECT_EQ(content(fs::path(options.out) / "thesis.txt"), "precious");
}

TEST_F(Simulate, RefusesBadOptions) {
  SimulateOptions options = small("a");
  options.world.scene = "moon";
  EXPECT_EQ(run_simulate(options), 2);
  options = small("a");
  options.world.speed_mps = -1.0;
  EXPECT_EQ(run_simulate(options), 2);
  EXPECT_FALSE(fs::exists(root_ / "a"));
}

}  // namespace povslam
