#include "pipeline/backend/vem.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <functional>
#include <limits>

#include "tests/support/simulated_objects.hpp"
#include "tests/support/simulated_rectangles.hpp"

namespace povslam {

namespace {

using simulated::make_objects;
using simulated::ObjectsOptions;
using simulated::ObjectsWindow;

ObjectsOptions far_shifts(unsigned seed) {
  ObjectsOptions options;
  options.shift_min_m = 0.8;
  options.shift_max_m = 2.0;
  options.start_m = 0.2;
  options.start_rad = 0.1;
  options.seed = seed;
  return options;
}

double worst_pose_m(const ObjectsWindow& made, const std::vector<Rigid3>& poses) {
  double worst = 0.0;
  for (std::size_t t = 0; t < poses.size(); ++t) {
    worst = std::max(worst, (poses[t].translation - made.truth[t].translation).norm());
  }
  return worst;
}

bool all_told(const ObjectsWindow& made, const VemResult& result) {
  bool told = true;
  for (std::size_t i = 0; i < made.moved.size(); ++i) told = told && result.objects[i].accepted == (made.moved[i] == 0);
  return told;
}

}  // namespace

TEST(Vem, FindsThePoseAndTheMovedThoughMostHaveMoved) {
  for (unsigned seed = 1; seed <= 8; ++seed) {
    const ObjectsWindow made = make_objects(far_shifts(seed));
    ASSERT_GT(worst_pose_m(made, made.window.poses), 0.15);
    const VemResult result = Vem(VemOptions{}).solve(made.window);
    ASSERT_EQ(result.fault, "");
    EXPECT_TRUE(result.solved && result.converged) << seed;
    EXPECT_TRUE(all_told(made, result)) << seed;
    EXPECT_LT(worst_pose_m(made, result.poses), 0.02) << seed;
    EXPECT_GT(result.num_accepted, 100);
  }
}

TEST(Vem, MovesNoneWhereNothingMoved) {
  ObjectsOptions options = far_shifts(1);
  options.num_moved = 0;
  const ObjectsWindow made = make_objects(options);
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  EXPECT_TRUE(all_told(made, result));
  EXPECT_LT(worst_pose_m(made, result.poses), 0.01);
  for (const VemObjectResult& object : result.objects) EXPECT_GT(object.consistency, 0.8);
}

TEST(Vem, StructureHoldsThePoseWhereAllObjectsMoved) {
  ObjectsOptions options = far_shifts(2);
  options.num_moved = options.num_objects;
  options.num_structure = 200;
  options.start_m = 0.1;
  options.start_rad = 0.03;
  const ObjectsWindow made = make_objects(options);
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  EXPECT_TRUE(all_told(made, result));
  EXPECT_LT(worst_pose_m(made, result.poses), 0.02);
}

TEST(Vem, TheReferenceSolverComesToTheSameEnd) {
  const ObjectsWindow made = make_objects(far_shifts(3));
  VemOptions options;
  const VemResult own = Vem(options).solve(made.window);
  options.solver = VemSolver::ceres;
  const VemResult reference = Vem(options).solve(made.window);
  ASSERT_EQ(own.iterations.size(), reference.iterations.size());
  EXPECT_LT(local(own.poses.back(), reference.poses.back()).norm(), 1e-6);
  for (std::size_t i = 0; i < own.iterations.size(); ++i) {
    EXPECT_EQ(own.iterations[i].num_accepted, reference.iterations[i].num_accepted);
    EXPECT_NEAR(own.iterations[i].elbo, reference.iterations[i].elbo, 1e-3);
  }
}

TEST(Vem, WhatIsNotBelievedStaysWhereTheMapHasIt) {
  const ObjectsWindow made = make_objects(far_shifts(4));
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  std::size_t next = 0;
  for (std::size_t i = 0; i < made.moved.size(); ++i) {
    const VemObject& asked = made.window.objects[i];
    EXPECT_EQ(result.objects[i].position == asked.position, made.moved[i] != 0);
    for (int k = 0; k < asked.num_landmarks; ++k, ++next) {
      const bool same = result.landmarks[next] == made.window.landmarks[next].p_prev;
      EXPECT_EQ(same, made.moved[i] != 0);
    }
  }
}

TEST(Vem, TheBoundNeverFallsInTheWholeCoordinateAscent) {
  for (unsigned seed = 1; seed <= 5; ++seed) {
    VemOptions options;
    options.em_state = VemState::held;
    options.mean_field = true;
    options.gate = VemGate::none;
    options.anneal_sigma_m = 0.0;
    options.burn_in = options.hold_belief = 0;
    options.stop_m = -1.0;  // all iterations
    ObjectsOptions near = far_shifts(seed);
    near.start_m = 0.05;
    near.start_rad = 0.01;
    const ObjectsWindow made = make_objects(near);
    const VemResult result = Vem(options).solve(made.window);
    ASSERT_EQ(result.iterations.size(), 30U);
    for (std::size_t i = 1; i < result.iterations.size(); ++i) {
      const double before = result.iterations[i - 1].elbo;
      EXPECT_GE(result.iterations[i].elbo, before - 1e-9 * std::abs(before)) << seed << ", " << i;
    }
    EXPECT_GT(result.iterations.back().elbo, result.iterations.front().elbo + 10.0);
  }
}

TEST(Vem, SolvesTheRoomOfRectangles) {
  int solved = 0;
  constexpr int kRooms = 40;
  for (unsigned seed = 1; seed <= kRooms; ++seed) {
    simulated::RectanglesOptions options;
    options.seed = seed;
    const simulated::Rectangles scene = simulated::RectanglesMaker(options).make();
    const VemResult result = Vem(VemOptions{}).solve(simulated::first_frame(scene, options));
    ASSERT_EQ(result.fault, "");
    EXPECT_EQ(result.poses[0].translation.z(), 0.0);
    bool right = (result.poses[0].translation - scene.T_world_robot.translation).norm() < 0.05;
    for (std::size_t i = 0; i < scene.moved.size(); ++i) {
      const double v = result.objects[i].consistency;
      right = right && (scene.moved[i] != 0 ? v < 0.4 : v > 0.5);
    }
    solved += right ? 1 : 0;
  }
  EXPECT_GE(solved, kRooms - 3);  // a few start where another answer is nearer
}

TEST(Vem, GivesTheSameBitsEachTime) {
  const ObjectsWindow made = make_objects(far_shifts(5));
  Vem vem(VemOptions{});
  const VemResult once = vem.solve(made.window);
  vem.solve(make_objects(far_shifts(6)).window);  // what was before leaves no trace
  const VemResult again = vem.solve(made.window);
  EXPECT_EQ(once.consistency, again.consistency);
  EXPECT_EQ(once.poses.back().translation, again.poses.back().translation);
  EXPECT_EQ(once.landmarks, again.landmarks);
}

TEST(Vem, FollowsOdometryWhereNothingIsSeen) {
  ObjectsWindow made = make_objects(far_shifts(7));
  made.window.matches.clear();
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  EXPECT_TRUE(result.solved);
  EXPECT_EQ(result.num_accepted, 0);
  EXPECT_LT(local(result.poses.back(), made.window.poses.back()).norm(), 1e-9);
  for (const VemObjectResult& object : result.objects) {
    EXPECT_FALSE(object.accepted);
    EXPECT_EQ(object.latest_frame, -1);
  }
}

TEST(Vem, SolvesAWindowWithoutObjects) {
  VemWindow window;
  window.poses = {Rigid3{}};
  const VemResult result = Vem(VemOptions{}).solve(window);
  EXPECT_EQ(result.fault, "");
  EXPECT_TRUE(result.solved && result.converged);
}

TEST(Vem, RefusesWhatIsNoProblem) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  using Change = std::function<void(VemWindow&)>;
  const std::vector<std::pair<const char*, Change>> changes = {
      {"no frames", [](VemWindow& w) { w.poses.clear(); }},
      {"four dimensions", [](VemWindow& w) { w.dimension = 4; }},
      {"too many frames",
       [](VemWindow& w) {
         w.poses.resize(100);
         w.transitions.resize(99);
       }},
      {"a transition missing", [](VemWindow& w) { w.transitions.pop_back(); }},
      {"a pose that is none", [](VemWindow& w) { w.poses[1].translation.x() = kNan; }},
      {"a rotation of no length", [](VemWindow& w) { w.poses[1].rotation.coeffs().setZero(); }},
      {"sigma zero", [](VemWindow& w) { w.transitions[0].sigma_rad = 0.0; }},
      {"a prior that is none", [](VemWindow& w) { w.prior.sigma_m = kNan; }},
      {"a yaw that is none", [](VemWindow& w) { w.objects[0].yaw = kNan; }},
      {"a belief that is none", [](VemWindow& w) { w.objects[0].belief.alpha = 0.0; }},
      {"a weight that is none", [](VemWindow& w) { w.objects[0].k_outlier = -1.0; }},
      {"landmarks of nobody", [](VemWindow& w) { w.objects[0].num_landmarks -= 1; }},
      {"less than no landmarks", [](VemWindow& w) { w.objects[0].num_landmarks = -3; }},
      {"a landmark that is none", [](VemWindow& w) { w.landmarks[3].p_prev.z() = kNan; }},
      {"a landmark too far away", [](VemWindow& w) { w.landmarks[3].p_world.z() = 1e200; }},
      {"a match of no frame", [](VemWindow& w) { w.matches[3].frame = 99; }},
      {"a match before the first frame", [](VemWindow& w) { w.matches[3].frame = -1; }},
      {"a match of no landmark", [](VemWindow& w) { w.matches[3].landmark = 1 << 20; }},
      {"a match twice", [](VemWindow& w) { w.matches.push_back(w.matches[3]); }},
      {"a match without sigma", [](VemWindow& w) { w.matches[3].sigma_m = 0.0; }},
      {"space in the plane", [](VemWindow& w) { w.dimension = 2; }},
  };
  for (const auto& [name, change] : changes) {
    SCOPED_TRACE(name);
    VemWindow window = make_objects(ObjectsOptions{}).window;
    ASSERT_EQ(fault_of(window), "");
    change(window);
    const VemResult result = Vem(VemOptions{}).solve(window);
    EXPECT_NE(result.fault, "");
    EXPECT_FALSE(result.solved || result.converged);
    EXPECT_TRUE(result.poses.empty());
  }
}

}  // namespace povslam
