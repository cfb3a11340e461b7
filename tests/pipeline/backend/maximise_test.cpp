#include "pipeline/backend/maximise.hpp"

#include <gtest/gtest.h>

#include "pipeline/backend/expect.hpp"
#include "tests/support/simulated_objects.hpp"

namespace povslam {

namespace {

using simulated::make_objects;
using simulated::ObjectsOptions;

// A problem with the weights and decisions of one E-step, held.
struct Held {
  VemWindow window;
  VemOptions options;
  WindowSheet sheet;
  VemEstimate estimate;
  std::vector<Quad> information;

  explicit Held(const VemWindow& asked) : window(asked) {
    sheet.assign(window, options);
    estimate = sheet.initial(window);
    measure_errors(sheet, estimate);
    Expectation expectation;
    expectation.start(window, sheet, options);
    sheet.set_least_sigma(0.3);  // as in the first iterations, else nothing would be accepted
    expectation.run(sheet, estimate.error2, false);
    information.assign(sheet.num_slots(), Quad{});
    expectation.decide(sheet, estimate.error2, true, information);
  }

  MaximiseReport solve(VemSolver solver, int steps, VemEstimate& answer) const {
    const auto maximiser = make_maximiser(solver);
    maximiser->start(window, sheet);
    answer = estimate;
    return maximiser->maximise(information, steps, 1e-14, answer);
  }
};

struct Difference {
  double pose = 0.0, object = 0.0, landmark = 0.0;
};

Difference difference(const Held& held, const VemEstimate& a, const VemEstimate& b) {
  Difference most;
  for (std::size_t t = 0; t < a.poses.size(); ++t) {
    most.pose = std::max(most.pose, local(a.poses[t], b.poses[t]).norm());
  }
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    most.object = std::max(most.object, (a.objects[i].position - b.objects[i].position).norm());
    most.object = std::max(most.object, std::abs(a.objects[i].yaw - b.objects[i].yaw));
  }
  for (std::size_t i = 0; i < held.window.landmarks.size(); ++i) {
    const Eigen::Vector3d apart = held.sheet.landmark(a.landmarks, i) - held.sheet.landmark(b.landmarks, i);
    most.landmark = std::max(most.landmark, apart.norm());
  }
  return most;
}

void expect_same_optimum(const VemWindow& window) {
  const Held held(window);
  VemEstimate structured, ceres;
  const MaximiseReport first = held.solve(VemSolver::structured, 50, structured);
  const MaximiseReport second = held.solve(VemSolver::ceres, 50, ceres);
  EXPECT_LT(first.cost_after, first.cost_before);
  EXPECT_NEAR(first.cost_before, second.cost_before, 1e-9 * first.cost_before);
  EXPECT_NEAR(first.cost_after, second.cost_after, 1e-9 * first.cost_after);
  const Difference off = difference(held, structured, ceres);
  EXPECT_LT(off.pose, 1e-9);
  EXPECT_LT(off.object, 1e-9);
  EXPECT_LT(off.landmark, 1e-9);
  EXPECT_GT(local(structured.poses.back(), window.poses.back()).norm(), 1e-3);  // else there was nothing to solve
}

}  // namespace

TEST(Maximise, BothSolversFindTheSameOptimum) {
  ObjectsOptions options;
  options.start_m = 0.1;
  options.start_rad = 0.03;
  expect_same_optimum(make_objects(options).window);
}

TEST(Maximise, BothSolversFindTheSameOptimumWithStructure) {
  ObjectsOptions options;
  options.num_structure = 101;
  options.start_m = 0.1;
  options.num_frames = 3;
  options.share_seen = 0.5;
  expect_same_optimum(make_objects(options).window);
}

}  // namespace povslam
