#include "tools/povslam/plot.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <fstream>
#include <limits>
#include <opencv2/imgcodecs.hpp>
#include <sstream>

#include "tools/povslam/plot_axes.hpp"

#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

Rigid3 level_camera(double x, double y) {
  return {Eigen::Quaterniond(0.5, -0.5, 0.5, -0.5), {x, y, 1.0}};
}

TrajectoryPlot circle() {
  TrajectoryPlot plot;
  plot.title = "circle <1> & more";
  for (int i = 0; i <= 60; ++i) {
    plot.truth.push_back({i * 100 * kNsPerMs, level_camera(std::cos(0.1 * i), std::sin(0.1 * i))});
  }
  plot.estimates.push_back({"estimate", plot.truth});
  plot.notes = {"ATE RMSE: 0.0000 m"};
  return plot;
}

std::string temporary(const std::string& name) {
  return (temp_folder() / name).string();
}

std::string content(const std::string& file) {
  std::ostringstream text;
  text << std::ifstream(file).rdbuf();
  return text.str();
}

std::string svg_of(const TrajectoryPlot& plot) {
  const std::string file = temporary("povslam_plot_test.svg");
  EXPECT_TRUE(plot_trajectories(file, plot));
  const std::string text = content(file);
  std::filesystem::remove(file);
  return text;
}

}  // namespace

TEST(Plot, AStemWritesBothKindsAndThePictureIsNotBlank) {
  const std::string stem = temporary("povslam_plot_test_stem");
  ASSERT_TRUE(plot_trajectories(stem, circle()));
  const cv::Mat picture = cv::imread(stem + ".png");
  ASSERT_FALSE(picture.empty());
  const cv::Scalar mean = cv::mean(picture(cv::Rect(80, 100, 620, 620)));
  EXPECT_LT(mean[0], 254.0);
  EXPECT_NE(content(stem + ".svg").find("</svg>"), std::string::npos);
  std::filesystem::remove(stem + ".png");
  std::filesystem::remove(stem + ".svg");
}

TEST(Plot, TextIsEscapedAndNotesAreShown) {
  const std::string svg = svg_of(circle());
  EXPECT_NE(svg.find("circle &lt;1&gt; &amp; more"), std::string::npos);
  EXPECT_NE(svg.find(">0.0000 m<"), std::string::npos);
  EXPECT_NE(svg.find("path from above"), std::string::npos);
}

TEST(Plot, AWorldThatIsNotLevelIsShownOnItsPrincipalAxes) {
  TrajectoryPlot plot = circle();
  const Rigid3 T_lying{Eigen::Quaterniond(Eigen::AngleAxisd(1.5, Eigen::Vector3d::UnitX())), {0.0, 0.0, 0.0}};
  for (StampedPose& pose : plot.truth) pose.T_world_sensor = T_lying * pose.T_world_sensor;
  EXPECT_NE(svg_of(plot).find("principal axes"), std::string::npos);
}

TEST(Plot, ADivergedOrBrokenEstimateNeitherCrashesNorLeavesTheSheet) {
  TrajectoryPlot plot = circle();
  plot.estimates[0].poses[30].T_world_sensor.translation.x() = 1e7;
  plot.estimates[0].poses[40].T_world_sensor.translation.y() = std::numeric_limits<double>::quiet_NaN();
  const std::string svg = svg_of(plot);
  EXPECT_EQ(svg.find("nan"), std::string::npos);
  EXPECT_EQ(svg.find("inf"), std::string::npos);
  EXPECT_NE(svg.find("<polyline"), std::string::npos);
}

TEST(Plot, WithoutTruthHeightAndYawAreShown) {
  TrajectoryPlot plot = circle();
  plot.truth.clear();
  const std::string svg = svg_of(plot);
  EXPECT_NE(svg.find("height [m]"), std::string::npos);
  EXPECT_NE(svg.find("yaw [deg]"), std::string::npos);
}

TEST(Plot, NothingToPlotIsAnEmptySheet) {
  EXPECT_NE(svg_of(TrajectoryPlot{}).find("</svg>"), std::string::npos);
}

TEST(Plot, AFolderThatIsNotThereIsAnErrorThatNamesTheFile) {
  for (const char* file : {"/nowhere/at/all.png", "/nowhere/at/all.svg"}) {
    const Status drawn = plot_trajectories(file, circle());
    ASSERT_FALSE(drawn);
    EXPECT_EQ(drawn.error().message.rfind(file, 0), 0u);
  }
}

TEST(PlotAxes, TicksAreRoundAndWithinTheRange) {
  EXPECT_EQ(drawing::ticks({0.0, 1.0}, 5), (std::vector<double>{0.0, 0.2, 0.4, 0.6000000000000001, 0.8, 1.0}));
  const std::vector<double> around = drawing::ticks({-130.0, 260.0}, 4);
  EXPECT_EQ(around, (std::vector<double>{-100.0, 0.0, 100.0, 200.0}));
}

TEST(PlotAxes, ARangeOfOneValueIsOpened) {
  const double values[] = {3.0, 3.0, std::numeric_limits<double>::infinity()};
  const drawing::Range range = drawing::range_of(values, 0.5);
  EXPECT_NEAR(range.span(), 0.5, 1e-12);
  EXPECT_NEAR(range.low, 2.75, 1e-12);
}

}  // namespace povslam
