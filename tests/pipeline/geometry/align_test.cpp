#include "pipeline/geometry/align.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include <limits>
#include <vector>

#include "tests/support/random_geometry.hpp"

namespace povslam {
namespace {

using Points = std::vector<Eigen::Vector3d>;

Points moved(const Rigid3& T_a_b, const Points& points_b) {
  Points points_a;
  for (const Eigen::Vector3d& p : points_b) points_a.push_back(T_a_b * p);
  return points_a;
}

Points tetrahedron() {
  return {{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}, {0.0, 2.0, 0.0}, {0.0, 0.0, 3.0}};
}

}  // namespace

RC_GTEST_PROP(AlignPoints, RecoversTheMotion, ()) {
  const Rigid3 T_a_b = testing::random_rigid(100.0);
  Points points_b = tetrahedron();
  for (int i = *rc::gen::inRange(0, 50); i > 0; --i) points_b.push_back(testing::random_vector(5.0));
  const auto found = align_points(moved(T_a_b, points_b), points_b);
  RC_ASSERT(found.has_value());
  RC_ASSERT(testing::difference(*found, T_a_b) < 1e-11);
}

RC_GTEST_PROP(AlignPoints, RecoversTheMotionOfThreePointsInAPlane, ()) {
  const Rigid3 T_a_b = testing::random_rigid();
  const Points triangle{{0.0, 0.0, 1.0}, {1.0, 0.0, 1.0}, {0.0, 2.0, 1.0}};
  const auto found = align_points(moved(T_a_b, triangle), triangle);
  RC_ASSERT(found.has_value());
  RC_ASSERT(testing::difference(*found, T_a_b) < 1e-11);
}

RC_GTEST_PROP(AlignPoints, IsNotBeatenByAMotionNearby, ()) {
  Points points_b = tetrahedron();
  Points points_a = moved(testing::random_rigid(), points_b);
  for (Eigen::Vector3d& p : points_a) p += testing::random_vector(0.1);
  const auto best = align_points(points_a, points_b);
  RC_ASSERT(best.has_value());
  const auto cost = [&](const Rigid3& T) {
    double sum = 0.0;
    for (std::size_t i = 0; i < points_a.size(); ++i) sum += (points_a[i] - T * points_b[i]).squaredNorm();
    return sum;
  };
  Vector6d nudge;
  nudge << testing::random_vector(1e-3), testing::random_vector(1e-3);
  RC_ASSERT(cost(retract(*best, nudge)) >= cost(*best) - 1e-12);
}

RC_GTEST_PROP(AlignPoints, NeverMirrors, ()) {
  const Points points_b = tetrahedron();
  Points points_a = points_b;
  for (Eigen::Vector3d& p : points_a) p.x() = -p.x();
  const auto found = align_points(moved(testing::random_rigid(), points_a), points_b);
  RC_ASSERT(found.has_value());
  RC_ASSERT(std::abs(found->matrix3().determinant() - 1.0) < 1e-12);
}

RC_GTEST_PROP(AlignPoints, RefusesPointsOnOneLineUnlessAllowed, ()) {
  const Eigen::Vector3d start = testing::random_vector(10.0), direction = testing::random_axis();
  Points line;
  for (int i = 0; i < 10; ++i) line.push_back(start + i * direction);
  const Points other = moved(testing::random_rigid(), line);
  RC_ASSERT(!align_points(other, line).has_value());
  const auto allowed = align_points(other, line, true);
  RC_ASSERT(allowed.has_value());
  for (std::size_t i = 0; i < line.size(); ++i) RC_ASSERT((*allowed * line[i] - other[i]).norm() < 1e-12);
}

TEST(AlignPoints, RefusesTooFewOrCoincidentPoints) {
  const Points two{{0.0, 0.0, 0.0}, {1.0, 0.0, 0.0}};
  EXPECT_FALSE(align_points(two, two, true));
  const Points same(5, Eigen::Vector3d(1.0, 2.0, 3.0));
  EXPECT_FALSE(align_points(same, same));
}

TEST(AlignPoints, RefusesWhatIsNotANumber) {
  for (const double poison : {std::numeric_limits<double>::quiet_NaN(), std::numeric_limits<double>::infinity()}) {
    Points points = tetrahedron();
    points[2].y() = poison;
    EXPECT_FALSE(align_points(points, tetrahedron(), true));
  }
}

}  // namespace povslam
