#include "drivers/synthetic/scene.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>

#include "drivers/synthetic/faces.hpp"
#include "drivers/synthetic/ground.hpp"
#include "drivers/synthetic/layout.hpp"
#include "drivers/synthetic/raster.hpp"
#include "tests/drivers/synthetic/support.hpp"

namespace povslam::synthetic {

namespace {

struct Laid {
  SyntheticOptions options;
  RobotMotion motion;
  Scene scene;
};

Laid lay(const std::string& name, std::uint64_t seed) {
  SyntheticOptions options = small_options(name, seed);
  RobotMotion motion(scene_path(name, seed), options.speed_mps, seed);
  Result<Scene> scene = build_scene(options, motion);
  EXPECTS(scene);
  return {options, motion, std::move(*scene)};
}

int count(const Scene& scene, Change change) {
  return static_cast<int>(std::count_if(scene.objects.begin(), scene.objects.end(),
                                        [change](const Object& object) { return object.change() == change; }));
}

bool on_floor(const Object& object, const Placement& place) {
  return place.position.z() - 0.5 * object.size_m.z() < 1e-6;
}

// Whether the object, standing there, wins any pixel of the full camera at that time, all others where they are then.
bool wins_a_pixel(const Laid& laid, std::size_t index, const Placement& place, double time_s) {
  const View view(SyntheticOptions{}.camera, laid.motion.T_world_camera(time_s));
  std::vector<ProjectedFace> faces;
  for (std::size_t i = 0; i < laid.scene.objects.size(); ++i) {
    view.add_faces(laid.scene.objects[i], static_cast<int>(i), i == index ? place : laid.scene.objects[i].at(time_s),
                   faces);
  }
  Raster raster;
  raster.cast(view, faces);
  const auto hits = raster.hit().pixels();
  return std::any_of(hits.begin(), hits.end(), [&](std::int32_t hit) {
    return hit >= Raster::kFirstFace &&
           faces[static_cast<std::size_t>(hit - Raster::kFirstFace)].object == static_cast<int>(index);
  });
}

}  // namespace

class SceneNamed : public testing::TestWithParam<const char*> {};

TEST_P(SceneNamed, KeepsThingsApartAndOffThePathBeforeAndAfter) {
  const Laid laid = lay(GetParam(), 4);
  const std::vector<Eigen::Vector2d> path = sample_path(laid.scene.path);
  const auto& objects = laid.scene.objects;
  for (std::size_t i = 0; i < objects.size(); ++i) {
    if (objects[i].class_id == ClassId::goods) continue;  // they stand in racks
    for (const Placement& place : {objects[i].before, objects[i].after}) {
      if (!place.present || !on_floor(objects[i], place)) continue;
      EXPECT_GE(clearance_m(footprint(objects[i], place), path), 0.4) << objects[i].id;
      for (std::size_t j = 0; j < objects.size(); ++j) {
        for (const Placement& other : {objects[j].before, objects[j].after}) {
          if (i == j || !other.present || objects[j].class_id == ClassId::goods || objects[i].class_id == ClassId::wall)
            continue;
          EXPECT_FALSE(overlap(footprint(objects[i], place), footprint(objects[j], other), 0.0))
              << objects[i].id << ' ' << objects[j].id;
        }
      }
    }
  }
}

TEST_P(SceneNamed, ChangesOnlyWhatTheCameraDoesNotSee) {
  const Laid laid = lay(GetParam(), 4);
  for (std::size_t i = 0; i < laid.scene.objects.size(); ++i) {
    const Object& object = laid.scene.objects[i];
    if (object.change() == Change::unchanged) continue;
    EXPECT_GT(object.switch_time_s, 0.3 * laid.motion.lap_end_s(1.0));
    EXPECT_LE(object.switch_time_s, laid.motion.lap_end_s(1.5));
    for (const double around_s : {-0.1, 0.0, 0.1}) {
      const double t = object.switch_time_s + around_s;
      EXPECT_FALSE(object.before.present && wins_a_pixel(laid, i, object.before, t)) << object.id << " is seen leaving";
      EXPECT_FALSE(object.after.present && wins_a_pixel(laid, i, object.after, t)) << object.id << " is seen coming";
    }
  }
}

INSTANTIATE_TEST_SUITE_P(All, SceneNamed,
                         testing::Values("boxsim", "aisle", "majority", "adversarial", "twins", "rooms", "hall"));

TEST(BoxScenes, HaveSeventeenBoxesOfWhichTheRightNumberMoves) {
  for (const auto& [name, moved] : {std::pair{"boxsim", 6}, {"static", 0}, {"majority", 11}, {"adversarial", 6}}) {
    const Laid laid = lay(name, 2);
    EXPECT_EQ(laid.scene.objects.size(), 17U);
    EXPECT_EQ(count(laid.scene, Change::moved), moved) << name;
    for (const Object& object : laid.scene.objects) {
      EXPECT_GE(object.size_m.minCoeff(), 0.5);
      EXPECT_LE(object.size_m.maxCoeff(), 1.2);
      const double shift_m = (object.after.position - object.before.position).norm();
      if (object.change() != Change::moved) continue;
      EXPECT_TRUE(shift_m >= 0.5 && shift_m <= 1.5) << shift_m;
    }
  }
}

TEST(BoxScenes, AreTheSameBeforeTheChangeForOneSeed) {
  const Laid a = lay("boxsim", 2), b = lay("static", 2);
  for (std::size_t i = 0; i < a.scene.objects.size(); ++i) {
    EXPECT_EQ(a.scene.objects[i].before.position, b.scene.objects[i].before.position);
  }
  EXPECT_NE(lay("static", 3).scene.objects[0].before.position, b.scene.objects[0].before.position);
}

TEST(BoxScenes, AdversarialBoxesShareOneShift) {
  const Laid laid = lay("adversarial", 5);
  std::vector<Eigen::Vector3d> shifts;
  for (const Object& object : laid.scene.objects) {
    if (object.change() == Change::moved) shifts.push_back(object.after.position - object.before.position);
  }
  for (const Eigen::Vector3d& shift : shifts) EXPECT_LT((shift - shifts.front()).norm(), 1e-9);
}

TEST(AisleScene, HasEveryKindOfChangeAndPeopleWhenAsked) {
  const Laid laid = lay("aisle", 1);
  for (const Change change : {Change::moved, Change::removed, Change::appeared})
    EXPECT_GE(count(laid.scene, change), 1);
  SyntheticOptions options = small_options("aisle", 1);
  options.movers = 3;
  const Result<Scene> scene = build_scene(options, laid.motion);
  ASSERT_TRUE(scene);
  int people = 0;
  for (const Object& object : scene->objects) {
    if (!object.walk) continue;
    ++people;
    EXPECT_GT((object.at(10.0).position - object.at(10.4).position).norm(), 0.01);
    EXPECT_LT((object.at(10.0).position - object.at(10.1).position).norm(), 0.12);
  }
  EXPECT_EQ(people, 3);
}

TEST(Scene, StaysAsItIsWhenNothingIsToChange) {
  for (const std::string& name : scene_names()) {
    SyntheticOptions options = small_options(name, 2);
    const RobotMotion motion(scene_path(name, 2), options.speed_mps, 2);
    const Result<Scene> changing = build_scene(options, motion);
    options.changes = false;
    const Result<Scene> still = build_scene(options, motion);
    ASSERT_TRUE(changing && still);
    std::vector<Object> at_first = changing->objects;
    std::erase_if(at_first, [](const Object& object) { return !object.before.present; });
    ASSERT_EQ(still->objects.size(), at_first.size());
    for (std::size_t i = 0; i < at_first.size(); ++i) {
      EXPECT_EQ(still->objects[i].change(), Change::unchanged);
      EXPECT_EQ(still->objects[i].before.position, at_first[i].before.position);
    }
  }
}

TEST(TwinsScene, GivesEachObjectOfABayItsTwinsInTheOthers) {
  const Laid laid = lay("twins", 2);
  EXPECT_EQ(laid.scene.twin_pitch_m, kTwinPitch_m);
  int twins = 0;
  for (const Object& object : laid.scene.objects) {
    if (object.print == 0) continue;
    const Object& first = laid.scene.objects[object.print - 1U];
    const Eigen::Vector3d shift = object.before.position - first.before.position;
    EXPECT_EQ(object.size_m, first.size_m);
    EXPECT_EQ(object.before.yaw, first.before.yaw);
    EXPECT_EQ(shift.tail<2>(), Eigen::Vector2d::Zero());
    EXPECT_NEAR(std::remainder(shift.x(), kTwinPitch_m), 0.0, 1e-12);
    ++twins;
  }
  EXPECT_GT(twins, 60);
}

// Seen from a dense set of places on the lap, by rays over and beside everything in between.
TEST(RoomsScene, HidesTheSecondRoomFromTheLap) {
  const Laid laid = lay("rooms", 1);
  ASSERT_EQ(laid.scene.floors.size(), 2U);
  const auto in_second = [&laid](const Object& object) {
    return object.class_id != ClassId::wall && laid.scene.floors[1].contains(object.before.position.head<2>());
  };
  int objects = 0;
  for (const Object& object : laid.scene.objects) objects += in_second(object);
  EXPECT_GT(objects, 100);
  std::vector<ProjectedFace> faces;
  Raster raster;
  for (double t = 0.0; t < laid.motion.lap_end_s(1.0); t += 0.3) {
    const View view(small_options("rooms", 1).camera, laid.motion.T_world_camera(t));
    find_faces(laid.scene, t, view, faces);
    raster.cast(view, faces);
    for (const std::int32_t hit : raster.hit().pixels()) {
      if (hit < Raster::kFirstFace) continue;
      const int object = faces[static_cast<std::size_t>(hit - Raster::kFirstFace)].object;
      ASSERT_FALSE(in_second(laid.scene.objects[static_cast<std::size_t>(object)]))
          << "object " << object << " at " << t;
    }
  }
}

// From any place on one side no place on the other is in sight, at the height of the camera.
TEST(HallScene, IsNeverSeenAcross) {
  const Laid laid = lay("hall", 1);
  const auto from = [&laid](double s_m) {
    const LapPath::Pose2 pose = laid.scene.path.at(s_m);
    return Eigen::Vector3d(pose.x, pose.y, RobotMotion::kCameraHeight_m);
  };
  const double length_m = laid.scene.path.length_m();
  for (double s = 0.0; s < length_m; s += 1.0) {
    const Eigen::Vector3d here = from(s), across = from(s + 0.5 * length_m);
    EXPECT_LT(brute_force_range_m(laid.scene, 0.0, here, across - here), 1.0) << "at " << s;
  }
}

}  // namespace povslam::synthetic
