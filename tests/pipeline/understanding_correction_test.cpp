// A robot drifts, closes the loop, and its map is corrected: what stands there follows, and nothing is told of it.
#include <gtest/gtest.h>

#include "pipeline/objects/box_fit.hpp"
#include "pipeline/understanding.hpp"
#include "tests/support/small_world.hpp"

namespace povslam {
namespace {

constexpr std::int64_t kFirst = 3, kDrifted = 8;  // keyframes

SensorCalibration calibration() {
  SensorCalibration calibration;
  calibration.camera = SmallWorld::camera();
  calibration.fps = 5.0;
  return calibration;
}
UnderstandingOptions by_labels() {
  UnderstandingOptions options;
  options.labels = "replay";
  return options;
}

class DriftAndLoop : public testing::Test {
 protected:
  // Looks at `target` from an arc; the tracker believes it to be elsewhere.
  void look(const Eigen::Vector2d& target, int count, std::int64_t keyframe, const Rigid3& T_believed_true = {},
            const std::vector<KeyframeMotion>& corrections = {}) {
    for (int i = 0; i < count; ++i) {
      const double angle = -0.4 + 0.8 * (i + 0.5) / count;
      const Eigen::Vector2d eye = target - 2.5 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      const Rigid3 T_world_camera = SmallWorld::looking(eye, target);
      now += kNsPerSecond / 5;
      LabelFrame labelled;
      world.look(T_world_camera, now, seen, labelled.classes);
      labelled.stamp = now;
      View view;
      view.frame = frame_of(seen);
      view.T_world_camera = T_believed_true * T_world_camera;
      view.trusted = true;
      view.reference_keyframe = keyframe;
      if (i == 0) view.corrections = corrections;
      understanding->add(std::move(view));
      understanding->add(labelled);
      while (const Understood* done = understanding->step()) take(done->events);
    }
  }
  void finish() {
    understanding->stop_waiting();
    while (const Understood* done = understanding->step()) take(done->events);
    take(understanding->finish().events);
  }
  void take(const std::vector<ObjectEvent>& more) { events.insert(events.end(), more.begin(), more.end()); }

  static RgbdFrame frame_of(const DepthView& seen) {
    RgbdFrame frame;
    frame.stamp = frame.depth_stamp = seen.stamp;
    frame.color = seen.color;
    frame.depth.resize(seen.camera.width, seen.camera.height);
    for (std::size_t i = 0; i < frame.depth.size(); ++i) {
      frame.depth.data()[i] = static_cast<std::uint16_t>(seen.depth_m.data()[i] * 1000.0F + 0.5F);
    }
    return frame;
  }
  static Box box_of(const ObjectRecord& object) { return {object.place.position, object.size_m, object.place.yaw}; }
  const ObjectRecord* object_at(const Box& box) const {
    for (const ObjectRecord& object : understanding->objects()) {
      if (overlap(box_of(object), box).iou > 0.5) return &object;
    }
    return nullptr;
  }
  // Centres of triangles of the mesh that lie near the true wall, and those clearly off all true surfaces.
  std::pair<int, int> wall_triangles() {
    Mesh mesh;
    understanding->mesh(mesh);
    int on_wall = 0, off = 0;
    for (const Eigen::Vector3f& p : mesh.vertices) {
      if (p.x() > 6.9F && p.x() < 7.1F) ++on_wall;
      if (p.z() > 0.5F && p.x() > 6.15F && (p.x() < 6.85F || p.x() > 7.15F)) ++off;
    }
    return {on_wall, off};
  }

  const Box first{{4.0, 2.0, 0.35}, {0.8, 0.6, 0.7}, 0.3}, second{{5.0, -2.0, 0.35}, {0.6, 0.9, 0.7}, 0.2};
  const Rigid3 T_drift{Eigen::Quaterniond(Eigen::AngleAxisd(0.06, Eigen::Vector3d::UnitZ())), {0.15, 0.5, 0.0}};
  const std::vector<KeyframeMotion> loop_closed{{kDrifted, T_drift.inverse()}};
  SmallWorld world;
  TimeNs now = 0;
  DepthView seen;
  std::optional<Understanding> understanding{std::in_place, by_labels(), calibration(), SmallWorld::classes()};
  std::vector<ObjectEvent> events;
};

TEST_F(DriftAndLoop, ObjectsFollowTheCorrectionAndNothingIsTold) {
  world.things = {{first}, {second, SmallWorld::kPallet}};
  look({4.0, 2.0}, 12, kFirst);
  look({5.0, -2.0}, 12, kDrifted, T_drift);
  ASSERT_EQ(understanding->objects().size(), 2U);
  ASSERT_NE(object_at(first), nullptr);
  EXPECT_EQ(object_at(second), nullptr) << "the story needs a drift that shows";
  const std::int64_t first_id = object_at(first)->id;
  const std::int64_t id = understanding->objects()[understanding->objects()[0].id == first_id ? 1 : 0].id;
  look({5.0, -2.0}, 12, kDrifted, {}, loop_closed);
  look({4.0, 2.0}, 12, kFirst);
  finish();
  EXPECT_TRUE(events.empty());
  EXPECT_EQ(understanding->objects().size(), 2U);
  ASSERT_NE(object_at(second), nullptr);
  EXPECT_EQ(object_at(second)->id, id);
  EXPECT_NE(object_at(first), nullptr);
}

TEST_F(DriftAndLoop, TheWallFollowsToo) {
  look({5.0, -2.0}, 12, kDrifted, T_drift);
  const auto [before, off_before] = wall_triangles();
  look({4.0, 4.0}, 1, kFirst, {}, loop_closed);  // looks elsewhere
  const auto [after, off_after] = wall_triangles();
  EXPECT_GT(after, 3 * before);
  EXPECT_LT(4 * off_after, off_before);
}

TEST_F(DriftAndLoop, TheMeshHasWhatIsNobodysOnlyWhereThatIsKept) {
  const auto triangles_of_an_unknown_thing = [&](bool keep) {
    understanding.emplace(by_labels(), calibration(), SmallWorld::classes());
    if (keep) understanding->keep_loose_surface();
    world.things = {{first}};
    look({4.0, 2.0}, 1, kFirst);
    Mesh mesh;
    understanding->mesh(mesh);
    return std::ranges::count_if(mesh.vertices, [&](const Eigen::Vector3f& p) {
      return p.z() > 0.15F && first.contains(p.cast<double>(), 0.1);
    });
  };
  EXPECT_EQ(triangles_of_an_unknown_thing(false), 0);
  EXPECT_GT(triangles_of_an_unknown_thing(true), 50);
}

// What the drifted robot saw empty is not where it said: else what is found there would seem to have come.
TEST_F(DriftAndLoop, EmptySpaceSeenInDriftDoesNotMakeThingsAppear) {
  world.things = {{second}};
  const Rigid3 T_aside{Eigen::Quaterniond::Identity(), {0.0, 3.0, 0.0}};
  look({5.0, -5.0}, 12, kDrifted, T_aside);  // it believes to see an empty place at (5, -2), and does not see the thing
  ASSERT_TRUE(understanding->objects().empty());
  look({5.0, -2.0}, 12, kFirst, {}, {{kDrifted, T_aside.inverse()}});
  finish();
  EXPECT_TRUE(events.empty());
  EXPECT_NE(object_at(second), nullptr);
}

// Held back at the desk while the map is corrected: the event tells the corrected place.
TEST_F(DriftAndLoop, AnEventNotYetToldTellsTheCorrectedPlace) {
  world.things = {{second}};
  look({5.0, -2.0}, 20, kDrifted, T_drift);  // longer than what passes by
  world.things.clear();
  look({5.0, -2.0}, 6, kDrifted, T_drift);
  ASSERT_TRUE(understanding->objects().empty());
  ASSERT_TRUE(events.empty());
  look({4.0, 4.0}, 1, kFirst, {}, loop_closed);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::removed);
  EXPECT_LT((events[0].place.position - second.center).norm(), 0.15);
}

TEST_F(DriftAndLoop, TheStoreHearsOfObjectsThatWereMoved) {
  world.things = {{second}};
  look({5.0, -2.0}, 12, kDrifted, T_drift);
  WorldChange* told = understanding->collect_change();
  ASSERT_TRUE(told != nullptr && told->objects.size() == 1U);
  understanding->give_back(told);
  look({4.0, 4.0}, 1, kFirst, {}, loop_closed);
  told = understanding->collect_change();
  ASSERT_TRUE(told != nullptr && told->objects.size() == 1U);
  EXPECT_GT(overlap(box_of(told->objects[0].object), second).iou, 0.5);
}

// A correction that came with a view which nobody understood is not lost.
TEST_F(DriftAndLoop, ACorrectionOutlivesItsView) {
  world.things = {{second}};
  look({5.0, -2.0}, 12, kDrifted, T_drift);
  View late;
  late.frame = frame_of(seen);  // the stamp of a view that was there before: it is dropped
  late.corrections = loop_closed;
  understanding->add(std::move(late));
  look({5.0, -2.0}, 3, kDrifted);
  finish();
  EXPECT_NE(object_at(second), nullptr);
  EXPECT_TRUE(events.empty());
}

}  // namespace
}  // namespace povslam
