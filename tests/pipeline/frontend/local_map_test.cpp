#include "pipeline/frontend/local_map.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

constexpr int kFeatures = 60;

// A drive along x: keyframe k stands at x = 2 k and sees landmarks that its neighbour sees, too.
struct Street {
  explicit Street(int keyframes)
      : frame(made::random_frame(made::half_camera(), options(), kFeatures, 1)),
        map(kFeatures, options().map, made::level_scales()),
        local_map(options().map) {
    for (std::int32_t k = 0; k < keyframes; ++k) {
      map.insert_keyframe(frame, made::looking_along_y({2.0 * k, 0, 0}), Matrix6d::Zero(), k - 1);
      for (int f = 0; k > 0 && f < 20; ++f) map.add_sighting(map.keyframe(k - 1).landmark[own(f)], k, f);
      for (int f = 20; f < kFeatures; ++f) map.create_landmark(k, f, {2.0 * k, 3.0, 0.0});
      map.update_covisibility(k);
    }
  }
  static std::size_t own(int f) { return static_cast<std::size_t>(kFeatures - 1 - f); }
  static FrontendOptions options() {
    FrontendOptions options;
    options.orb.num_features = kFeatures;
    options.map.max_keyframes = 100;
    options.map.max_landmarks = 20000;
    return options;
  }
  void see(std::int32_t keyframe, int count) {  // the frame saw what the keyframe alone sees
    std::fill_n(frame.landmark.begin(), kFeatures, kNone);
    for (int f = 0; f < count; ++f) {
      frame.landmark[static_cast<std::size_t>(f)] = map.keyframe(keyframe).landmark[static_cast<std::size_t>(20 + f)];
    }
  }
  bool holds(std::int32_t keyframe) const { return std::ranges::count(local_map.keyframes(), keyframe) > 0; }

  Frame frame;
  Map map;
  LocalMap local_map;
};

}  // namespace

TEST(LocalMap, BeginsWithTheKeyframeThatSharesMost) {
  Street street(12);
  street.see(6, 15);
  for (int f = 20; f < 50; ++f) {
    street.frame.landmark[static_cast<std::size_t>(f)] = street.map.keyframe(3).landmark[static_cast<std::size_t>(f)];
  }
  street.local_map.collect(street.map, street.frame, made::looking_along_y({100.0, 0, 0}));
  EXPECT_EQ(street.local_map.reference(), 3);
  for (const std::int32_t k : {2, 3, 4, 5, 6, 7}) EXPECT_TRUE(street.holds(k)) << k;  // sharing, and their neighbours
  for (const std::int32_t k : {0, 9, 10, 11}) EXPECT_FALSE(street.holds(k)) << k;
  EXPECT_TRUE(street.local_map.remote().empty());
}

TEST(LocalMap, ContainsEveryLandmarkOfItsKeyframesOnce) {
  Street street(12);
  street.see(5, 30);
  street.local_map.collect(street.map, street.frame, made::looking_along_y({10.0, 0, 0}));
  std::vector<std::int32_t> expected, collected;
  for (const std::int32_t k : street.local_map.keyframes()) {
    EXPECT_EQ(street.map.keyframe(k).mark, street.map.keyframe(street.local_map.reference()).mark);
    std::ranges::copy_if(street.map.keyframe(k).landmark, std::back_inserter(expected), [](auto l) { return l >= 0; });
  }
  std::ranges::copy(street.local_map.landmarks(), std::back_inserter(collected));
  std::ranges::sort(expected);
  expected.erase(std::ranges::unique(expected).begin(), expected.end());
  std::ranges::sort(collected);
  EXPECT_EQ(collected, expected);
}

TEST(LocalMap, AddsWhatStandsNearAndLooksTheSameWay) {
  Street street(12);
  std::fill_n(street.frame.landmark.begin(), kFeatures, kNone);  // nothing shared: back after a long loop
  street.local_map.collect(street.map, street.frame, made::looking_along_y({10.5, 0, 0}));
  EXPECT_EQ(street.local_map.reference(), 5);
  for (const std::int32_t k : {4, 5, 6, 7}) EXPECT_TRUE(street.holds(k)) << k;
  for (const std::int32_t k : {0, 1, 2, 8, 11}) EXPECT_FALSE(street.holds(k)) << k;
  EXPECT_TRUE(street.local_map.joined().empty());
  const Rigid3 back = made::looking_along_y({10.5, 0, 0}) * Rigid3{so3_exp({0, 3.14, 0}), Eigen::Vector3d::Zero()};
  street.local_map.collect(street.map, street.frame, back);
  EXPECT_EQ(street.local_map.reference(), kNone);
  EXPECT_TRUE(street.local_map.landmarks().empty());
}

TEST(LocalMap, TellsWhatHangsTogetherWithTheFrameFromWhatSharesAFewLandmarks) {
  Street street(40);
  street.see(9, 32);
  for (int f = 32; f < 38; ++f) {  // by chance six of an older visit's fit
    street.frame.landmark[static_cast<std::size_t>(f)] = street.map.keyframe(2).landmark[static_cast<std::size_t>(f)];
  }
  street.local_map.collect(street.map, street.frame, made::looking_along_y({100.0, 0, 0}));
  EXPECT_EQ(street.local_map.reference(), 9);
  EXPECT_TRUE(street.holds(2));
  const auto belongs = [&](std::span<const std::int32_t> landmarks, std::int32_t keyframe) {
    return std::ranges::count(landmarks, street.map.keyframe(keyframe).landmark[25]) == 1;
  };
  EXPECT_TRUE(belongs(street.local_map.joined(), 9));
  EXPECT_TRUE(belongs(street.local_map.joined(), 8)) << "a neighbour";
  EXPECT_TRUE(belongs(street.local_map.remote(), 2));
}

TEST(LocalMap, StaysBoundedAndAllocatesNothing) {
  if (!counting_works()) GTEST_SKIP() << "the sanitizer owns malloc";
  Street street(100);
  for (std::int32_t k = 0; k < 100; ++k)
    street.map.keyframe(k).T_world_camera = made::looking_along_y({0.01 * k, 0, 0});
  for (int f = 0; f < kFeatures; ++f) {
    street.frame.landmark[static_cast<std::size_t>(f)] = street.map.keyframe(f).landmark[30];
  }
  start_counting();
  street.local_map.collect(street.map, street.frame, made::looking_along_y({0.5, 0, 0}));
  EXPECT_EQ(stop_counting().allocations, 0U);
  EXPECT_EQ(street.local_map.keyframes().size(), 24U + 2U + 16U);  // sharing, the neighbours of these, near
  EXPECT_LE(street.local_map.landmarks().size(), 6000U);
}

}  // namespace povslam
