#include "pipeline/frontend/object_wishes.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

constexpr int kFeatures = 60;
constexpr std::int64_t kThing = 7;

// One keyframe whose landmarks stand in a row before the camera; the frame is the same view of them.
class Wishes : public testing::Test {
 protected:
  Wishes()
      : frame(made::random_frame(camera, options(), kFeatures, 1)),
        map(kFeatures, options().map, made::level_scales()),
        local_map(options().map) {
    map.insert_keyframe(frame, frame.T_camera_world.inverse(), Matrix6d::Zero(), kNone);
    for (int f = 0; f < kFeatures; ++f) {
      const Eigen::Vector3d p_camera(-0.5 + 0.005 * f, 0.0, 2.0);
      frame.landmark[static_cast<std::size_t>(f)] =
          map.create_landmark(0, f, frame.T_camera_world.inverse() * p_camera);
      frame.x[static_cast<std::size_t>(f)] = static_cast<float>(camera.fx * p_camera.x() / 2.0 + camera.cx);
      frame.y[static_cast<std::size_t>(f)] = static_cast<float>(camera.cy);
    }
    map.update_covisibility(0);
    local_map.collect(map, frame, frame.T_camera_world.inverse());
  }
  static FrontendOptions options() {
    FrontendOptions options;
    options.orb.num_features = kFeatures;
    options.map.max_keyframes = 10;
    options.map.max_landmarks = 500;
    return options;
  }
  // The first `known` landmarks are the thing's, of which the frame saw the first `seen`.
  void own(int known, int seen) {
    for (int f = 0; f < known; ++f) {
      std::int32_t& slot = frame.landmark[static_cast<std::size_t>(f)];
      map.landmark(slot).owner = kThing;
      if (f >= seen) slot = kNone;
    }
  }

  PinholeCamera camera = made::half_camera();
  Frame frame;
  Map map;
  LocalMap local_map;
  ObjectWishes wishes{camera, 24};
};

TEST_F(Wishes, AreForAThingOfWhichLittleWasSeen) {
  own(20, 6);
  const auto wished = wishes.after(map, local_map, frame);
  ASSERT_EQ(wished.size(), 1U);
  for (std::size_t f = 0; f < 20; ++f) {
    EXPECT_GE(frame.x[f], wished[0].x0) << "all of it that the map knows";
    EXPECT_LE(frame.x[f], wished[0].x1);
  }
  EXPECT_LT(wished[0].x1, frame.x[40]);
}

TEST_F(Wishes, AreNotForStructureNorForWhatWasSeenWell) {
  EXPECT_TRUE(wishes.after(map, local_map, frame).empty());
  own(30, 30);
  EXPECT_TRUE(wishes.after(map, local_map, frame).empty());
}

TEST_F(Wishes, AreNotForAThingThatIsBelievedToBeElsewhere) {
  own(20, 6);
  map.object_trust().set(kThing, 0.0);
  EXPECT_TRUE(wishes.after(map, local_map, frame).empty());
}

TEST_F(Wishes, CanBeSwitchedOffAndDoNotAllocate) {
  own(20, 6);
  EXPECT_TRUE(ObjectWishes(camera, 0).after(map, local_map, frame).empty());
  if (!counting_works()) GTEST_SKIP() << "sanitizers interpose the heap themselves";
  start_counting();
  wishes.after(map, local_map, frame);
  EXPECT_EQ(stop_counting().allocations, 0U);
}

}  // namespace
}  // namespace povslam
