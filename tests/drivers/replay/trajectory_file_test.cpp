#include "drivers/replay/trajectory_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>
#include <sstream>

#include "drivers/replay/text_file.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

fs::path write_text(const std::string& text) {
  const fs::path path = temp_folder() / "povslam_trajectory_test.txt";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::string error_of(const std::string& text) {
  const auto poses = read_trajectory(write_text(text));
  return poses ? "no error" : poses.error().message;
}

}  // namespace

TEST(Seconds, AreCountedAndNotRoundedThroughADouble) {
  EXPECT_EQ(parse_seconds("1305031229.528748"), 1305031229528748000);
  EXPECT_EQ(parse_seconds("1305031229.528748123"), 1305031229528748123);
  EXPECT_EQ(parse_seconds("1305031229.5287481239"), 1305031229528748123);
  EXPECT_EQ(parse_seconds("1.305031229528748123e+09"), 1305031229528748123);
  EXPECT_EQ(parse_seconds("15e-1"), 1500000000);
  EXPECT_EQ(parse_seconds("-0.000001"), -1000);
  EXPECT_EQ(parse_seconds(".5"), 500000000);
  EXPECT_EQ(parse_seconds("7"), 7000000000);
}

TEST(Seconds, RefuseWhatIsNoTime) {
  for (const char* word :
       {"", ".", "-", "nan", "inf", "1.2.3", "1,5", "1e", "1e999", "12345678901234567890", "0x10", "1 2"}) {
    EXPECT_EQ(parse_seconds(word), std::nullopt) << word;
  }
}

TEST(Seconds, ComeBackFromTextAsTheyWere) {
  rc::check([](TimeNs any) {
    const TimeNs time = any / 2;
    RC_ASSERT(parse_seconds(format_seconds(time)) == time);
  });
  EXPECT_EQ(format_seconds(1305031229528748000), "1305031229.528748");
  EXPECT_EQ(format_seconds(33333333), "0.033333333");
}

TEST(Trajectory, IsReadWithCommentsBlankLinesAndDosLineEnds) {
  const auto poses =
      read_trajectory(write_text("\xEF\xBB\xBF# truth\r\n\r\n1.5  1 2 3   0 0 0 1\r\n\t2 4 5 6 0 0 1 0 \r\n"));
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].stamp, 1500000000);
  EXPECT_EQ((*poses)[1].T_world_sensor.translation, Eigen::Vector3d(4, 5, 6));
  EXPECT_NEAR(rotation_angle_rad((*poses)[1].T_world_sensor), 3.14159265, 1e-6);
}

TEST(Trajectory, NamesFileAndLineOfWhatItCannotRead) {
  EXPECT_THAT(error_of("# c\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0\n"), HasSubstr("povslam_trajectory_test.txt:3: 7 words"));
  EXPECT_THAT(error_of("x 0 0 0 0 0 0 1\n"), HasSubstr(":1: 'x' is no stamp"));
  EXPECT_THAT(error_of("1 0 nan 0 0 0 0 1\n"), HasSubstr(":1: 'nan'"));
  EXPECT_THAT(error_of("1 0 1e999 0 0 0 0 1\n"), HasSubstr(":1: '1e999'"));
  EXPECT_THAT(error_of("1 0 0 0 0 0 0 0\n"), HasSubstr(":1: the quaternion"));
  EXPECT_THAT(error_of(""), HasSubstr("holds no pose"));
  EXPECT_THAT(read_trajectory("/nonexistent/a.txt").error().message, HasSubstr("/nonexistent/a.txt: no such file"));
  EXPECT_THAT(read_trajectory(temp_folder()).error().message, HasSubstr("not a regular file"));
}

TEST(Trajectory, IsSortedAndARepeatedStampKeepsItsFirstPose) {
  const auto poses = read_trajectory(write_text("3 3 0 0 0 0 0 1\n1 1 0 0 0 0 0 1\n3 9 0 0 0 0 0 1\n"));
  ASSERT_TRUE(poses);
  ASSERT_EQ(poses->size(), 2U);
  EXPECT_EQ((*poses)[0].stamp, 1 * kNsPerSecond);
  EXPECT_EQ((*poses)[1].T_world_sensor.translation.x(), 3.0);
}

TEST(Trajectory, IsWrittenWithExactStampsAndReadBack) {
  const std::vector<StampedPose> poses = {
      {1305031229528748000, {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {0.123456789, -2.0, 3.0}}},
      {1305031229528748001, {Eigen::Quaterniond::Identity(), {1e5, 0.0, -1e-9}}}};
  const fs::path path = write_text("");
  ASSERT_TRUE(write_trajectory(path, poses));
  std::stringstream text;
  text << std::ifstream(path).rdbuf();
  EXPECT_THAT(text.str(), HasSubstr("\n1305031229.528748 0.123456789 -2.000000000 3.000000000 -0.500000000 0.5"));
  const auto back = read_trajectory(path);
  ASSERT_TRUE(back);
  ASSERT_EQ(back->size(), 2U);
  EXPECT_EQ((*back)[1].stamp, poses[1].stamp);
  EXPECT_LT(local((*back)[0].T_world_sensor, poses[0].T_world_sensor).norm(), 1e-8);
  EXPECT_FALSE(write_trajectory("/nonexistent/folder/a.txt", poses));
}

TEST(PoseAt, LiesBetweenItsNeighboursAndKnowsItsLimits) {
  const Rigid3 turned{Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ())), {2.0, 0.0, 0.0}};
  const std::vector<StampedPose> poses = {{0, {}}, {kNsPerSecond, turned}, {9 * kNsPerSecond, {}}};
  const auto pose = pose_at(poses, kNsPerSecond / 4, 1.0);
  ASSERT_TRUE(pose);
  EXPECT_NEAR(pose->translation.x(), 0.5, 1e-12);
  EXPECT_NEAR(rotation_angle_rad(*pose), 0.25, 1e-12);
  EXPECT_TRUE(pose_at(poses, 9 * kNsPerSecond, 1.0)) << "a pose at the very stamp needs no neighbours";
  EXPECT_FALSE(pose_at(poses, 5 * kNsPerSecond, 1.0)) << "across a gap";
  EXPECT_FALSE(pose_at(poses, -1, 1.0));
  EXPECT_FALSE(pose_at(poses, 9 * kNsPerSecond + 1, 1.0));
  EXPECT_FALSE(pose_at({}, 0, 1.0));
}

}  // namespace povslam
