#include "pipeline/objects/segment.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/objects/analytic_view.hpp"

namespace povslam {

namespace {

constexpr double kSigma = 0.0025;  // m at 1 m: a stereo camera's

AnalyticBox box_on_floor(int thing, double x, double y, const Eigen::Vector3d& size_m, double yaw = 0.0) {
  return {thing, {x, y, 0.5 * size_m.z()}, size_m, yaw};
}

struct Told {
  AnalyticView truth;
  std::vector<Segment> segments;
  ImageU16 instances;

  double iou(int thing) const { return best_iou(truth, instances, thing); }
  double structure(int thing) const { return share_owned(truth, instances, thing, kStructure); }
};

Told tell(const AnalyticScene& scene, const SegmentOptions& options = {}) {
  Told told;
  told.truth = cast(scene);
  Segmenter segmenter(scene.camera, options);
  told.segments = segmenter.segment(told.truth.view, told.instances);
  return told;
}

TEST(Segmenter, FindsABoxOnTheFloorWithBothItsSidesAndItsTop) {
  for (const double noise : {0.0, kSigma}) {
    const Told told = tell({{box_on_floor(1, 2.5, 0.0, {0.6, 0.6, 0.5}, 0.6)}, true, noise});
    ASSERT_EQ(told.segments.size(), 1U) << noise;
    EXPECT_GT(told.iou(1), 0.9) << noise;
    EXPECT_GT(told.structure(0), 0.95) << noise;
    EXPECT_FALSE(told.segments[0].at_border);
    EXPECT_NEAR(told.segments[0].top_m, 0.5, 0.03);
    EXPECT_GT(told.segments[0].own_outline, 0.9);
  }
}

TEST(Segmenter, KeepsTwoBoxesFiveCentimetresApart) {
  const Told told = tell(
      {{box_on_floor(1, 2.0, 0.325, {0.5, 0.6, 0.5}), box_on_floor(2, 2.0, -0.325, {0.5, 0.6, 0.5})}, true, kSigma});
  EXPECT_EQ(told.segments.size(), 2U);
  EXPECT_GT(told.iou(1), 0.85);
  EXPECT_GT(told.iou(2), 0.85);
}

TEST(Segmenter, TellsABoxFromTheWallBehindIt) {
  const AnalyticBox wall{0, {3.1, 0.0, 1.5}, {0.2, 8.0, 3.0}};
  const Told told = tell({{box_on_floor(1, 2.7, 0.0, {0.5, 0.6, 0.7}), wall},
                          true,
                          kSigma,
                          {640, 480, 525.0, 525.0, 319.5, 239.5, {}},
                          1.0,
                          0.0});
  ASSERT_EQ(told.segments.size(), 1U);
  EXPECT_GT(told.iou(1), 0.85);
  EXPECT_GT(told.structure(0), 0.9);
}

TEST(Segmenter, KnowsAWallThatFillsTheWholeImage) {
  const AnalyticBox wall{0, {2.1, 0.0, 1.5}, {0.2, 8.0, 3.0}};
  const Told told = tell({{wall}, true, kSigma});
  EXPECT_TRUE(told.segments.empty());
  EXPECT_GT(told.structure(0), 0.95);
}

TEST(Segmenter, TakesAPillarForPartOfTheBuilding) {
  const Told told = tell({{box_on_floor(1, 3.0, 0.0, {0.4, 0.4, 3.6}), box_on_floor(2, 2.5, 0.8, {0.5, 0.4, 0.5})},
                          true,
                          kSigma,
                          {640, 480, 525.0, 525.0, 319.5, 239.5, {}},
                          1.0,
                          0.0});
  EXPECT_EQ(told.segments.size(), 1U);
  EXPECT_GT(told.structure(1), 0.9);
  EXPECT_GT(told.iou(2), 0.85);
}

TEST(Segmenter, KeepsBoxesOnAShelfApartWhoseFrontsAreFlushWithIt) {
  AnalyticScene scene{{{0, {2.4, 0.0, 0.95}, {0.8, 2.4, 0.1}}}, true, kSigma};
  scene.camera_height_m = 0.8;
  scene.pitch_rad = -0.1;
  for (int i = 0; i < 4; ++i)
    scene.boxes.push_back({i + 1, {2.18, -0.75 + 0.5 * i, 1.0 + 0.15 + 0.05 * i}, {0.34, 0.4, 0.3 + 0.1 * i}});
  const Told told = tell(scene);
  for (int i = 1; i <= 4; ++i) EXPECT_GT(told.iou(i), 0.7) << i;
  EXPECT_EQ(told.segments.size(), 4U);
}

TEST(Segmenter, SeesAPalletAndItsLoadAsOneThing) {
  AnalyticScene scene{
      {box_on_floor(1, 2.2, 0.0, {0.8, 1.2, 0.14}), {1, {2.2, 0.0, 0.44}, {0.68, 1.08, 0.6}}}, true, kSigma};
  const Told told = tell(scene);
  ASSERT_EQ(told.segments.size(), 1U);
  EXPECT_GT(told.iou(1), 0.85);
}

TEST(Segmenter, RemembersTheFloorWhereOnlyATableIsSeen) {
  AnalyticScene scene{{box_on_floor(1, 1.2, 0.0, {0.4, 0.4, 0.4})}};
  Segmenter segmenter(scene.camera, {});
  ImageU16 instances;
  segmenter.segment(cast(scene).view, instances);
  AnalyticScene table{{{1, {1.2, 0.0, 0.35}, {1.2, 1.4, 0.7}}}, false};
  table.pitch_rad = 0.45;
  const AnalyticView close = cast(table);
  const std::vector<Segment>& segments = segmenter.segment(close.view, instances);
  ASSERT_EQ(segments.size(), 1U);
  EXPECT_GT(best_iou(close, instances, 1), 0.9);
}

TEST(Segmenter, SaysThatAThingRunsOnBeyondTheImage) {
  const Told cut = tell({{box_on_floor(1, 2.5, 1.4, {0.6, 0.8, 0.5})}});
  ASSERT_EQ(cut.segments.size(), 1U);
  EXPECT_TRUE(cut.segments[0].at_border);
  SegmentOptions near;
  near.max_depth_m = 5.0;
  const Told far = tell({{box_on_floor(1, 4.9, 0.0, {0.9, 0.8, 0.8}, 0.7)}}, near);
  ASSERT_EQ(far.segments.size(), 1U);
  EXPECT_TRUE(far.segments[0].at_border) << "it reaches the end of the range";
}

TEST(Segmenter, LeavesOutWhatIsSmallerThanAskedFor) {
  const AnalyticScene scene{{box_on_floor(1, 2.5, 0.0, {0.3, 0.3, 0.3})}};
  SegmentOptions options;
  ASSERT_EQ(tell(scene, options).segments.size(), 1U);
  options.min_pixels = 20000;
  EXPECT_TRUE(tell(scene, options).segments.empty());
}

TEST(Segmenter, SeesNothingWhereNothingWasMeasured) {
  const PinholeCamera camera{641, 481, 525.0, 525.0, 319.5, 239.5, {}};
  Segmenter segmenter(camera, {});
  DepthView view;
  view.camera = camera;
  view.depth_m.resize(camera.width, camera.height);
  ImageU16 instances;
  constexpr float kNothing[] = {
      0.0F, -1.0F, std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), 1e-30F, 1e30F};
  for (const float depth : kNothing) {
    view.depth_m.fill(depth);
    EXPECT_TRUE(segmenter.segment(view, instances).empty()) << depth;
    for (const std::uint16_t owner : instances.pixels()) ASSERT_EQ(owner, kNobody) << depth;
  }
}

TEST(Segmenter, GivesNoOwnerToPixelsWithoutDepth) {
  AnalyticScene scene{{box_on_floor(1, 2.5, 0.0, {0.6, 0.6, 0.5})}, true, kSigma};
  AnalyticView seen = cast(scene);
  std::mt19937 random(3);
  for (float& depth : seen.view.depth_m.pixels()) {
    if (random() % 3 == 0) depth = random() % 2 == 0 ? 0.0F : std::numeric_limits<float>::quiet_NaN();
  }
  Segmenter segmenter(scene.camera, {});
  ImageU16 instances;
  ASSERT_EQ(segmenter.segment(seen.view, instances).size(), 1U);
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (!(seen.view.depth_m.data()[i] > 0.0F)) {
      ASSERT_EQ(instances.data()[i], kNobody);
    }
  }
}

TEST(Segmenter, FindsNothingInPureNoise) {
  const PinholeCamera camera{640, 480, 525.0, 525.0, 319.5, 239.5, {}};
  DepthView view;
  view.camera = camera;
  view.T_world_camera = looking_along_x(1.0, 0.0);
  view.depth_m.resize(camera.width, camera.height);
  std::mt19937 random(5);
  std::uniform_real_distribution<float> depth(0.3F, 5.0F);
  for (float& value : view.depth_m.pixels()) value = depth(random);
  Segmenter segmenter(camera, {});
  ImageU16 instances;
  EXPECT_TRUE(segmenter.segment(view, instances).empty());
}

TEST(Segmenter, GivesTheSameAnswerToTheSameViews) {
  const AnalyticScene scene{
      {box_on_floor(1, 2.5, 0.2, {0.6, 0.6, 0.5}, 0.4), box_on_floor(2, 3.2, -0.6, {0.5, 0.6, 0.9})}, true, kSigma};
  const Told first = tell(scene), second = tell(scene);
  ASSERT_EQ(first.segments.size(), second.segments.size());
  EXPECT_TRUE(std::equal(first.instances.pixels().begin(), first.instances.pixels().end(), second.instances.data()));
}

TEST(Segmenter, WorksOnSmallAndLargeImages) {
  for (const int scale : {1, 2, 4}) {
    AnalyticScene scene{{box_on_floor(1, 2.2, 0.0, {0.6, 0.6, 0.5}, 0.6)}};
    scene.camera = {320 * scale, 240 * scale, 262.5 * scale, 262.5 * scale, 159.5 * scale, 119.5 * scale, {}};
    const Told told = tell(scene);
    ASSERT_EQ(told.segments.size(), 1U) << scale;
    EXPECT_GT(told.iou(1), 0.9) << scale;
  }
}

}  // namespace

}  // namespace povslam
