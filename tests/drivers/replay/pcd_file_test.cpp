#include "drivers/replay/pcd_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <random>
#include <string>

namespace povslam {

namespace {

using testing::HasSubstr;

template <class... Values>
std::string raw(Values... values) {
  std::string bytes;
  (bytes.append(reinterpret_cast<const char*>(&values), sizeof values), ...);
  return bytes;
}

const std::string kHeader =
    "# .PCD v0.7\nVERSION 0.7\nFIELDS x y z intensity t\nSIZE 4 4 4 4 4\nTYPE F F F F U\nCOUNT 1 1 1 1 1\nWIDTH 3\n"
    "HEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3\nDATA binary\n";
const std::string kPoints =
    raw(1.0F, 2.0F, 3.0F, 40.0F, 500000U) + raw(0.0F, 0.0F, 0.0F, 0.0F, 0U) + raw(NAN, 1.0F, 1.0F, 1.0F, 0U);

std::string error_of(const std::string& bytes) {
  std::vector<LidarPoint> points;
  const Status status = decode_pcd(bytes, points);
  return status ? "no error" : status.error().message;
}

}  // namespace

TEST(Pcd, GivesThePointsThatReturned) {
  std::vector<LidarPoint> points(7);
  ASSERT_TRUE(decode_pcd(kHeader + kPoints, points));
  ASSERT_EQ(points.size(), 1U) << "the origin and a NaN are no points";
  EXPECT_EQ(points[0].y, 2.0F);
  EXPECT_EQ(points[0].intensity, 40.0F);
  EXPECT_FLOAT_EQ(points[0].t_offset_s, 0.0005F) << "whole numbers are nanoseconds";
}

TEST(Pcd, SkipsFieldsItDoesNotUseAndReadsOtherTypes) {
  const std::string header =
      "FIELDS _ ring x y z t\r\nSIZE 1 2 8 8 8 8\r\nTYPE U U F F F F\r\nCOUNT 3 1 1 1 1 1\r\nPOINTS 1\r\nDATA "
      "binary\r\n";
  std::vector<LidarPoint> points;
  ASSERT_TRUE(decode_pcd(header + "abc" + raw(std::uint16_t{17}) + raw(1.0, 2.0, 3.0, 0.25), points));
  ASSERT_EQ(points.size(), 1U);
  EXPECT_EQ(points[0].ring, 17);
  EXPECT_EQ(points[0].z, 3.0F);
  EXPECT_EQ(points[0].t_offset_s, 0.25F) << "fractions are seconds";
}

TEST(Pcd, SaysWhatItCannotRead) {
  EXPECT_THAT(error_of(""), HasSubstr("header is damaged"));
  EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 1\nDATA ascii\n1 2 3\n"),
              HasSubstr("only PCD with DATA binary"));
  EXPECT_THAT(error_of("FIELDS a b c\nSIZE 4 4 4\nTYPE F F F\nPOINTS 0\nDATA binary\n"), HasSubstr("no fields x y z"));
  EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 3\nTYPE F F F\nPOINTS 0\nDATA binary\n"),
              HasSubstr("header is damaged"));
  EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 4\nCOUNT 1 1 99999999999\nPOINTS 0\nDATA binary\n"),
              HasSubstr("damaged"));
  EXPECT_THAT(error_of("FIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nPOINTS 18446744073709551615\nDATA binary\n"),
              HasSubstr("truncated"));
}

TEST(Pcd, NoticesEveryTruncationAndSurvivesGarbage) {
  const std::string whole = kHeader + kPoints;
  for (std::size_t length = 0; length < whole.size(); ++length) {
    EXPECT_NE(error_of(whole.substr(0, length)), "no error") << length;
  }
  std::mt19937 random(1);
  for (int i = 0; i < 2000; ++i) {
    std::string bytes = whole;
    for (int k = 0; k < 5; ++k) bytes[random() % bytes.size()] = static_cast<char>(random());
    error_of(bytes);
  }
}

}  // namespace povslam
