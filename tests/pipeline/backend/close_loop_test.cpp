#include "pipeline/backend/close_loop.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "tests/support/simulated_ring.hpp"

namespace povslam {

namespace {

using simulated::make_ring;
using simulated::Ring;
using simulated::RingOptions;
using simulated::worst_error_m;

bool same_bits(const Rigid3& a, const Rigid3& b) {
  return std::memcmp(a.rotation.coeffs().data(), b.rotation.coeffs().data(), 4 * sizeof(double)) == 0 &&
         std::memcmp(a.translation.data(), b.translation.data(), 3 * sizeof(double)) == 0;
}

bool same_poses(const LoopProblem& a, const LoopProblem& b) {
  if (a.poses.size() != b.poses.size()) return false;
  for (std::size_t i = 0; i < a.poses.size(); ++i) {
    if (!same_bits(a.poses[i].T_world_camera, b.poses[i].T_world_camera)) return false;
  }
  return true;
}

LoopProblem closed(const LoopProblem& asked, const CloseLoopOptions& options = {}) {
  LoopProblem answer = asked;
  close_loop(answer, options);
  return answer;
}

// Refused, and nothing moved.
void expect_refused(const LoopProblem& asked, const CloseLoopOptions& options = {}) {
  const LoopProblem answer = closed(asked, options);
  EXPECT_FALSE(answer.converged);
  EXPECT_TRUE(same_poses(answer, asked));
}

// A loop edge that says: pose `to` is where pose `place` truly is. Right for place = to.
LoopProblem::Edge recognised(const Ring& ring, std::int32_t from, std::int32_t to, std::size_t place) {
  const RingOptions defaults;
  return {from,
          to,
          ring.truth[static_cast<std::size_t>(from)].inverse() * ring.truth[place],
          defaults.loop_sigma_m,
          defaults.loop_sigma_rad,
          true};
}

}  // namespace

TEST(CloseLoop, BringsADriftedRingHome) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    RingOptions options;
    options.seed = seed;
    const Ring ring = make_ring(options);
    const double drift_m = worst_error_m(ring, ring.problem);
    const LoopProblem answer = closed(ring.problem);
    ASSERT_TRUE(answer.converged) << seed;
    EXPECT_GT(drift_m, 0.1) << seed;  // else there was nothing to close
    EXPECT_LT(worst_error_m(ring, answer), 0.06) << seed;
    EXPECT_LT(worst_error_m(ring, answer), 0.4 * drift_m) << seed;
    EXPECT_LT(answer.loop_error_m, 0.03);
    EXPECT_LT(answer.loop_error_rad, 0.02);
    EXPECT_LT(answer.strain, 6.0);
    EXPECT_LT(answer.cost_after, answer.cost_before);
    EXPECT_GT(answer.iterations, 0);
  }
}

TEST(CloseLoop, ClosesSeveralLoopsAtOnce) {
  RingOptions options;
  options.num_poses = 800;
  options.poses_per_round = 160;  // four rounds over the first
  const Ring ring = make_ring(options);
  const LoopProblem answer = closed(ring.problem);
  ASSERT_TRUE(answer.converged);
  EXPECT_LT(worst_error_m(ring, answer), 0.25 * worst_error_m(ring, ring.problem));
  EXPECT_LT(worst_error_m(ring, answer), 0.08);
}

TEST(CloseLoop, ClosesADriftManyTimesTheNoiseOfTheLoop) {
  RingOptions options;
  options.num_poses = 1000;
  options.poses_per_round = 990;
  options.num_predecessors = 1;
  const Ring ring = make_ring(options);
  const LoopProblem answer = closed(ring.problem);
  EXPECT_GT(worst_error_m(ring, ring.problem), 100.0 * options.loop_sigma_m);
  ASSERT_TRUE(answer.converged);
  EXPECT_LT(answer.loop_error_m, 0.03);
}

TEST(CloseLoop, LeavesExactPosesWhereTheyAre) {
  RingOptions options;
  options.sigma_m = options.sigma_rad = options.loop_sigma_m = options.loop_sigma_rad = 1e-9;
  Ring ring = make_ring(options);
  for (auto& edge : ring.problem.edges) edge.sigma_m = edge.sigma_rad = 0.01;
  const LoopProblem answer = closed(ring.problem);
  ASSERT_TRUE(answer.converged);
  EXPECT_LT(worst_error_m(ring, answer), 1e-5);
}

TEST(CloseLoop, KeepsFixedPosesToTheBit) {
  Ring ring = make_ring(RingOptions{});
  for (const std::size_t i : {std::size_t{0}, std::size_t{50}}) {
    ring.problem.poses[i].fixed = true;
    ring.problem.poses[i].T_world_camera = ring.truth[i];
  }
  const LoopProblem answer = closed(ring.problem);
  ASSERT_TRUE(answer.converged);
  for (const std::size_t i : {std::size_t{0}, std::size_t{50}}) {
    EXPECT_TRUE(same_bits(answer.poses[i].T_world_camera, ring.problem.poses[i].T_world_camera));
  }
  EXPECT_FALSE(same_poses(answer, ring.problem));
}

TEST(CloseLoop, FollowsTheWorldItIsGiven) {
  const Ring ring = make_ring(RingOptions{});
  const Rigid3 T_other_world{so3_exp({0.3, -1.2, 2.0}), {40.0, -7.0, 3.0}};
  LoopProblem elsewhere = ring.problem;
  for (auto& pose : elsewhere.poses) pose.T_world_camera = T_other_world * pose.T_world_camera;
  const LoopProblem here = closed(ring.problem), there = closed(elsewhere);
  ASSERT_TRUE(here.converged && there.converged);
  for (std::size_t i = 0; i < here.poses.size(); ++i) {
    EXPECT_LT(local(T_other_world * here.poses[i].T_world_camera, there.poses[i].T_world_camera).norm(), 1e-4);
  }
}

TEST(CloseLoop, GivesTheSameBitsEachTime) {
  const Ring ring = make_ring(RingOptions{});
  const LoopProblem once = closed(ring.problem), again = closed(ring.problem);
  EXPECT_TRUE(same_poses(once, again));
  EXPECT_EQ(once.cost_after, again.cost_after);
  EXPECT_EQ(once.iterations, again.iterations);
}

TEST(CloseLoop, RefusesAWrongLoop) {
  RingOptions options;
  options.num_poses = 150;  // no second round: nothing to contradict but the neighbours
  Ring ring = make_ring(options);
  ring.problem.edges.push_back(recognised(ring, 10, 140, 60));
  expect_refused(ring.problem);
}

TEST(CloseLoop, RefusesAWrongLoopAmongRightOnes) {
  for (const std::size_t place : {std::size_t{20}, std::size_t{100}, std::size_t{196}}) {
    Ring ring = make_ring(RingOptions{});
    ring.problem.edges.push_back(recognised(ring, 15, 190, place));
    expect_refused(ring.problem);
  }
}

TEST(CloseLoop, RefusesALoopThatWouldBendItsNeighboursTooMuch) {
  RingOptions options;
  options.num_poses = 12;
  Ring ring = make_ring(options);
  ring.problem.edges.push_back(recognised(ring, 0, 11, 10));  // one step too short
  ring.problem.edges.back().sigma_m = ring.problem.edges.back().sigma_rad = 1e-5;
  CloseLoopOptions anything_fits;
  anything_fits.loop_scale = 1e5;
  expect_refused(ring.problem, anything_fits);
  EXPECT_GT(closed(ring.problem, anything_fits).strain, anything_fits.max_strain);
  anything_fits.max_strain = 1e6;
  EXPECT_TRUE(closed(ring.problem, anything_fits).converged);
}

TEST(CloseLoop, RefusesWhatIsNotSolvedInTime) {
  CloseLoopOptions hurried;
  hurried.max_solve_s = 1e-9;
  expect_refused(make_ring(RingOptions{}).problem, hurried);
}

TEST(CloseLoop, RefusesWhatCannotBeSolved) {
  using Change = std::function<void(LoopProblem&)>;
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  const std::vector<std::pair<const char*, Change>> changes = {
      {"no poses", [](LoopProblem& p) { p.poses.clear(); }},
      {"nothing at all", [](LoopProblem& p) { p.clear(); }},
      {"no edges", [](LoopProblem& p) { p.edges.clear(); }},
      {"nothing fixed", [](LoopProblem& p) { p.poses[0].fixed = false; }},
      {"all fixed",
       [](LoopProblem& p) {
         for (auto& pose : p.poses) pose.fixed = true;
       }},
      {"a position that is none", [](LoopProblem& p) { p.poses[3].T_world_camera.translation.y() = kNan; }},
      {"a fixed position that is none", [](LoopProblem& p) { p.poses[0].T_world_camera.translation.y() = kInfinity; }},
      {"a rotation that is none", [](LoopProblem& p) { p.poses[3].T_world_camera.rotation.w() = kNan; }},
      {"a quaternion of no length", [](LoopProblem& p) { p.poses[3].T_world_camera.rotation.coeffs().setZero(); }},
      {"a measurement that is none", [](LoopProblem& p) { p.edges[3].T_from_to.translation.x() = kNan; }},
      {"a measured quaternion too long", [](LoopProblem& p) { p.edges[3].T_from_to.rotation.coeffs() *= 2.0; }},
      {"sigma zero", [](LoopProblem& p) { p.edges[3].sigma_m = 0.0; }},
      {"sigma negative", [](LoopProblem& p) { p.edges[3].sigma_rad = -1.0; }},
      {"sigma no number", [](LoopProblem& p) { p.edges[3].sigma_rad = kNan; }},
      {"sigma infinite", [](LoopProblem& p) { p.edges[3].sigma_m = kInfinity; }},
      {"an edge to itself", [](LoopProblem& p) { p.edges[3].to = p.edges[3].from; }},
      {"an edge from before the first", [](LoopProblem& p) { p.edges[3].from = -1; }},
      {"an edge to after the last", [](LoopProblem& p) { p.edges[3].to = static_cast<int>(p.poses.size()); }},
      {"a pose alone", [](LoopProblem& p) { p.poses.push_back({}); }},
      {"two poses apart from the others",
       [](LoopProblem& p) {
         const auto n = static_cast<std::int32_t>(p.poses.size());
         p.poses.resize(p.poses.size() + 2);
         p.edges.push_back({n, n + 1, {}, 0.01, 0.01, false});
       }},
      {"numbers too great to be squared", [](LoopProblem& p) { p.poses[3].T_world_camera.translation.x() = 1e200; }},
  };
  for (const auto& [name, change] : changes) {
    SCOPED_TRACE(name);
    LoopProblem problem = make_ring(RingOptions{}).problem;
    change(problem);
    expect_refused(problem);
  }
}

TEST(CloseLoop, CountsAnEdgeSaidTwiceTwice) {
  Ring ring = make_ring(RingOptions{});
  const LoopProblem once = closed(ring.problem);
  const auto edges = ring.problem.edges;
  ring.problem.edges.insert(ring.problem.edges.end(), edges.begin(), edges.end());
  const LoopProblem twice = closed(ring.problem);
  ASSERT_TRUE(once.converged && twice.converged);
  EXPECT_NEAR(twice.cost_after, 2.0 * once.cost_after, 1e-3 * once.cost_after);
  EXPECT_LT(worst_error_m(ring, twice), 0.06);
}

// Whatever is asked: no crash, an answer to believe or poses untouched.
TEST(CloseLoop, SurvivesAnyProblem) {
  std::mt19937 random(7);
  const auto below = [&random](int n) { return std::uniform_int_distribution<int>(0, n - 1)(random); };
  const auto odd_number = [&] {
    constexpr double kOdd[] = {0.0, -1.0, 1e-300, 1e-160, 1e-9, 1.0, 1e9, 1e160, 1e300, HUGE_VAL, -HUGE_VAL, NAN};
    return kOdd[below(std::size(kOdd))];
  };
  int num_converged = 0;
  for (int round = 0; round < 600; ++round) {
    RingOptions options;
    options.num_poses = below(30);
    options.poses_per_round = 3 + below(20);
    options.num_predecessors = below(4);
    options.loop_every = below(4);
    options.seed = static_cast<unsigned>(round);
    LoopProblem problem = make_ring(options).problem;
    for (int harm = below(4); harm > 0 && !problem.poses.empty() && !problem.edges.empty(); --harm) {
      auto& edge = problem.edges[static_cast<std::size_t>(below(static_cast<int>(problem.edges.size())))];
      auto& pose = problem.poses[static_cast<std::size_t>(below(static_cast<int>(problem.poses.size())))];
      switch (below(9)) {
        case 0:
          pose.T_world_camera.translation[below(3)] = odd_number();
          break;
        case 1:
          pose.T_world_camera.rotation.coeffs()[below(4)] = odd_number();
          break;
        case 2:
          edge.T_from_to.translation[below(3)] = odd_number();
          break;
        case 3:
          (below(2) == 0 ? edge.sigma_m : edge.sigma_rad) = odd_number();
          break;
        case 4:
          (below(2) == 0 ? edge.from : edge.to) = below(options.num_poses + 4) - 2;
          break;
        case 5:
          pose.fixed = !pose.fixed;
          break;
        case 6:
          edge.loop = !edge.loop;
          break;
        case 7:
          problem.edges.push_back(LoopProblem::Edge(edge));
          break;
        default:
          edge.T_from_to = retract(edge.T_from_to, Vector6d::Constant(3.0 - below(7)));
          break;
      }
    }
    const LoopProblem answer = closed(problem);
    num_converged += answer.converged ? 1 : 0;
    if (!answer.converged) {
      EXPECT_TRUE(same_poses(answer, problem)) << round;
      continue;
    }
    EXPECT_LE(answer.cost_after, answer.cost_before);
    for (std::size_t i = 0; i < answer.poses.size(); ++i) {
      const Rigid3& T = answer.poses[i].T_world_camera;
      EXPECT_TRUE(T.translation.allFinite() && std::abs(T.rotation.norm() - 1.0) < 1e-3) << round;
      EXPECT_TRUE(!problem.poses[i].fixed || same_bits(T, problem.poses[i].T_world_camera)) << round;
    }
  }
  EXPECT_GT(num_converged, 50);
  EXPECT_LT(num_converged, 550);
}

}  // namespace povslam
