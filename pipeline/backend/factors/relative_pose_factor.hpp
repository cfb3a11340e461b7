// How far two poses are from a measured relative motion, whitened: with T = T_world_from^-1 T_world_to,
//   r = [ (p(T) - p(T_measured)) / sigma_m, Log(R(T) R(T_measured)^T) / sigma_rad ]
// which is local(T_measured, T), see Rigid3, in the axes of `from`.
#pragma once

#include <ceres/sized_cost_function.h>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

struct RelativePose {
  Rigid3 T_from_to;                                                            // measured
  double sigma_m = 1.0, sigma_rad = 1.0;                                       // one standard deviation per axis
  Vector6d error(const Rigid3& T_world_from, const Rigid3& T_world_to) const;  // m, rad
  Vector6d whitened(const Vector6d& error) const;
};

// Parameter blocks: T_world_from and T_world_to (7 each, see PoseManifold). 6 residuals.
// The Jacobians are those along the manifold, told in the seven numbers of a block; across it they are zero.
class RelativePoseFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit RelativePoseFactor(const RelativePose& measured) : measured_(measured) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  RelativePose measured_;
};

}  // namespace povslam
