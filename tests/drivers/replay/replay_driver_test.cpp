#include "drivers/replay/replay_driver.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <opencv2/imgcodecs.hpp>

#include "drivers/replay/trajectory_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

const std::string kReal = std::string(POVSLAM_TEST_DATA) + "/tum_fr1_rpy";
constexpr int kWidth = 24, kHeight = 18;

// A recording of three frames at 1, 2 and 3 s whose colour and depth values say which frame it is.
class Recording : public testing::Test {
 protected:
  void SetUp() override {
    fs::remove_all(folder_);
    write("camera.yaml", "width: 24\nheight: 18\nfx: 20\nfy: 20\ncx: 12\ncy: 9\ndepth_scale: 1000\n");
    write("rgb.txt", "# colour\n1 rgb/1.png\n2 rgb/2.png\n3 rgb/3.png\n");
    write("depth.txt", "1.01 depth/1.png\n2.01 depth/2.png\n3.01 depth/3.png\n");
    for (int i = 1; i <= 3; ++i) {
      image("rgb/" + std::to_string(i) + ".png", CV_8UC3, i);
      image("depth/" + std::to_string(i) + ".png", CV_16UC1, 1000 * i);
    }
  }
  void write(const std::string& name, const std::string& text) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << text;
  }
  void image(const std::string& name, int type, int value) {
    fs::create_directories((folder_ / name).parent_path());
    ASSERT_TRUE(cv::imwrite((folder_ / name).string(), cv::Mat(kHeight, kWidth, type, cv::Scalar::all(value))));
  }

  struct Run {
    std::string open_error;
    DriverSetup setup;
    std::vector<std::string> frames;  // "kind sensor stamp_s"
    std::vector<std::string> bad;
    SensorFrame last;
  };
  Run run(DriverOptions options = {}) {
    options.try_emplace("path", folder_.string());
    Run run;
    auto driver = make_replay_driver(options);
    if (!driver) return run.open_error = driver.error().message, std::move(run);
    const auto setup = (*driver)->open();
    if (!setup) return run.open_error = setup.error().message, std::move(run);
    run.setup = *setup;
    for (;;) {
      const Next next = (*driver)->next(run.last);
      if (next.kind == Next::Kind::bad) run.bad.push_back(next.message);
      if (next.kind == Next::Kind::frame) {
        const char* kinds[] = {"rgbd", "lidar", "labels"};
        run.frames.push_back(std::string(kinds[static_cast<int>(run.last.kind)]) + " " +
                             std::to_string(run.last.sensor) + " " + std::to_string(run.last.stamp() / kNsPerMs) +
                             " ms");
      }
      if (next.kind == Next::Kind::end || next.kind == Next::Kind::failed) break;
    }
    return run;
  }

  fs::path folder_ = temp_folder() / "povslam_replay_test";
};

}  // namespace

TEST(RealRecording, IsReadAsDownloaded) {
  auto driver = make_replay_driver({{"path", kReal}, {"camera", "tum1"}});
  ASSERT_TRUE(driver);
  const auto setup = (*driver)->open();
  ASSERT_TRUE(setup) << setup.error().message;
  EXPECT_EQ(setup->num_frames, 5U);
  EXPECT_EQ(setup->sensors.size(), 1U);
  EXPECT_FALSE(setup->paced);
  SensorFrame frame;
  ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
  EXPECT_EQ(frame.rgbd.stamp, 1305031229528748000);
  EXPECT_EQ(frame.rgbd.depth_stamp, 1305031229528784000);
  EXPECT_EQ(frame.rgbd.depth_scale, 5000.0F);
  const cv::Mat color = cv::imread(kReal + "/rgb/1305031229.528748.png");
  const cv::Mat depth = cv::imread(kReal + "/depth/1305031229.528784.png", cv::IMREAD_UNCHANGED);
  for (int y = 0; y < 480; y += 7) {
    for (int x = 0; x < 640; x += 11) {
      const auto bgr = color.at<cv::Vec3b>(y, x);
      ASSERT_EQ(frame.rgbd.color.at(x, y, 0), bgr[2]);
      ASSERT_EQ(frame.rgbd.color.at(x, y, 2), bgr[0]);
      ASSERT_EQ(frame.rgbd.depth.at(x, y), depth.at<std::uint16_t>(y, x));
    }
  }
  TimeNs last = frame.rgbd.stamp;
  const std::uint8_t* buffer = frame.rgbd.color.data();
  for (int i = 1; i < 5; ++i) {
    ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
    EXPECT_EQ(frame.rgbd.seq, static_cast<std::uint64_t>(i));
    EXPECT_EQ(frame.rgbd.color.data(), buffer) << "buffers are kept";
    EXPECT_GT(frame.rgbd.stamp, last);
    last = frame.rgbd.stamp;
    const auto truth = read_trajectory(kReal + "/groundtruth.txt");
    ASSERT_TRUE(truth);
    EXPECT_TRUE(pose_at(*truth, frame.rgbd.stamp, 0.05));
  }
  EXPECT_EQ((*driver)->next(frame).kind, Next::Kind::end);
  EXPECT_EQ((*driver)->next(frame).kind, Next::Kind::end);
}

TEST_F(Recording, IsReplayedInOrderAndAgainAfterReopening) {
  const Run r = run();
  EXPECT_THAT(r.frames, ElementsAre("rgbd 0 1000 ms", "rgbd 0 2000 ms", "rgbd 0 3000 ms"));
  EXPECT_THAT(r.bad, IsEmpty());
  EXPECT_EQ(r.last.rgbd.color.at(5, 5, 1), 3);
  EXPECT_EQ(r.last.rgbd.depth.at(5, 5), 3000);
  auto driver = make_replay_driver({{"path", folder_.string()}});
  SensorFrame frame;
  for (int round = 0; round < 2; ++round) {
    ASSERT_TRUE((*driver)->open());
    ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
    EXPECT_EQ(frame.rgbd.stamp, kNsPerSecond);
    (*driver)->close();
  }
  EXPECT_EQ((*driver)->next(frame).kind, Next::Kind::failed);
}

TEST_F(Recording, IsCutAsPythonCuts) {
  EXPECT_THAT(run({{"frames", "1:"}}).frames, ElementsAre("rgbd 0 2000 ms", "rgbd 0 3000 ms"));
  EXPECT_THAT(run({{"frames", ":1"}}).frames, ElementsAre("rgbd 0 1000 ms"));
  EXPECT_THAT(run({{"frames", "-2:-1"}}).frames, ElementsAre("rgbd 0 2000 ms"));
  EXPECT_THAT(run({{"frames", "0:99"}}).frames, testing::SizeIs(3));
  EXPECT_THAT(run({{"frames", ":"}}).frames, testing::SizeIs(3));
  EXPECT_THAT(run({{"frames", "2:2"}}).open_error, HasSubstr("none of the 3 frames"));
  EXPECT_THAT(run({{"frames", "5"}}).open_error, HasSubstr("frames = '5'"));
  EXPECT_THAT(run({{"frames", "a:b"}}).open_error, HasSubstr("A:B"));
}

TEST_F(Recording, RefusesOptionsItDoesNotUnderstand) {
  EXPECT_THAT(run({{"speed", "2"}}).open_error, HasSubstr("unknown key 'speed'; known are path"));
  EXPECT_THAT(run({{"realtime", "yes"}}).open_error, HasSubstr("true or false"));
  EXPECT_THAT(run({{"labels", "maybe"}}).open_error, HasSubstr("true, false or auto"));
  EXPECT_THAT(run({{"association_tolerance_s", "nan"}}).open_error, HasSubstr("a number from 0 to 10"));
  EXPECT_THAT(run({{"path", ""}}).open_error, HasSubstr("path is missing"));
}

TEST_F(Recording, FailsAtOpeningWithARemedyWhenItIsNotThere) {
  EXPECT_THAT(run({{"path", "/nonexistent"}}).open_error, HasSubstr("/nonexistent: no such folder"));
  EXPECT_THAT(run({{"path", (folder_ / "rgb.txt").string()}}).open_error, HasSubstr("no such folder"));
  fs::remove(folder_ / "depth.txt");
  EXPECT_THAT(run().open_error, AllOf(HasSubstr("depth.txt: no such file"), HasSubstr("rgb.txt and depth.txt")));
  fs::create_directory(folder_ / "depth.txt");
  EXPECT_THAT(run().open_error, HasSubstr("depth.txt: not a regular file"));
  fs::remove(folder_ / "depth.txt");
  fs::create_symlink("depth.txt", folder_ / "depth.txt");
  EXPECT_THAT(run().open_error, HasSubstr("depth.txt: "));
  fs::remove(folder_ / "depth.txt");
  write("depth.txt", "7 depth/1.png\n");
  EXPECT_THAT(run().open_error, HasSubstr("none of the 3 colour images"));
}

TEST_F(Recording, AsksForACameraWhenItHasNone) {
  fs::remove(folder_ / "camera.yaml");
  EXPECT_THAT(run().open_error, AllOf(HasSubstr("no camera.yaml; give the option camera"), HasSubstr("tum1")));
  EXPECT_THAT(run({{"camera", "leica"}}).open_error, HasSubstr("neither a file nor a preset"));
  const Run r = run({{"camera", "tum1"}});
  EXPECT_THAT(r.frames, IsEmpty());
  EXPECT_THAT(r.bad, testing::Each(HasSubstr("24 x 18 px, the calibration says 640 x 480")));
  write("other.yaml", "width: 24\nheight: 18\nfx: 20\nfy: 20\ncx: 12\ncy: 9\ndepth_scale: 500\n");
  EXPECT_EQ(run({{"camera", (folder_ / "other.yaml").string()}}).last.rgbd.depth_scale, 500.0F);
  write("camera.yaml", "width: 24\nfx: wide\n");
  EXPECT_THAT(run({{"camera", "tum1"}}).open_error, HasSubstr("camera.yaml:2: fx"))
      << "a broken one is not passed over";
}

TEST_F(Recording, LosesOneFrameForEachBrokenImage) {
  write("rgb/1.png", "no image");
  fs::remove(folder_ / "depth/2.png");
  Run r = run();
  EXPECT_THAT(r.frames, ElementsAre("rgbd 0 3000 ms"));
  EXPECT_THAT(r.bad, ElementsAre(AllOf(HasSubstr("rgb.txt:2: "), HasSubstr("rgb/1.png: neither PNG")),
                                 AllOf(HasSubstr("rgb.txt:3: "), HasSubstr("depth/2.png: no such file"))));
  image("depth/3.png", CV_8UC1, 3);
  fs::remove(folder_ / "rgb/2.png");
  fs::create_directory(folder_ / "rgb/2.png");
  r = run();
  EXPECT_THAT(r.bad, ElementsAre(HasSubstr("rgb.txt:2: "), HasSubstr("rgb/2.png: not a regular file"),
                                 HasSubstr("8-bit grey, 16-bit")));
}

TEST_F(Recording, TellsBadLinesFirstAndLosesOnlyThose) {
  write("rgb.txt", "3 rgb/3.png\n1 rgb/1.png\nnan rgb/2.png\n1 rgb/2.png\n");
  const Run r = run();
  EXPECT_THAT(r.frames, ElementsAre("rgbd 0 1000 ms", "rgbd 0 3000 ms"));
  EXPECT_THAT(r.bad, ElementsAre(HasSubstr("rgb.txt:3: not 'stamp file'"), HasSubstr("rgb.txt:4: has the stamp of")));
}

TEST_F(Recording, PrefersItsAssociations) {
  write("associations.txt", "1 rgb/1.png 3.01 depth/3.png\n2 rgb/2.png 2.01\n");
  const Run r = run();
  EXPECT_THAT(r.frames, ElementsAre("rgbd 0 1000 ms"));
  EXPECT_EQ(r.last.rgbd.depth.at(0, 0), 3000);
  EXPECT_EQ(r.last.rgbd.depth_stamp, 3010 * kNsPerMs);
  EXPECT_THAT(r.bad, ElementsAre(HasSubstr("associations.txt:2: not 't_rgb")));
}

TEST_F(Recording, GivesLabelsRightAfterTheirFrame) {
  EXPECT_THAT(run({{"labels", "true"}}).open_error, HasSubstr("there is no label.txt"));
  EXPECT_THAT(run({{"labels", "auto"}}).frames, testing::SizeIs(3));
  write("label.txt", "1.005 label/1.png\n2 label/2.png\n3 label/3.png\n");
  write("classes.csv", "id,name,kind\n13,pallet,semi_static\n");
  for (int i = 1; i <= 3; ++i) {
    image("label/" + std::to_string(i) + ".png", CV_8UC1, 10 + i);
    image("instance/" + std::to_string(i) + ".png", CV_16UC1, 300 + i);
  }
  write("rgb/2.png", "broken");
  for (const char* choice : {"true", "auto"}) {
    const Run r = run({{"labels", choice}});
    EXPECT_THAT(r.frames, ElementsAre("rgbd 0 1000 ms", "labels 1 1000 ms", "rgbd 0 3000 ms", "labels 1 3000 ms"));
    EXPECT_THAT(r.bad, testing::SizeIs(1)) << "a lost frame takes its labels along";
    EXPECT_EQ(r.last.labels.classes.at(3, 3), 13);
    EXPECT_EQ(r.last.labels.instances.at(3, 3), 303);
    EXPECT_THAT(r.last.labels.table_name, HasSubstr("classes.csv"));
    EXPECT_EQ(r.setup.sensors[1].kind, SensorKind::labels);
    ASSERT_TRUE(r.setup.label_table);
    EXPECT_EQ(r.setup.label_table->name, r.last.labels.table_name);
    EXPECT_EQ(r.setup.label_table->classes.at(0).name, "pallet");
  }
  EXPECT_FALSE(run().setup.label_table) << "no labels asked for";
  write("classes.csv", "id,name,kind\n13,pallet,movable\n");
  EXPECT_THAT(run({{"labels", "auto"}}).open_error, HasSubstr("classes.csv:2: kind"));
  fs::remove(folder_ / "classes.csv");
  fs::remove(folder_ / "label/3.png");
  EXPECT_THAT(run({{"labels", "true"}}).bad,
              testing::Contains(AllOf(HasSubstr("label.txt:3: "), HasSubstr("no such file"))));
}

TEST_F(Recording, MergesFurtherCamerasAndTheLidarByTime) {
  write("rgb_left.txt", "1.5 rgb/1.png\n2 rgb/2.png\n");
  write("depth_left.txt", "1.5 depth/1.png\n2 depth/2.png\n");
  write("lidar.txt", "0.9 lidar/a.pcd\n2.5 lidar/b.pcd\n");
  EXPECT_THAT(run().open_error, AllOf(HasSubstr("sensors.yaml: T_body_"), HasSubstr("is missing")));
  write("sensors.yaml",
        "T_body_camera: {translation: [0.3, 0, 0], q_xyzw: [-0.5, 0.5, -0.5, 0.5]}\n"
        "T_body_left: {translation: [0, 0.2, 0], q_xyzw: [0, 0, 0, 1]}\n"
        "T_body_lidar: {translation: [0, 0, 1], q_xyzw: [0, 0, 0, 1]}\n");
  write("lidar/a.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n" + std::string(24, 'A'));
  write("lidar/b.pcd", "cut");
  const Run r = run();
  EXPECT_THAT(r.frames, ElementsAre("lidar 2 900 ms", "rgbd 0 1000 ms", "rgbd 1 1500 ms", "rgbd 0 2000 ms",
                                    "rgbd 1 2000 ms", "rgbd 0 3000 ms"));
  EXPECT_THAT(r.bad, ElementsAre(AllOf(HasSubstr("lidar.txt:2: "), HasSubstr("b.pcd: the PCD's header"))));
  EXPECT_EQ(r.last.lidar.points.size(), 0U) << "the broken scan leaves no old points behind";
  EXPECT_EQ(r.setup.sensors[0].T_body_sensor.translation.x(), 0.3);
  EXPECT_EQ(r.setup.sensors[1].name, "left");
  EXPECT_EQ(r.setup.sensors[2].kind, SensorKind::lidar);
  EXPECT_THAT(run({{"frames", "1:2"}}).frames, ElementsAre("rgbd 0 2000 ms", "rgbd 1 2000 ms"));
}

TEST_F(Recording, RegistersDepthOfACameraOfItsOwn) {
  write("camera.yaml",
        "width: 24\nheight: 18\nfx: 20\nfy: 20\ncx: 12\ncy: 9\ndepth_scale: 1000\ndepth_fx: 20\ndepth_fy: "
        "20\ndepth_cx: 12\n"
        "depth_cy: 9\nT_color_depth: {translation: [0.3, 0, 0.1], q_xyzw: [0, 0, 0, 1]}\n");
  const Run r = run();
  EXPECT_THAT(r.frames, testing::SizeIs(3));
  EXPECT_EQ(r.last.rgbd.depth.at(12, 9), 3100);
  EXPECT_EQ(r.last.rgbd.depth.at(0, 9), 0) << "not seen by the depth camera";
}

TEST_F(Recording, IsReplayedAtItsPaceWithTheSameFrames) {
  write("rgb.txt", "1 rgb/1.png\n1.01 rgb/2.png\n1.02 rgb/3.png\n");
  write("depth.txt", "1 depth/1.png\n1.01 depth/2.png\n1.02 depth/3.png\n");
  const Run r = run({{"realtime", "true"}});
  EXPECT_THAT(r.frames, testing::SizeIs(3));
  EXPECT_TRUE(r.setup.paced);
}

TEST_F(Recording, OfTheWarehouseDataSetIsReadAsItIs) {
  fs::remove_all(folder_);
  write("frame_times.txt", "1.6e+09\n1600000000.1\nx\n1600000000.3\n");
  const cv::Mat color(720, 1280, CV_8UC3, cv::Scalar::all(9)), depth(720, 1280, CV_16UC1, cv::Scalar::all(2000));
  const cv::Mat label(720, 1280, CV_8UC1, cv::Scalar::all(6));
  for (const char* side : {"left", "right"}) {
    for (const char* kind : {"image_", "depth_", "segmentation_greyscale_"})
      fs::create_directories(folder_ / (kind + std::string(side)));
  }
  for (const char* name : {"000000.png", "000003.png"}) {
    for (const char* side : {"left", "right"}) {
      cv::imwrite((folder_ / (std::string("image_") + side) / name).string(), color);
      cv::imwrite((folder_ / (std::string("depth_") + side) / name).string(), depth);
      cv::imwrite((folder_ / (std::string("segmentation_greyscale_") + side) / name).string(), label);
    }
  }
  write("lidar/000000.pcd", "FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 2\nDATA binary\n" + std::string(24, 'A'));
  const Run r = run({{"labels", "true"}, {"frames", "0:"}});
  EXPECT_EQ(r.open_error, "");
  const std::vector<std::string> names = {"left", "left_labels", "right", "right_labels", "lidar"};
  ASSERT_EQ(r.setup.sensors.size(), names.size());
  for (std::size_t i = 0; i < names.size(); ++i) EXPECT_EQ(r.setup.sensors[i].name, names[i]);
  EXPECT_EQ(std::ranges::count(r.frames, "labels 1 1600000000300 ms"), 1);
  EXPECT_EQ(r.frames.front(), "rgbd 0 1600000000000 ms");
  EXPECT_EQ(r.last.labels.classes.at(100, 100), 6);
  EXPECT_EQ(r.last.labels.table_name, "torwic");
  ASSERT_TRUE(r.setup.label_table);
  EXPECT_EQ(r.setup.label_table->name, "torwic");
  EXPECT_TRUE(r.setup.label_table->classes.empty()) << "the built-in table of that name";
  EXPECT_THAT(r.bad, testing::Contains(HasSubstr("frame_times.txt:3: no stamp")));
  const Eigen::Vector3d axis_body = r.setup.sensors[0].T_body_sensor.rotation * Eigen::Vector3d::UnitZ();
  EXPECT_NEAR(std::atan2(axis_body.y(), axis_body.x()) * 57.2958, 26.0, 0.1) << "the left camera looks left of forward";
}

}  // namespace povslam
