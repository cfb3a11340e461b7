#include "pipeline/backend/factors/rigidity_factor.hpp"

#include <cmath>

namespace povslam {

bool RigidityFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  using Map3 = Eigen::Map<const Eigen::Vector3d>;
  const double* object = parameters[0];
  const double c = std::cos(object[3]), s = std::sin(object[3]);
  const Eigen::Vector3d arm(c * p_object_.x() - s * p_object_.y(), s * p_object_.x() + c * p_object_.y(),
                            p_object_.z());
  Eigen::Map<Eigen::Vector3d>{residuals} = whiten_ * (Map3(object) + arm - Map3(parameters[1]));
  if (jacobians == nullptr) return true;
  if (jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 4, Eigen::RowMajor>> by_object(jacobians[0]);
    by_object.leftCols<3>() = whiten_ * Eigen::Matrix3d::Identity();
    by_object.col(3) = whiten_ * Eigen::Vector3d(-arm.y(), arm.x(), 0.0);
  }
  if (jacobians[1] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[1]} = -whiten_ * Eigen::Matrix3d::Identity();
  }
  return true;
}

}  // namespace povslam
