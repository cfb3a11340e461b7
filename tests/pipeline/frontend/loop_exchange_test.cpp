#include "pipeline/frontend/loop_exchange.hpp"

#include <gtest/gtest.h>

#include "pipeline/backend/close_loop.hpp"
#include "tests/pipeline/frontend/drifted_ring.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"

namespace povslam {
namespace {

using made::DriftedRing;

struct Loop {
  Loop() : exchange(DriftedRing::options().map) {
    found.now = static_cast<std::int64_t>(ring.truth.size()) - 1;
    found.then = found.now - DriftedRing::kRound;
    found.T_then_now = ring.truth[static_cast<std::size_t>(found.then)].inverse() * ring.truth.back();
    found.num_inliers = 100;
  }
  DriftedRing ring{made::some_drift()};
  LoopExchange exchange;
  LoopFound found;
  LoopProblem problem;
};

// Once round a hall of 24 m by 8 m, a keyframe each quarter of a metre or tenth of a corner; each shares landmarks with
// the one before. A focal length that is off bends the turns.
struct Hall {
  static constexpr int kFeatures = 60, kShared = 20;
  static constexpr double kTooFar = 0.02;  // share of each turn

  Hall() : map(kFeatures, options().map, made::level_scales()) {
    for (const int side : {0, 1, 2, 3}) {
      for (int step = 0; step < (side % 2 == 0 ? 96 : 32); ++step) keep({0.25, 0.0, 0.0}, 0.0);
      for (int step = 0; step < 10; ++step) keep({0.0, 0.0, 0.0}, 0.05 * M_PI);
    }
  }
  static FrontendOptions options() {
    FrontendOptions options;
    options.orb.num_features = kFeatures;
    options.map.max_keyframes = 400;
    options.map.max_landmarks = 20000;
    return options;
  }
  void keep(const Eigen::Vector3d& step, double turn_rad) {
    const Rigid3 ahead = made::looking_along_y(Eigen::Vector3d::Zero());
    const std::int64_t id = map.next_keyframe_id();
    T_world_body_ = T_world_body_ * Rigid3{so3_exp({0.0, 0.0, turn_rad}), step};
    truth.push_back(T_world_body_ * ahead);
    const Rigid3 too_far{so3_exp({0.0, -kTooFar * turn_rad, 0.0}), Eigen::Vector3d::Zero()};
    const Rigid3 moved = id == 0 ? truth.back() : truth[truth.size() - 2].inverse() * truth.back();
    believed_ = believed_ * moved * too_far;
    const std::int32_t slot = map.insert_keyframe(frame, believed_, Matrix6d::Zero(), id - 1);
    for (int f = 0; f < kFeatures; ++f) {
      const auto before = static_cast<std::size_t>(kFeatures - 1 - f);
      if (id > 0 && f < kShared && map.add_sighting(map.keyframe(slot - 1).landmark[before], slot, f)) continue;
      map.create_landmark(slot, f, believed_.translation);
    }
    map.update_covisibility(slot);
  }
  double worst_m() const {
    double worst = 0.0;
    for (std::size_t k = 0; k < truth.size(); ++k) {
      const auto T_world_camera = map.keyframe_pose(static_cast<std::int64_t>(k));
      worst = std::max(worst, (T_world_camera->translation - truth[k].translation).norm());
    }
    return worst;
  }
  Frame frame = made::random_frame(made::half_camera(), options(), kFeatures, 1);
  Map map;
  std::vector<Rigid3> truth;  // T_world_camera by keyframe id

 private:
  Rigid3 T_world_body_, believed_;
};

}  // namespace

TEST(LoopExchange, AsksForAllKeyframesHungOnTheFirst) {
  Loop loop;
  ASSERT_TRUE(loop.exchange.cut(loop.ring.map, loop.found, 7, loop.problem));
  EXPECT_EQ(loop.problem.poses.size(), loop.ring.truth.size());
  EXPECT_EQ(std::ranges::count_if(loop.problem.poses, &LoopProblem::Pose::fixed), 1);
  EXPECT_TRUE(loop.problem.poses.front().fixed);
  EXPECT_EQ(std::ranges::count_if(loop.problem.edges, &LoopProblem::Edge::loop), 1);
  EXPECT_GE(loop.problem.edges.size(), loop.problem.poses.size());
}

TEST(LoopExchange, StraightensTheMapAndWhatWasMadeMeanwhile) {
  Loop loop;
  ASSERT_TRUE(loop.exchange.cut(loop.ring.map, loop.found, 7, loop.problem));
  close_loop(loop.problem, {});
  ASSERT_TRUE(loop.problem.converged);
  loop.ring.keep();  // while the backend was busy
  const double before_m = loop.ring.worst_position_error_m(), points_before_m = loop.ring.median_landmark_error_m();
  const Rigid3 newest_before = *loop.ring.map.keyframe_pose(loop.found.now + 1);
  const auto T_new_old = loop.exchange.apply(loop.ring.map, loop.problem, loop.found.now + 1);
  ASSERT_TRUE(T_new_old);
  EXPECT_EQ(broken_sightings(loop.ring.map), "");
  EXPECT_GT(before_m, 0.15);
  EXPECT_LT(loop.ring.worst_position_error_m(), 0.35 * before_m);
  EXPECT_LT(loop.ring.median_landmark_error_m(), 0.65 * points_before_m);
  const Rigid3 newest_after = *loop.ring.map.keyframe_pose(loop.found.now + 1);
  EXPECT_LT(local(*T_new_old * newest_before, newest_after).norm(), 1e-9);
}

TEST(LoopExchange, LooksForTheErrorWhereTheCameraTurned) {
  Hall hall;
  const double gap_m = hall.worst_m();
  LoopExchange exchange(Hall::options().map);
  LoopProblem problem;
  const auto last = static_cast<std::int64_t>(hall.truth.size()) - 1;
  ASSERT_TRUE(exchange.cut(hall.map, {last, 0, hall.truth.front().inverse() * hall.truth.back(), 100}, 7, problem));
  close_loop(problem, {});
  ASSERT_TRUE(problem.converged);
  exchange.apply(hall.map, problem, last);
  EXPECT_GT(gap_m, 0.5);
  EXPECT_LT(hall.worst_m(), 0.1 * gap_m);
}

TEST(LoopExchange, LeavesTheMapAloneWithoutAnAnswer) {
  Loop loop;
  ASSERT_TRUE(loop.exchange.cut(loop.ring.map, loop.found, 7, loop.problem));
  const Rigid3 before = *loop.ring.map.keyframe_pose(loop.found.now);
  EXPECT_FALSE(loop.exchange.apply(loop.ring.map, loop.problem, loop.found.now));
  EXPECT_EQ(local(before, *loop.ring.map.keyframe_pose(loop.found.now)).norm(), 0.0);
}

TEST(LoopExchange, JoinsPartsThatShareNothing) {
  Loop loop;
  Map& map = loop.ring.map;
  for (int k = 0; k < 10; ++k) map.remove_keyframe(map.find_keyframe(20 + k));  // a hole in the way
  ASSERT_TRUE(loop.exchange.cut(map, loop.found, 7, loop.problem));
  close_loop(loop.problem, {});
  EXPECT_TRUE(loop.problem.converged);
}

TEST(LoopExchange, AsksNothingWhenAKeyframeIsGone) {
  Loop loop;
  loop.ring.map.remove_keyframe(loop.ring.map.find_keyframe(loop.found.then));
  EXPECT_FALSE(loop.exchange.cut(loop.ring.map, loop.found, 7, loop.problem));
}

}  // namespace povslam
