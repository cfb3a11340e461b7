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
