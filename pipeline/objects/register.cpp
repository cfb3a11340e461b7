#include "pipeline/objects/register.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

constexpr int kIterations = 6;
constexpr std::size_t kMaxPoints = 400;
constexpr double kPriorShift_m = 0.05, kPriorTurn_rad = 0.10, kSurfaceSigma_m = 0.02;
constexpr double kTruncated = 0.75;    // of the truncation: free space is further from the surface than that, for sure
constexpr double kIndependent = 50.0;  // points: the errors of a surface's neighbouring points are much the same

// Motion about the observation's middle: p -> c + Rz(yaw) (p - c) + t.
struct Motion {
  Eigen::Vector3d middle = Eigen::Vector3d::Zero();
  Eigen::Vector4d value = Eigen::Vector4d::Zero();  // t, yaw
  Rigid3 rigid() const {
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(value[3], Eigen::Vector3d::UnitZ()));
    return {turn, middle + value.head<3>() - turn * middle};
  }
};

}  // namespace

Registration register_points(const Observation& observation, const Volume& volume, const Rigid3& T_world_volume,
                             double inlier_m) {
  Registration out;
  const std::size_t stride = std::max<std::size_t>(1, observation.points_world.size() / kMaxPoints);
  const Rigid3 T_volume_world = T_world_volume.inverse();
  Motion motion;
  int count = 0;
  for (std::size_t i = 0; i < observation.points_world.size(); i += stride, ++count) {
    motion.middle += observation.points_world[i].cast<double>();
  }
  if (count == 0) return out;
  motion.middle /= count;
  double radius_m = 0.0;
  const double farthest_m = kTruncated * volume.options().truncation_m;

  Eigen::Vector4d prior;
  prior << Eigen::Vector3d::Constant(1.0 / (kPriorShift_m * kPriorShift_m)), 1.0 / (kPriorTurn_rad * kPriorTurn_rad);
  for (int iteration = 0; iteration <= kIterations; ++iteration) {
    const Rigid3 T = motion.rigid();
    Eigen::Matrix4d H = Eigen::Matrix4d::Zero();
    Eigen::Vector4d b = Eigen::Vector4d::Zero();
    out.points = out.known = out.inliers = 0;
    double sum_m = 0.0;
    for (std::size_t i = 0; i < observation.points_world.size(); i += stride) {
      ++out.points;
      const Eigen::Vector3d p_world = observation.points_world[i].cast<double>(), p = T * p_world;
      radius_m = std::max(radius_m, (p_world - motion.middle).head<2>().norm());
      const std::optional<Volume::Sample> sample = volume.sample(T_volume_world * p);
      if (!sample) continue;
      ++out.known;
      const double tolerance_m = std::min(inlier_m + 3.0 * static_cast<double>(observation.sigma_m[i]), farthest_m);
      if (iteration == 0 && sample->distance_m > tolerance_m) ++out.before;
      const double sigma = std::hypot(kSurfaceSigma_m, static_cast<double>(observation.sigma_m[i]));
      sum_m += std::abs(sample->distance_m);
      if (std::abs(sample->distance_m) > tolerance_m) continue;
      ++out.inliers;
      const Eigen::Vector3d normal = T_world_volume.rotation * sample->gradient;
      const Eigen::Vector3d arm = p - motion.middle - motion.value.head<3>();
      Eigen::Vector4d J;
      J << normal, normal.dot(Eigen::Vector3d::UnitZ().cross(arm));
      const double weight = 1.0 / (sigma * sigma);
      H += weight * J * J.transpose();
      b -= weight * J * sample->distance_m;
    }
    if (iteration == 0) out.mean_distance_m = out.known > 0 ? sum_m / out.known : 0.0;
    if (iteration == kIterations || out.inliers < 10) break;
    const double independent = std::min(1.0, kIndependent / out.inliers);
    H *= independent;
    b *= independent;
    H.diagonal() += prior;
    b -= prior.cwiseProduct(motion.value);
    const Eigen::Vector4d step = H.ldlt().solve(b);
    motion.value += step;
  }
  out.T_fitted_observed = motion.rigid();
  out.shift_m = motion.value.head<3>().norm();
  out.turn_rad = std::abs(motion.value[3]);
  out.most_turned_m = out.turn_rad * radius_m;
  return out;
}

}  // namespace povslam
