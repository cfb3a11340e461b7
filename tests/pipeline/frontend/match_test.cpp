#include "pipeline/frontend/match.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

// Bits that differ from the look of nothing.
Descriptor bits(int count) {
  Descriptor d{};
  for (int i = 0; i < count; ++i) d[static_cast<std::size_t>(i / 64)] |= 1ULL << (i % 64);
  return d;
}

struct Feature {
  float x = 0.0F, y = 0.0F;
  int bits = 0;
  std::uint8_t level = 0;
};

Frame frame_of(std::initializer_list<Feature> features) {
  FrontendOptions options;
  options.orb.num_features = 20;
  Frame frame(made::half_camera(), options);
  for (const Feature& feature : features) {
    const std::size_t k = static_cast<std::size_t>(frame.features.size++);
    frame.x[k] = feature.x;
    frame.y[k] = feature.y;
    frame.features.descriptor[k] = bits(feature.bits);
    frame.features.level[k] = feature.level;
  }
  frame.grid.build({frame.x.data(), features.size()}, {frame.y.data(), features.size()});
  return frame;
}

const Descriptor kLook = bits(0);

MatchCandidate at(float u_px, float v_px, std::int32_t tag = 5) {
  return {u_px, v_px, 10.0F, 0, 1, &kLook, tag};
}

}  // namespace

TEST(Matcher, TakesTheNearestLookInsideTheWindow) {
  const Frame frame = frame_of({{100, 100, 60}, {105, 95, 20}, {103, 111, 0}, {100, 100, 0, 2}});
  Matcher matcher(20);
  matcher.start(frame);
  EXPECT_EQ(matcher.match(frame, at(100, 100), 90, 0.9), 1);  // not the one below the window, not the one too coarse
  EXPECT_EQ(matcher.tag_of(1), 5);
  EXPECT_EQ(matcher.tag_of(0), kNone);
  EXPECT_EQ(matcher.count(), 1);
  EXPECT_EQ(matcher.match(frame, at(200, 100), 90, 0.9), -1);
}

TEST(Matcher, RefusesALookTooFarOff) {
  const Frame frame = frame_of({{100, 100, 60}});
  Matcher matcher(20);
  matcher.start(frame);
  EXPECT_EQ(matcher.match(frame, at(100, 100), 59, 0.9), -1);
  EXPECT_EQ(matcher.match(frame, at(100, 100), 60, 0.9), 0);
}

TEST(Matcher, RefusesToChooseBetweenTwins) {
  const Frame twins = frame_of({{100, 100, 40}, {105, 100, 42}});
  const Frame twins_of_two_sizes = frame_of({{100, 100, 40, 0}, {105, 100, 42, 1}});
  Matcher matcher(20);
  matcher.start(twins);
  EXPECT_EQ(matcher.match(twins, at(100, 100), 90, 0.9), -1);
  matcher.start(twins_of_two_sizes);  // the same corner found on two levels is no rival
  EXPECT_EQ(matcher.match(twins_of_two_sizes, at(100, 100), 90, 0.9), 0);
}

TEST(Matcher, LeavesAFeatureToTheCloserLook) {
  const Frame frame = frame_of({{100, 100, 20}});
  const Descriptor closer = bits(15), farther = bits(60);
  Matcher matcher(20);
  matcher.start(frame);
  EXPECT_EQ(matcher.match(frame, at(100, 100, 1), 90, 0.9), 0);
  MatchCandidate candidate = at(101, 100, 2);
  candidate.descriptor = &farther;
  EXPECT_EQ(matcher.match(frame, candidate, 90, 0.9), -1);
  EXPECT_EQ(matcher.tag_of(0), 1);
  candidate.descriptor = &closer;
  EXPECT_EQ(matcher.match(frame, candidate, 90, 0.9), 0);
  EXPECT_EQ(matcher.tag_of(0), 2);
  EXPECT_EQ(matcher.count(), 1);  // it stayed one feature
}

TEST(Matcher, ForgetsWhatIsReleasedAndWhatWasBefore) {
  const Frame frame = frame_of({{100, 100, 20}, {200, 100, 20}});
  Matcher matcher(20);
  matcher.start(frame);
  matcher.match(frame, at(100, 100, 1), 90, 0.9);
  matcher.match(frame, at(200, 100, 2), 90, 0.9);
  matcher.release(0);
  matcher.release(0);
  EXPECT_EQ(matcher.count(), 1);
  EXPECT_EQ(matcher.match(frame, at(100, 100, 3), 90, 0.9), 0);
  matcher.start(frame);
  EXPECT_EQ(matcher.count(), 0);
  EXPECT_EQ(matcher.tag_of(1), kNone);
}

}  // namespace povslam
