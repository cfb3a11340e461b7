#include "pipeline/frontend/solve_pose.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <random>

#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

constexpr double kSigmaPx = 0.8, kSigmaInverseDepth = 0.0025;

class Scene {
 public:
  explicit Scene(unsigned seed) : random_(seed), points_(made::cloud(200, seed)) {
    T_camera_world_ = made::looking_along_y({normal(0.2), normal(0.2), normal(0.2)}).inverse();
    T_camera_world_.rotation = so3_exp({normal(0.1), normal(0.1), normal(0.1)}) * T_camera_world_.rotation;
  }

  // What the camera measures of the points it has before it. noise: factor on the sigmas.
  std::vector<PoseObservation> observe(double noise) {
    std::vector<PoseObservation> observations;
    for (const Eigen::Vector3d& p_world : points_) {
      const Eigen::Vector3d p = T_camera_world_ * p_world;
      const auto pixel = camera_.project(p);
      if (!pixel || !camera_.contains(*pixel)) continue;
      PoseObservation o;
      o.p_world = p_world;
      o.u_px = pixel->x() + normal(noise * kSigmaPx);
      o.v_px = pixel->y() + normal(noise * kSigmaPx);
      o.weight_px = 1.0 / (kSigmaPx * kSigmaPx);
      o.inverse_depth_per_m = 1.0 / p.z() + normal(noise * kSigmaInverseDepth);
      o.weight_inverse_depth = 1.0 / (kSigmaInverseDepth * kSigmaInverseDepth);
      observations.push_back(o);
    }
    return observations;
  }

  Rigid3 perturbed(double metres, double radians) {
    Vector6d xi;
    for (int i = 0; i < 6; ++i) xi[i] = normal(i < 3 ? metres : radians);
    return se3_exp(xi) * T_camera_world_;
  }
  double normal(double sigma) { return sigma * normal_(random_); }
  double uniform(double low, double high) { return std::uniform_real_distribution<double>(low, high)(random_); }

  const PinholeCamera& camera() const { return camera_; }
  const Rigid3& truth() const { return T_camera_world_; }

 private:
  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  PinholeCamera camera_ = made::half_camera();
  std::vector<Eigen::Vector3d> points_;
  Rigid3 T_camera_world_;
};

Vector6d error_of(const PoseSolution& solution, const Rigid3& truth) {
  return se3_log(solution.T_camera_world * truth.inverse());
}

// Half the sum of squared whitened residuals, from the camera's own projection.
double cost(const PinholeCamera& camera, const Rigid3& T_camera_world, const std::vector<PoseObservation>& all) {
  double sum = 0.0;
  for (const PoseObservation& o : all) {
    const Eigen::Vector3d p = T_camera_world * o.p_world;
    const Eigen::Vector2d off = *camera.project(p) - Eigen::Vector2d(o.u_px, o.v_px);
    const double off_depth = 1.0 / p.z() - o.inverse_depth_per_m;
    sum += 0.5 * (o.weight_px * off.squaredNorm() + o.weight_inverse_depth * off_depth * off_depth);
  }
  return sum;
}

}  // namespace

TEST(SolvePose, RecoversAKnownPoseExactly) {
  Scene scene(1);
  auto observations = scene.observe(0.0);
  const PoseSolution solution = solve_pose(scene.camera(), scene.perturbed(0.05, 0.03), observations, {});
  EXPECT_TRUE(solution.converged);
  EXPECT_EQ(solution.num_inliers, static_cast<int>(observations.size()));
  EXPECT_EQ(solution.num_depth_inliers, static_cast<int>(observations.size()));
  EXPECT_LT(error_of(solution, scene.truth()).norm(), 1e-9);
}

TEST(SolvePose, RecoversAKnownPoseWhenAThirdOfTheMatchesAreWrong) {
  for (unsigned seed = 1; seed <= 30; ++seed) {
    Scene scene(seed);
    auto observations = scene.observe(1.0);
    std::vector<bool> wrong;
    for (PoseObservation& o : observations) {
      wrong.push_back(scene.uniform(0.0, 1.0) < 0.3);
      if (!wrong.back()) continue;
      o.u_px += scene.uniform(10.0, 60.0) * (scene.uniform(-1.0, 1.0) < 0.0 ? -1.0 : 1.0);
      o.v_px += scene.uniform(-60.0, 60.0);
      o.inverse_depth_per_m = scene.uniform(0.1, 1.0);
    }
    const PoseSolution solution =
        solve_pose(scene.camera(), scene.perturbed(0.03, 0.02), observations, {.first_gate = 4.0});
    ASSERT_TRUE(solution.converged) << seed;
    const Vector6d error = error_of(solution, scene.truth());
    EXPECT_LT(error.dot(solution.information * error), 22.5) << seed;  // chi2, 6 dof, 99.9 %
    EXPECT_LT(error.head<3>().norm(), 0.015) << seed;
    int right_kept = 0, right = 0;
    for (std::size_t i = 0; i < wrong.size(); ++i) {
      if (wrong[i]) {
        EXPECT_FALSE(observations[i].fits) << seed;
      }
      right += wrong[i] ? 0 : 1;
      right_kept += !wrong[i] && observations[i].fits ? 1 : 0;
    }
    EXPECT_GT(right_kept, 0.88 * right) << seed;
    EXPECT_NEAR(solution.chi2_per_dof, 1.0, 0.3) << seed;
  }
}

TEST(SolvePose, JudgesDepthApartFromThePixel) {
  Scene scene(4);
  auto observations = scene.observe(0.5);
  for (std::size_t i = 0; i < observations.size(); i += 3) observations[i].inverse_depth_per_m *= 0.7;
  for (std::size_t i = 1; i < observations.size(); i += 3) {
    observations[i].inverse_depth_per_m = 0.0;
    observations[i].weight_inverse_depth = 0.0;
  }
  const PoseSolution solution = solve_pose(scene.camera(), scene.perturbed(0.03, 0.02), observations, {});
  ASSERT_TRUE(solution.converged);
  EXPECT_LT(error_of(solution, scene.truth()).head<3>().norm(), 0.006);
  int pixels = 0;
  for (std::size_t i = 0; i < observations.size(); ++i) {
    EXPECT_EQ(observations[i].depth_fits, i % 3 == 2 && observations[i].fits) << i;
    pixels += observations[i].fits ? 1 : 0;
  }
  EXPECT_EQ(pixels, solution.num_inliers);
  EXPECT_GT(pixels, 0.97 * static_cast<double>(observations.size()));
}

TEST(SolvePose, KnowsHowFarItsEstimatesSpread) {
  constexpr int kRuns = 400;
  double nees = 0.0, inside = 0.0;
  for (int run = 1; run <= kRuns; ++run) {
    Scene scene(static_cast<unsigned>(run));
    auto observations = scene.observe(1.0);
    const PoseSolution solution = solve_pose(scene.camera(), scene.perturbed(0.02, 0.01), observations, {});
    ASSERT_TRUE(solution.converged);
    const Vector6d error = error_of(solution, scene.truth());
    const double squared = error.dot(solution.information * error);
    nees += squared / kRuns;
    inside += squared < 12.59 ? 1.0 / kRuns : 0.0;  // chi2, 6 dof, 95 %
  }
  EXPECT_NEAR(nees, 6.0, 1.0);
  EXPECT_NEAR(inside, 0.95, 0.04);
}

TEST(SolvePose, EndsWhereTheCostIsLowestAndCurvedAsItSays) {
  Scene scene(5);
  auto exact = scene.observe(0.0);
  const PoseSolution at_truth = solve_pose(scene.camera(), scene.perturbed(0.02, 0.01), exact, {});
  auto noisy = scene.observe(0.3);  // within the gates: no weight is less than one
  const PoseSolution off_truth = solve_pose(scene.camera(), scene.perturbed(0.02, 0.01), noisy, {});
  ASSERT_EQ(off_truth.num_depth_inliers, static_cast<int>(noisy.size()));
  constexpr double kStep = 1e-4;
  const auto moved = [](const PoseSolution& solution, int i, double a, int j, double b) {
    Vector6d xi = Vector6d::Zero();
    xi[i] += a;
    xi[j] += b;
    return se3_exp(xi) * solution.T_camera_world;
  };
  for (int i = 0; i < 6; ++i) {
    const double slope = (cost(scene.camera(), moved(off_truth, i, kStep, i, 0.0), noisy) -
                          cost(scene.camera(), moved(off_truth, i, -kStep, i, 0.0), noisy)) /
                         (2.0 * kStep);
    EXPECT_LT(std::abs(slope), 1e-2 * std::sqrt(off_truth.information(i, i))) << i;
    for (int j = 0; j < 6; ++j) {
      const auto at = [&](double a, double b) { return cost(scene.camera(), moved(at_truth, i, a, j, b), exact); };
      const double curvature =
          (at(kStep, kStep) - at(kStep, -kStep) - at(-kStep, kStep) + at(-kStep, -kStep)) / (4.0 * kStep * kStep);
      const double scale = std::sqrt(at_truth.information(i, i) * at_truth.information(j, j));
      EXPECT_NEAR(at_truth.information(i, j), curvature, 2e-3 * scale) << i << ' ' << j;
    }
  }
}

TEST(SolvePose, DoesNotConvergeOnFewerThanFourMatches) {
  for (std::size_t count = 0; count < 4; ++count) {
    Scene scene(6);
    auto observations = scene.observe(0.0);
    observations.resize(count);
    EXPECT_FALSE(solve_pose(scene.camera(), scene.truth(), observations, {}).converged) << count;
  }
}

TEST(SolvePose, DoesNotConvergeWhereThePoseIsUndetermined) {
  Scene scene(7);
  auto one_point = scene.observe(0.0);
  for (PoseObservation& o : one_point) o = one_point.front();
  EXPECT_FALSE(solve_pose(scene.camera(), scene.truth(), one_point, {}).converged);
  auto behind = scene.observe(0.0);
  for (PoseObservation& o : behind) o.p_world = scene.truth().inverse() * Eigen::Vector3d(0.1, 0.2, -3.0);
  EXPECT_FALSE(solve_pose(scene.camera(), scene.truth(), behind, {}).converged);
  auto nonsense = scene.observe(0.0);
  for (PoseObservation& o : nonsense) o.u_px = std::numeric_limits<double>::quiet_NaN();
  EXPECT_FALSE(solve_pose(scene.camera(), scene.truth(), nonsense, {}).converged);
}

TEST(SolvePose, DoesNotConvergeOnMatchesThatAgreeOnNothing) {
  for (unsigned seed = 1; seed <= 20; ++seed) {
    Scene scene(seed);
    auto observations = scene.observe(0.0);
    for (PoseObservation& o : observations) {
      o.u_px = scene.uniform(0.0, 320.0);
      o.v_px = scene.uniform(0.0, 240.0);
      o.inverse_depth_per_m = scene.uniform(0.1, 1.0);
    }
    const PoseSolution solution = solve_pose(scene.camera(), scene.truth(), observations, {});
    EXPECT_LT(solution.num_inliers, 12) << seed;
  }
}

}  // namespace povslam
