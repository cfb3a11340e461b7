#include "pipeline/frontend/redundancy.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"

namespace povslam {
namespace {

constexpr int kFeatures = 100;

struct Full {
  explicit Full(int max_keyframes = 8, int max_landmarks = 2000) {
    options.orb.num_features = kFeatures;
    options.map.max_keyframes = max_keyframes;
    options.map.max_landmarks = max_landmarks;
    map.emplace(kFeatures, options.map, made::level_scales());
  }
  // A keyframe that makes `fresh` landmarks and sees the first `shared` of keyframe `other`.
  std::int32_t keep(int fresh, std::int32_t other = kNone, int shared = 0) {
    const Frame frame = made::random_frame(camera, options, kFeatures, static_cast<unsigned>(map->next_keyframe_id()));
    const std::int32_t slot = map->insert_keyframe(frame, Rigid3{}, Matrix6d::Zero(), map->next_keyframe_id() - 1);
    for (int f = 0; f < shared; ++f) {
      map->add_sighting(map->keyframe(other).landmark[static_cast<std::size_t>(f)], slot, f);
    }
    for (int f = shared; f < shared + fresh; ++f) map->create_landmark(slot, f, Eigen::Vector3d(0.0, 0.0, 2.0 + f));
    return slot;
  }

  PinholeCamera camera = made::half_camera();
  FrontendOptions options;
  std::optional<Map> map;
};

}  // namespace

TEST(Redundancy, TellsHowFarTheImageMoves) {
  const PinholeCamera camera = made::half_camera();
  const Rigid3 here = made::looking_along_y({1.0, 2.0, 3.0});
  const Rigid3 aside = made::looking_along_y({1.2, 2.0, 3.0});
  const Rigid3 turned{here.rotation * so3_exp({0.0, 0.1, 0.0}), here.translation};
  EXPECT_NEAR(image_shift(camera, here, here, 0.5), 0.0, 1e-6);
  EXPECT_NEAR(image_shift(camera, here, aside, 0.5), 0.2 * 0.5 * camera.fx / camera.width, 1e-9);  // 26 px of 320
  EXPECT_NEAR(image_shift(camera, here, aside, 0.0), 0.0, 1e-6);
  EXPECT_NEAR(image_shift(camera, here, turned, 0.5), 0.1 * camera.fx / camera.width, 1e-9);
}

TEST(Redundancy, CountsWhatThreeOthersDoNotSee) {
  Full full;
  const std::int32_t first = full.keep(50);
  for (int k = 0; k < 2; ++k) full.keep(0, first, 20);
  EXPECT_EQ(use_of(*full.map, first).seen, 50);
  EXPECT_EQ(use_of(*full.map, first).own, 50);
  full.keep(0, first, 15);
  EXPECT_EQ(use_of(*full.map, first).own, 35);
}

TEST(Redundancy, DoesNotCountAViewFromFartherAway) {
  Full full;
  const std::int32_t first = full.keep(50);
  for (int k = 0; k < 3; ++k) full.keep(0, first, 50);
  EXPECT_EQ(use_of(*full.map, first).own, 0);
  for (std::uint8_t& level : full.map->keyframe(1).level) level = 4;
  EXPECT_EQ(use_of(*full.map, first).own, 50);
}

TEST(Redundancy, MakesRoomWhereTheLeastIsLost) {
  Full full(4);
  const std::int32_t root = full.keep(5);
  full.keep(60);
  const std::int32_t poor = full.keep(10);
  KeyframeRoom room;
  room.make(*full.map, 4);
  EXPECT_EQ(full.map->num_keyframes(), 3);  // there was room
  full.keep(60);
  room.make(*full.map, 4);
  EXPECT_EQ(full.map->num_keyframes(), 3);
  EXPECT_FALSE(full.map->keyframe(poor).alive);
  EXPECT_TRUE(full.map->keyframe(root).alive);  // poorer still, but the world hangs there
  EXPECT_EQ(broken_sightings(*full.map), "");
}

TEST(Redundancy, ForgetsTheLandmarksSeldomFoundWhenThereAreTooMany) {
  Full full(8, 300);
  for (int k = 0; k < 3; ++k) full.keep(90);
  for (std::int32_t l = 0; l < 270; ++l) {
    full.map->landmark(l).visible = 100;
    full.map->landmark(l).found = l % 3 == 0 ? 10 : 60;
  }
  LandmarkRoom room(kFeatures);
  room.make(*full.map, 300, 30);
  EXPECT_EQ(full.map->num_landmarks(), 270);  // there was room
  room.make(*full.map, 300, 90);
  EXPECT_EQ(full.map->num_landmarks(), 210);
  for (std::int32_t l = 0; l < 270; ++l) EXPECT_TRUE(full.map->landmark(l).alive || l % 3 == 0) << l;
  EXPECT_EQ(broken_sightings(*full.map), "");
}

TEST(Redundancy, WalksThroughAllLandmarksInTurn) {
  Full full(8, 800);
  for (int k = 0; k < 8; ++k) full.keep(100);
  LandmarkRoom room(10);  // looks at 40 a time
  for (int k = 0; k < 20; ++k) {
    room.make(*full.map, 800 - 10 * k, 10);
    EXPECT_EQ(full.map->num_landmarks(), 800 - 10 * (k + 1));
  }
  for (std::int32_t first = 0; first < 800; first += 100) {
    int alive = 0;
    for (std::int32_t l = first; l < first + 100; ++l) alive += full.map->landmark(l).alive ? 1 : 0;
    EXPECT_NEAR(alive, 75, 15) << first;
  }
}

}  // namespace povslam
