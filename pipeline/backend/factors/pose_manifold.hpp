// The unit quaternion and translation of a Rigid3 as a Ceres parameter block, perturbed by Rigid3's retract:
// p <- p + rho, R <- Exp(phi) R. Seven numbers qx qy qz qw px py pz; tangent (rho, phi), translation first.
#pragma once

#include <ceres/manifold.h>

#include <array>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

using PoseBlock = std::array<double, 7>;

PoseBlock to_block(const Rigid3& T);
Rigid3 from_block(const PoseBlock& block);  // the quaternion is normalised

class PoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 6; }
  bool Plus(const double* pose, const double* xi, double* moved) const override;
  bool PlusJacobian(const double* pose, double* jacobian) const override;  // 7 x 6, row-major
  bool Minus(const double* other, const double* pose, double* xi) const override;
  bool MinusJacobian(const double* pose, double* jacobian) const override;  // 6 x 7, row-major
};

}  // namespace povslam
