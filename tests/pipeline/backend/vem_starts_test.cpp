#include "pipeline/backend/vem_starts.hpp"

#include <gtest/gtest.h>

#include "pipeline/backend/vem.hpp"
#include "tests/support/simulated_objects.hpp"
#include "tests/support/simulated_rectangles.hpp"

namespace povslam {

namespace {

using simulated::make_objects;
using simulated::ObjectsOptions;
using simulated::ObjectsWindow;

ObjectsOptions far_off(unsigned seed) {
  ObjectsOptions options;
  options.start_m = 0.3;
  options.start_rad = 0.14;
  options.seed = seed;
  return options;
}

double off_m(const ObjectsWindow& made, const Rigid3& T_start_window) {
  return ((T_start_window * made.window.poses[0]).translation - made.truth[0].translation).norm();
}

bool all_right(const ObjectsWindow& made, const VemResult& result) {
  bool right = result.solved;
  for (std::size_t i = 0; i < made.moved.size(); ++i) {
    right = right && result.objects[i].accepted == (made.moved[i] == 0);
  }
  for (std::size_t t = 0; t < made.truth.size(); ++t) {
    right = right && (result.poses[t].translation - made.truth[t].translation).norm() < 0.05;
  }
  return right;
}

}  // namespace

TEST(OtherStarts, BringTheUnmovedToWhereTheMapHasThem) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    const ObjectsWindow made = make_objects(far_off(seed));
    const auto starts = other_starts(made.window, made.window.poses, 1);
    ASSERT_EQ(starts.size(), 1U) << seed;
    EXPECT_LT(off_m(made, starts[0].T_start_window), 0.15) << seed;
    EXPECT_LT(off_m(made, starts[0].T_start_window), 0.5 * off_m(made, Rigid3{})) << seed;
  }
}

TEST(OtherStarts, AreNoneOfWhatIsSolvedAlready) {
  const ObjectsWindow made = make_objects(far_off(3));
  const auto starts = other_starts(made.window, made.truth, 4);
  ASSERT_FALSE(starts.empty());
  for (const VemStart& start : starts) EXPECT_GT(off_m(made, start.T_start_window), 0.1);
}

TEST(OtherStarts, ComeBestFirstAndDifferFromEachOther) {
  const ObjectsWindow made = make_objects(far_off(2));
  const auto starts = other_starts(made.window, made.window.poses, 4);
  ASSERT_EQ(starts.size(), 4U);
  for (std::size_t i = 1; i < starts.size(); ++i) {
    EXPECT_GE(starts[i - 1].support, starts[i].support);
    EXPECT_GT(local(starts[i - 1].T_start_window, starts[i].T_start_window).norm(), 0.01);
  }
}

TEST(OtherStarts, StayInThePlane) {
  simulated::RectanglesOptions options;
  const simulated::Rectangles scene = simulated::RectanglesMaker(options).make();
  const VemWindow window = simulated::first_frame(scene, options);
  for (const VemStart& start : other_starts(window, window.poses, 4)) {
    EXPECT_EQ(start.T_start_window.translation.z(), 0.0);
    EXPECT_EQ(start.T_start_window.rotation.x(), 0.0);
    EXPECT_EQ(start.T_start_window.rotation.y(), 0.0);
  }
}

TEST(OtherStarts, NeedMoreThanOneThing) {
  ObjectsOptions options = far_off(1);
  options.num_objects = options.num_moved = 1;
  const ObjectsWindow made = make_objects(options);
  EXPECT_TRUE(other_starts(made.window, made.window.poses, 4).empty());
}

TEST(OtherStarts, AreFineWhereAllPointsAreOne) {
  ObjectsWindow made = make_objects(far_off(1));
  for (VemLandmark& landmark : made.window.landmarks) landmark.p_prev = Eigen::Vector3d::Ones();
  for (VemMatch& match : made.window.matches) match.p_camera = Eigen::Vector3d::UnitZ();
  for (const VemStart& start : other_starts(made.window, made.window.poses, 4)) {
    EXPECT_TRUE(start.T_start_window.translation.allFinite());
    EXPECT_NEAR(start.T_start_window.rotation.norm(), 1.0, 1e-9);
  }
}

TEST(VemStarts, ASecondOneMendsWhatTheNearestAnswerSpoils) {
  int own = 0, both = 0;
  VemOptions one_start;
  one_start.other_starts = 0;
  constexpr int kWindows = 24;
  for (unsigned seed = 1; seed <= kWindows; ++seed) {
    const ObjectsWindow made = make_objects(far_off(seed));
    const VemResult near = Vem(one_start).solve(made.window), best = Vem(VemOptions{}).solve(made.window);
    own += all_right(made, near) ? 1 : 0;
    both += all_right(made, best) ? 1 : 0;
    EXPECT_GE(best.elbo(), near.elbo()) << seed;
    EXPECT_EQ(best.other_start, best.elbo() > near.elbo()) << seed;
  }
  EXPECT_LE(own, kWindows - 5);  // else this shows nothing
  EXPECT_GE(both, kWindows - 2);
}

TEST(VemStarts, OnlyTheWindowsOwnIsSolvedWhereLittleIsRejected) {
  ObjectsOptions options;
  options.num_moved = 1;
  const ObjectsWindow made = make_objects(options);
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  EXPECT_TRUE(all_right(made, result));
  EXPECT_EQ(result.num_starts, 1);
  EXPECT_EQ(result.spent_iterations, static_cast<int>(result.iterations.size()));
  VemOptions suspicious;
  suspicious.doubtful_share = 0.0;
  EXPECT_EQ(Vem(suspicious).solve(made.window).num_starts, 2);
}

TEST(VemStarts, AllIterationsAreCounted) {
  const ObjectsWindow made = make_objects(far_off(1));
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  ASSERT_EQ(result.num_starts, 2);
  EXPECT_GT(result.spent_iterations, static_cast<int>(result.iterations.size()));
  EXPECT_EQ(result.consistency.size(), result.iterations.size() * made.window.objects.size());
}

}  // namespace povslam
