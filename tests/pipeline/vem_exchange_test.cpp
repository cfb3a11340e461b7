#include "pipeline/vem_exchange.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "pipeline/backend_job.hpp"
#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

constexpr int kOfObject = 30, kOfStructure = 40, kObjects = 3;

FrontendOptions frontend() {
  FrontendOptions options;
  options.orb.num_features = 300;
  options.map.max_keyframes = 10;
  options.map.max_landmarks = 1000;
  return options;
}

// Three things and a wall before a camera; all are in the map, and the things are known.
struct Room {
  explicit Room(const WindowOptions& options = {})
      : camera(made::half_camera()),
        map(frontend().orb.num_features, frontend().map, made::level_scales()),
        around(frontend().map),
        exchange(camera, frontend(), options, {}) {
    std::mt19937_64 random(7);
    std::uniform_real_distribution<double> side(-0.25, 0.25);
    for (int i = 0; i < kObjects * kOfObject; ++i) {
      const Eigen::Vector3d center(i / kOfObject - 1.0, 3.0, 0.0);
      points.emplace_back(center + Eigen::Vector3d(side(random), side(random), side(random)));
    }
    for (int i = 0; i < kOfStructure; ++i) points.emplace_back(6.0 * side(random), 5.0, 4.0 * side(random));
    looks = made::looks(points.size(), 3);
    made::View first = made::view_of(camera, frontend(), pose, points, looks);
    map.insert_keyframe(first.frame, pose, Matrix6d::Zero(), -1);
    slot.assign(points.size(), kNone);
    for (int f = 0; f < first.frame.size(); ++f) {
      const auto point = static_cast<std::size_t>(first.shown[static_cast<std::size_t>(f)]);
      slot[point] = map.create_landmark(0, f, points[point]);
      if (object_of(point) > 0) map.landmark(slot[point]).owner = object_of(point);
    }
    for (int id = 1; id <= kObjects; ++id) {
      ObjectBelief belief;
      belief.object = id;
      belief.place.position = {id - 2.0, 3.0, 0.0};
      belief.belief = {0.0, 0.01, 5.0, 1.0};
      exchange.know(belief, map.object_trust());
    }
    input.depth.resize(camera.width, camera.height);
    input.depth.fill(8000);  // where a thing was and is not, the camera sees through
  }
  static std::int64_t object_of(std::size_t point) {
    return point < kObjects * kOfObject ? 1 + static_cast<std::int64_t>(point) / kOfObject : -1;
  }

  // A frame taken at `truly` and tracked at `tracked`: tracking found what shows where it should.
  Frame frame(const Rigid3& truly, const Rigid3& tracked, const std::vector<Eigen::Vector3d>& now) {
    made::View view = made::view_of(camera, frontend(), truly, now, looks);
    view.frame.T_camera_world = tracked.inverse();
    view.frame.index = index++;
    for (std::size_t f = 0; f < view.shown.size(); ++f) {
      const auto point = static_cast<std::size_t>(view.shown[f]);
      const Eigen::Vector3d seen = tracked * view.frame.point_camera(static_cast<int>(f), camera);
      const bool found = slot[point] != kNone && map.believed(slot[point]) && (seen - points[point]).norm() < 0.05;
      view.frame.landmark[f] = found ? slot[point] : kNone;
    }
    return std::move(view.frame);
  }
  // Through all of it; what the answer wants corrected.
  std::optional<Rigid3> step(const Rigid3& truly, const Rigid3& tracked, const std::vector<Eigen::Vector3d>& now) {
    const Frame seen = frame(truly, tracked, now);
    around.collect(map, seen, tracked);
    exchange.look(map, around, input, seen, tracked);
    if (VemProblem* problem = exchange.take(map)) {
      solve(BackendJob{problem}, {});
      exchange.give_back(problem);
    }
    return exchange.apply(map.object_trust());
  }
  std::vector<Eigen::Vector3d> with_third_moved(const Eigen::Vector3d& by) const {
    std::vector<Eigen::Vector3d> now = points;
    for (std::size_t i = 0; i < now.size(); ++i) now[i] += object_of(i) == 3 ? by : Eigen::Vector3d::Zero();
    return now;
  }

  PinholeCamera camera;
  Map map;
  LocalMap around;
  VemExchange exchange;
  Rigid3 pose = made::looking_along_y({0, 0, 0});
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> looks;
  std::vector<std::int32_t> slot;  // of each point
  RgbdFrame input;
  std::int64_t index = 0;
};

}  // namespace

TEST(VemExchange, DoubtsWhatMovedAndNothingElse) {
  Room room;
  const auto now = room.with_third_moved({0.3, 0.0, 0.0});
  for (int i = 0; i < 4; ++i) EXPECT_FALSE(room.step(room.pose, room.pose, now)) << i;
  EXPECT_EQ(room.map.object_trust().of(3), 0.0F);
  EXPECT_GT(room.map.object_trust().of(1), 0.7F);
  EXPECT_GT(room.map.object_trust().of(2), 0.7F);
  EXPECT_EQ(room.exchange.counts().doubted, 1);
  EXPECT_EQ(room.exchange.counts().faults, 0);
  std::vector<std::int64_t> doubted;
  room.exchange.doubted(doubted);
  EXPECT_THAT(doubted, testing::ElementsAre(3));
}

TEST(VemExchange, BelievesAgainWhatIsBack) {
  Room room;
  for (int i = 0; i < 4; ++i) room.step(room.pose, room.pose, room.with_third_moved({0.3, 0.0, 0.0}));
  ASSERT_EQ(room.map.object_trust().of(3), 0.0F);
  for (int i = 0; i < 14; ++i) room.step(room.pose, room.pose, room.points);
  EXPECT_GT(room.map.object_trust().of(3), 0.5F);
  EXPECT_EQ(room.exchange.counts().believed_again, 1);
}

TEST(VemExchange, DoesNotDoubtOnASingleWindow) {
  Room room;
  for (int i = 0; i < 2; ++i) room.step(room.pose, room.pose, room.with_third_moved({0.3, 0.0, 0.0}));
  EXPECT_GT(room.map.object_trust().of(3), 0.0F);
  EXPECT_EQ(room.exchange.counts().doubted, 0);
}

TEST(VemExchange, DoesNotDoubtWhatIsHidden) {
  Room room;
  room.input.depth.fill(1000);  // something stands before all of it
  for (int i = 0; i < 5; ++i) room.step(room.pose, room.pose, room.with_third_moved({0.3, 0.0, 0.0}));
  EXPECT_EQ(room.exchange.counts().doubted, 0);
}

TEST(VemExchange, LeavesAnUnchangedRoomAlone) {
  Room room;
  for (int i = 0; i < 10; ++i) EXPECT_FALSE(room.step(room.pose, room.pose, room.points));
  EXPECT_EQ(room.exchange.counts().runs, 10);
  EXPECT_EQ(room.exchange.counts().doubted, 0);
  for (int id = 1; id <= kObjects; ++id) EXPECT_GT(room.map.object_trust().of(id), 0.8F) << id;
}

TEST(VemExchange, SaysWhereTheCameraIsWhenTrackingIsElsewhere) {
  Room room;
  const Rigid3 wrong{room.pose.rotation, room.pose.translation + Eigen::Vector3d(0.25, 0.1, 0.0)};
  std::optional<Rigid3> T_new_old;
  int steps = 0;
  for (; steps < 6 && !T_new_old; ++steps) T_new_old = room.step(room.pose, wrong, room.points);
  ASSERT_TRUE(T_new_old);
  EXPECT_EQ(steps, WindowOptions{}.verdicts);
  const Rigid3 corrected = *T_new_old * wrong;
  EXPECT_LT((corrected.translation - room.pose.translation).norm(), 0.01);
  EXPECT_LT(rotation_angle_rad(room.pose.inverse() * corrected), 0.005);
  EXPECT_EQ(room.exchange.counts().corrections, 1);
}

TEST(VemExchange, CorrectsNothingOnceTheMapWasMoved) {
  Room room;
  const Rigid3 wrong{room.pose.rotation, room.pose.translation + Eigen::Vector3d(0.25, 0.1, 0.0)};
  for (int i = 0; i < 6; ++i) {
    const Frame seen = room.frame(room.pose, wrong, room.points);
    room.around.collect(room.map, seen, wrong);
    room.exchange.look(room.map, room.around, room.input, seen, wrong);
    VemProblem* problem = room.exchange.take(room.map);
    ASSERT_NE(problem, nullptr);
    solve(BackendJob{problem}, {});
    room.exchange.map_moved();
    room.exchange.give_back(problem);
    EXPECT_FALSE(room.exchange.apply(room.map.object_trust())) << i;
  }
}

TEST(VemExchange, AsksNothingWhereNoObjectIsSeen) {
  Room room;
  for (int id = 1; id <= kObjects; ++id) {
    ObjectBelief gone;
    gone.object = id;
    gone.gone = true;
    room.exchange.know(gone, room.map.object_trust());
  }
  const Frame seen = room.frame(room.pose, room.pose, room.points);
  room.around.collect(room.map, seen, room.pose);
  room.exchange.look(room.map, room.around, room.input, seen, room.pose);
  EXPECT_EQ(room.exchange.take(room.map), nullptr);
}

TEST(VemExchange, GivesSmallThingsTheirShare) {
  WindowOptions options;
  options.max_matches = 50;
  Room room(options);
  for (std::size_t i = 10; i < kOfObject; ++i) {  // the first thing keeps ten points, the rest are the second's
    if (room.slot[i] != kNone) room.map.landmark(room.slot[i]).owner = 2;
  }
  const Frame seen = room.frame(room.pose, room.pose, room.points);
  room.around.collect(room.map, seen, room.pose);
  room.exchange.look(room.map, room.around, room.input, seen, room.pose);
  VemProblem* problem = room.exchange.take(room.map);
  ASSERT_NE(problem, nullptr);
  EXPECT_LE(problem->window.matches.size(), 50u);
  EXPECT_GE(problem->window.matches.size(), 45u);
  ASSERT_THAT(problem->object, testing::ElementsAre(-1, 1, 2, 3));
  EXPECT_EQ(problem->window.objects[1].num_landmarks, 10);
  EXPECT_NEAR(problem->window.objects[2].num_landmarks, problem->window.objects[3].num_landmarks, 1);
}

TEST(VemExchange, KeepsSoManyFramesAndForgetsThemWhenLost) {
  WindowOptions options;
  options.frames = 3;
  Room room(options);
  for (int i = 0; i < 5; ++i) room.step(room.pose, room.pose, room.points);
  const Frame seen = room.frame(room.pose, room.pose, room.points);
  room.around.collect(room.map, seen, room.pose);
  room.exchange.look(room.map, room.around, room.input, seen, room.pose);
  VemProblem* problem = room.exchange.take(room.map);
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->window.poses.size(), 3u);
  room.exchange.give_back(problem);  // unsolved: nothing comes of it
  EXPECT_FALSE(room.exchange.apply(room.map.object_trust()));
  room.exchange.forget();
  room.exchange.look(room.map, room.around, room.input, room.frame(room.pose, room.pose, room.points), room.pose);
  problem = room.exchange.take(room.map);
  ASSERT_NE(problem, nullptr);
  EXPECT_EQ(problem->window.poses.size(), 1u);
}

}  // namespace povslam
