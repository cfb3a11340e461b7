#include "drivers/replay/camera_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>

#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace {

using testing::HasSubstr;

const std::string kWhole = "width: 640\nheight: 480\nfx: 525\nfy: 526\ncx: 319.5\ncy: 239.5\ndepth_scale: 5000\n";

std::string error_of(const std::string& yaml) {
  const auto camera = parse_camera(yaml, "camera.yaml");
  return camera ? "no error" : camera.error().message;
}

}  // namespace

TEST(CameraFile, GivesIntrinsicsAndDefaults) {
  const auto camera =
      parse_camera(kWhole + "distortion: [0.1, -0.2, 0.01, 0.02, 0.3]\ngravity_world: [0, 0, -1]\n", "c");
  ASSERT_TRUE(camera) << camera.error().message;
  EXPECT_EQ(camera->color.width, 640);
  EXPECT_EQ(camera->color.fy, 526.0);
  EXPECT_EQ(camera->color.cy, 239.5);
  EXPECT_EQ(camera->color.distortion[4], 0.3);
  EXPECT_EQ(camera->depth_scale, 5000.0);
  EXPECT_EQ(camera->fps, 30.0);
  EXPECT_EQ(camera->gravity_world->z(), -1.0);
  EXPECT_FALSE(camera->depth);
}

TEST(CameraFile, KnowsADepthCameraOfItsOwn) {
  const auto camera =
      parse_camera(kWhole + "depth_fx: 585\ndepth_fy: 586\ndepth_cx: 320\ndepth_cy: 240\ndepth_width: 320\n" +
                       "T_color_depth: {translation: [-0.025, 0, 0.001], q_xyzw: [0, 0, 0, 1]}\n",
                   "c");
  ASSERT_TRUE(camera) << camera.error().message;
  ASSERT_TRUE(camera->depth);
  EXPECT_EQ(camera->depth->camera.width, 320);
  EXPECT_EQ(camera->depth->camera.height, 480) << "as colour, when not given";
  EXPECT_EQ(camera->depth->camera.fy, 586.0);
  EXPECT_EQ(camera->depth->T_color_depth.translation.x(), -0.025);
}

TEST(CameraFile, NamesFileLineAndKeyOfWhatIsWrong) {
  EXPECT_THAT(error_of(kWhole + "focal: 3\n"), HasSubstr("camera.yaml:8: focal: unknown key"));
  EXPECT_THAT(error_of(kWhole + "fx: 3\n"), HasSubstr("camera.yaml:8: fx: unknown key, or given twice"));
  EXPECT_THAT(error_of("width: 640\nheight: -3\n"), HasSubstr("camera.yaml:2: height: a whole number"));
  EXPECT_THAT(error_of("width: 640.5\n"), HasSubstr("camera.yaml:1: width: a whole number"));
  EXPECT_THAT(error_of("width: 99999999\n"), HasSubstr("camera.yaml:1: width: a whole number"));
  EXPECT_THAT(error_of("fx: .nan\n"), HasSubstr("camera.yaml:1: fx: a number"));
  EXPECT_THAT(error_of("fx: [1]\n"), HasSubstr("camera.yaml:1: fx: a number"));
  EXPECT_THAT(error_of("fx:\n"), HasSubstr("fx: a number"));
  EXPECT_THAT(error_of("depth_scale: 0\n"), HasSubstr("depth_scale: a number above 0"));
  EXPECT_THAT(error_of("distortion: [1, 2]\n"), HasSubstr("distortion: a list of 5 numbers"));
  EXPECT_THAT(error_of("width: 640\n"), HasSubstr("camera.yaml: height is missing"));
  EXPECT_THAT(error_of(kWhole + "depth_fx: 500\n"), HasSubstr("depth_fy is missing"));
  EXPECT_THAT(error_of(kWhole + "T_color_depth: {translation: [0, 0, 0], q_xyzw: [0, 0, 0, 0]}\n"),
              HasSubstr("camera.yaml:8: T_color_depth: q_xyzw has length"));
  EXPECT_THAT(error_of(kWhole + "T_color_depth: {translation: [0, 0, 0]}\n"), HasSubstr("translation and q_xyzw"));
}

TEST(CameraFile, SurvivesWhatIsNoYaml) {
  EXPECT_THAT(error_of("fx: [1, 2\nfy: }"), HasSubstr("camera.yaml:"));
  EXPECT_THAT(error_of(""), HasSubstr("keys with values are expected"));
  EXPECT_THAT(error_of("just words"), HasSubstr("keys with values are expected"));
  EXPECT_THAT(error_of("{[1]: 2}"), HasSubstr("a key is expected"));
  EXPECT_THAT(error_of(std::string(5000, '[')), HasSubstr("camera.yaml"));
  EXPECT_THAT(error_of(std::string("\0\xFF\xFE\x80", 4)), HasSubstr("camera.yaml"));
  EXPECT_THAT(error_of("fx: &a [*a]\n"), HasSubstr("camera.yaml"));
}

TEST(CameraPresets, AreAllReadableAndWithinTheirImages) {
  const auto names = camera_preset_names();
  EXPECT_THAT(names, testing::UnorderedElementsAre("tum1", "tum2", "tum3", "7scenes", "7scenes_registered"));
  for (const std::string& name : names) {
    const auto camera = find_camera(name);
    ASSERT_TRUE(camera) << camera.error().message;
    EXPECT_TRUE(camera->color.contains({camera->color.cx, camera->color.cy})) << name;
  }
  EXPECT_EQ(find_camera("tum1")->color.fx, 517.306408);
  EXPECT_EQ(find_camera("tum1")->depth_scale, 5000.0);
  EXPECT_FALSE(find_camera("tum1")->depth);
  EXPECT_TRUE(find_camera("7scenes_registered")->depth) << "that data set's depth is not registered";
  EXPECT_THAT(find_camera("tum9").error().message,
              HasSubstr("neither a file nor a preset (7scenes, 7scenes_registered, tum1, tum2, tum3)"));
}

TEST(SensorsFile, SaysWhereEachSensorSits) {
  const std::string path = (temp_folder() / "sensors.yaml").string();
  std::ofstream(path) << "T_body_left: {translation: [1, 2, 3], q_xyzw: [0, 0, 0, 1]}\n"
                         "T_body_lidar:\n  translation: [0, 0, 1]\n  q_xyzw: [0, 0, 1, 0]\n";
  const auto poses = read_sensors_file(path);
  ASSERT_TRUE(poses) << poses.error().message;
  EXPECT_EQ(poses->at("left").translation, Eigen::Vector3d(1, 2, 3));
  EXPECT_EQ(poses->at("lidar").rotation.z(), 1.0);
  std::ofstream(path) << "T_body_left: {translation: [1, 2, 3], q_xyzw: [0, 0, 0, 1]}\nlidar: 3\n";
  EXPECT_THAT(read_sensors_file(path).error().message, HasSubstr("yaml:2: lidar: unknown key"));
  EXPECT_THAT(read_sensors_file("/nonexistent.yaml").error().message, HasSubstr("no such file"));
}

}  // namespace povslam
