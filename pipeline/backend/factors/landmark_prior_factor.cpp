#include "pipeline/backend/factors/landmark_prior_factor.hpp"

namespace povslam {

bool LandmarkPriorFactor::Evaluate(double const* const* parameters, double* residuals, double** jacobians) const {
  Eigen::Map<Eigen::Vector3d>{residuals} = whiten_ * (Eigen::Map<const Eigen::Vector3d>(parameters[0]) - p_prev_);
  if (jacobians != nullptr && jacobians[0] != nullptr) {
    Eigen::Map<Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>{jacobians[0]} = whiten_ * Eigen::Matrix3d::Identity();
  }
  return true;
}

}  // namespace povslam
