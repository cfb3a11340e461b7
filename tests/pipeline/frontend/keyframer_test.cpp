#include "pipeline/frontend/keyframer.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/map_invariants.hpp"
#include "tests/pipeline/frontend/simulated_view.hpp"

namespace povslam {
namespace {

struct Story {
  explicit Story(FrontendOptions chosen = small_frontend())
      : view(small_drive(1)),
        camera(view.calibration().camera),
        options(chosen),
        builder(camera, options),
        frame(camera, options),
        map(options.orb.num_features, options.map, builder.level_scales()),
        keyframer(camera, options) {
    see(2.0);
  }
  void see(double time_s) {
    builder.build(view.drive(time_s), 1.0, frame);
    frame.T_camera_world = view.T_world_camera(time_s).inverse();
  }
  std::int32_t keep() {
    const std::int32_t slot = keyframer.insert(map, builder, frame, Matrix6d::Zero(), map.next_keyframe_id() - 1);
    frame.index += 5;
    return slot;
  }
  // The same view again: the frame sees the landmarks of the first keyframe.
  void see_again(int first, int step) {
    for (int f = 0; f < frame.size(); ++f) {
      const std::int32_t seen = map.keyframe(0).landmark[static_cast<std::size_t>(f)];
      frame.landmark[static_cast<std::size_t>(f)] = f >= first && (f - first) % step == 0 ? seen : kNone;
    }
  }
  void move(double metres) { frame.T_camera_world.translation.x() -= metres; }
  bool wanted(int num_inliers, bool weak = false) { return keyframer.wanted(frame, map, newest, num_inliers, weak); }

  SimulatedView view;
  PinholeCamera camera;
  FrontendOptions options;
  FrameBuilder builder;
  Frame frame;
  Map map;
  Keyframer keyframer;
  std::int32_t newest = 0;
};

}  // namespace

TEST(Keyframer, MakesALandmarkOfEveryFeatureWithDepth) {
  Story story;
  const std::int32_t slot = story.keep();
  const Keyframe& kf = story.map.keyframe(slot);
  int with_depth = 0, with_patch = 0;
  for (int f = 0; f < story.frame.size(); ++f) {
    const std::int32_t made = kf.landmark[static_cast<std::size_t>(f)];
    ASSERT_EQ(made != kNone, story.frame.has_depth(f));
    if (made == kNone) continue;
    ++with_depth;
    with_patch += story.map.landmark(made).has_patch ? 1 : 0;
    const Eigen::Vector3d p = story.frame.T_camera_world * story.map.landmark(made).p_world;
    EXPECT_NEAR(1.0 / p.z(), story.frame.inverse_depth[static_cast<std::size_t>(f)], 1e-6);
    const auto pixel = story.camera.project(p);
    EXPECT_NEAR(pixel->x(), story.frame.x[static_cast<std::size_t>(f)], 1e-3);
    EXPECT_NEAR(pixel->y(), story.frame.y[static_cast<std::size_t>(f)], 1e-3);
  }
  EXPECT_EQ(story.map.num_landmarks(), with_depth);
  EXPECT_GT(with_depth, 300);
  EXPECT_GT(with_patch, 0.8 * with_depth);
}

TEST(Keyframer, GivesAPatchTheSizeOfTheSurfaceItShows) {
  Story story;
  story.keep();
  for (std::int32_t l = 0; l < story.map.landmark_slots(); ++l) {
    const Landmark& point = story.map.landmark(l);
    if (!point.has_patch) continue;
    // One pixel of the patch to the side, projected, is one pixel of its level to the side.
    const float scale = story.builder.level_scale(point.reference_level);
    const auto here = story.camera.project(story.frame.T_camera_world * point.p_world);
    const auto right =
        story.camera.project(story.frame.T_camera_world * (point.p_world + point.tangent_x.cast<double>()));
    const auto below =
        story.camera.project(story.frame.T_camera_world * (point.p_world + point.tangent_y.cast<double>()));
    EXPECT_LT((*right - *here - Eigen::Vector2d(scale, 0.0)).norm(), 0.15 * scale);
    EXPECT_LT((*below - *here - Eigen::Vector2d(0.0, scale)).norm(), 0.15 * scale);
  }
}

TEST(Keyframer, AddsASightingWhereALandmarkWasSeenAgain) {
  Story story;
  story.keep();
  const int before = story.map.num_landmarks();
  story.see_again(0, 2);
  story.keep();
  int twice = 0;
  for (std::int32_t l = 0; l < before; ++l) twice += story.map.landmark(l).num_sightings == 2 ? 1 : 0;
  EXPECT_NEAR(twice, before / 2, before / 8);
  EXPECT_EQ(story.map.num_landmarks(), before + before - twice);
  ASSERT_EQ(story.map.keyframe(1).num_covisible, 1);
  EXPECT_EQ(story.map.keyframe(1).covisible[0].weight, twice);
}

TEST(Keyframer, SurvivesThatTheFramesLandmarksAreEvictedToMakeRoomForIt) {
  FrontendOptions options = small_frontend();
  options.map.max_keyframes = 4;
  Story story(options);
  for (int k = 0; k < 4; ++k) {
    std::fill_n(story.frame.landmark.begin(), story.frame.size(), kNone);
    story.keep();
  }
  for (int f = 0; f < story.frame.size(); ++f) {  // seen by nothing but the keyframe that goes
    story.frame.landmark[static_cast<std::size_t>(f)] = story.map.keyframe(1).landmark[static_cast<std::size_t>(f)];
  }
  const std::int32_t slot = story.keep();
  EXPECT_EQ(story.map.num_keyframes(), 4);
  for (int f = 0; f < story.frame.size(); ++f) {
    const std::int32_t seen = story.map.keyframe(slot).landmark[static_cast<std::size_t>(f)];
    ASSERT_EQ(seen != kNone, story.frame.has_depth(f));
    if (seen != kNone) {
      ASSERT_TRUE(story.map.landmark(seen).alive);
      ASSERT_TRUE(story.map.sees(slot, seen));
    }
  }
}

TEST(Keyframer, KeepsNothingWhileTheCameraStandsStill) {
  Story story;
  story.keep();
  story.frame.index = 1000;
  EXPECT_FALSE(story.wanted(500));
  EXPECT_FALSE(story.wanted(20));
  EXPECT_FALSE(story.wanted(20, true));
}

TEST(Keyframer, KeepsAFrameWhenTheViewHasChanged) {
  Story story;
  story.keep();
  const int all = story.map.num_landmarks();
  story.move(0.1);
  story.frame.index = 2;
  EXPECT_FALSE(story.wanted(10));       // too soon…
  EXPECT_TRUE(story.wanted(10, true));  // …unless the pose hangs on few
  story.frame.index = 4;
  EXPECT_FALSE(story.wanted(all));          // all known
  EXPECT_TRUE(story.wanted(all * 7 / 10));  // a quarter of the landmarks went out of view
}

TEST(Keyframer, KeepsAFrameAfterAWhileUnlessAnEarlierVisitSawItsView) {
  Story story;
  story.keep();
  const int all = story.map.num_landmarks();
  story.move(0.1);
  story.frame.index = story.options.map.keyframe_max_frames;
  EXPECT_TRUE(story.wanted(all));
  story.frame.index = 20L * story.options.map.keyframe_max_frames;
  EXPECT_FALSE(story.wanted(all));
  story.move(1.5);
  EXPECT_TRUE(story.wanted(all));
  story.move(-1.5);
  EXPECT_FALSE(story.wanted(all));
  story.frame.T_camera_world.rotation = so3_exp({0.0, 0.4, 0.0}) * story.frame.T_camera_world.rotation;
  EXPECT_TRUE(story.wanted(all));
}

TEST(Keyframer, LearnsNothingOnAVisitThatFindsWhatIsKnown) {
  Story story;
  story.keep();
  const int all = story.map.num_landmarks();
  for (std::int32_t l = 0; l < all; ++l) {
    if (l % 3 != 0) story.map.remove_landmark(l);  // of the features of one visit the next finds a third
  }
  story.move(0.1);
  story.frame.index = 20;
  EXPECT_TRUE(story.wanted(all / 3));  // on the way such a view is hardly known…
  story.frame.index = 20L * story.options.map.keyframe_max_frames;
  EXPECT_FALSE(story.wanted(all / 3));  // …later it is as well known as it will be…
  EXPECT_TRUE(story.wanted(all / 5));   // …unless something is different now
}

// Drift has put a copy of the place beside itself: as much is found here, but nothing of the earlier visit.
TEST(Keyframer, LearnsOnBesideAnEarlierVisitThatIsNotJoined) {
  Story story;
  story.keep();
  const int all = story.map.num_landmarks();
  story.move(0.1);
  story.frame.index = 20L * story.options.map.keyframe_max_frames;
  ASSERT_FALSE(story.wanted(all));
  story.see_again(0, 5);  // a fifth of it is the earlier visit's: chance
  EXPECT_TRUE(story.wanted(all));
}

TEST(Keyframer, KeepsNoMoreThanAFewKeyframesOfOneView) {
  Story story;
  story.keep();
  for (int k = 0; k < 60; ++k) {
    // Nothing is recognised, as if the light had changed: by what they see no keyframe is redundant.
    std::fill_n(story.frame.landmark.begin(), story.frame.size(), kNone);
    story.move(k % 2 == 0 ? 0.02 : -0.02);
    story.keyframer.cull(story.map, story.keep());
    EXPECT_LE(story.map.num_keyframes(), 22);  // the first, and the way here
    ASSERT_EQ(broken_sightings(story.map), "");
  }
  EXPECT_NE(story.map.find_keyframe(0), kNone);  // where the world hangs
  EXPECT_NE(story.map.find_keyframe(60), kNone);
}

TEST(Keyframer, LearnsOnWhenTheMapIsFull) {
  FrontendOptions options = small_frontend();
  options.map.max_keyframes = 6;
  options.map.max_landmarks = 1000;
  Story story(options);
  for (int k = 0; k < 30; ++k) {
    story.move(2.0);  // another view each time
    std::fill_n(story.frame.landmark.begin(), story.frame.size(), kNone);
    const std::int32_t slot = story.keep();
    int with_depth = 0;
    for (int f = 0; f < story.frame.size(); ++f) with_depth += story.frame.has_depth(f) ? 1 : 0;
    EXPECT_EQ(landmarks_seen(story.map.keyframe(slot)), with_depth) << k;
    EXPECT_LE(story.map.num_keyframes(), 6);
    EXPECT_LE(story.map.num_landmarks(), 1000);
    ASSERT_EQ(broken_sightings(story.map), "");
  }
  EXPECT_NE(story.map.find_keyframe(0), kNone);  // where the world hangs
}

TEST(Keyframer, KeepsAViewTheMapHardlyKnowsAfterAnyMotion) {
  Story story;
  story.keep();
  story.frame.index = 4;
  story.move(0.02);
  EXPECT_TRUE(story.wanted(100));
  EXPECT_FALSE(story.wanted(500));
}

TEST(Keyframer, ForgetsLandmarksThatAreNotFoundAgain) {
  Story story;
  story.keep();
  const int before = story.map.num_landmarks();
  for (std::int32_t l = 0; l < 20; ++l) story.map.landmark(l).visible = 10;  // found once of ten times
  for (std::int32_t l = 20; l < 40; ++l) {
    story.map.landmark(l).visible = 10;
    story.map.landmark(l).found = 5;
  }
  story.keyframer.cull(story.map, 0);
  EXPECT_EQ(story.map.num_landmarks(), before - 20);
  for (std::int32_t l = 0; l < before; ++l) EXPECT_EQ(story.map.landmark(l).alive, l >= 20);
}

TEST(Keyframer, ForgetsLandmarksThatNoLaterKeyframeSaw) {
  Story story;
  story.keep();
  const int before = story.map.num_landmarks();
  for (int k = 1; k <= 3; ++k) {
    story.see_again(0, 2);
    for (int f = 0; f < story.frame.size(); ++f) {
      // Only what is known is seen: no new landmarks.
      if (story.frame.landmark[static_cast<std::size_t>(f)] == kNone) {
        story.frame.inverse_depth[static_cast<std::size_t>(f)] = 0.0F;
      }
    }
    const std::int32_t slot = story.keep();
    EXPECT_EQ(story.map.num_landmarks(), before) << k;
    story.keyframer.cull(story.map, slot);
  }
  EXPECT_NEAR(story.map.num_landmarks(), before / 2, before / 8);
  for (std::int32_t l = 0; l < story.map.landmark_slots(); ++l) {
    if (!story.map.landmark(l).alive) continue;
    EXPECT_EQ(story.map.landmark(l).num_sightings, 4);
  }
}

TEST(Keyframer, RemovesAKeyframeWhoseLandmarksOthersSeeAsWell) {
  Story story;
  story.keep();
  std::int32_t slot = 0;
  for (int k = 1; k <= 6; ++k) {
    story.see_again(0, 1);
    slot = story.keep();
    story.keyframer.cull(story.map, slot);
    EXPECT_EQ(story.map.num_keyframes(), std::min(k + 1, 4));  // the first, and the newest three
  }
  EXPECT_NE(story.map.find_keyframe(0), kNone);
  EXPECT_EQ(story.map.find_keyframe(1), kNone);
  EXPECT_TRUE(story.map.keyframe_pose(1));
  EXPECT_NE(story.map.find_keyframe(6), kNone);
}

}  // namespace povslam
