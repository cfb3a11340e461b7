// How far two neighbouring poses are from the motion that odometry measured (POV-SLAM, eq. 2-3):
//   T_off = (T_world_before^-1 T_world_after)^-1 Z,  e = [ t_off ; Log(R_off) ]
// Z maps points of the later camera into the earlier one. Translation and rotation have a sigma each; equal ones are
// the paper's.
#pragma once

#include <ceres/sized_cost_function.h>

#include "pipeline/backend/window.hpp"

namespace povslam {

struct VoTransitionError {
  Vector6d e;                    // m, rad
  Matrix6d by_before, by_after;  // by Rigid3's retract
};
VoTransitionError vo_transition_error(const VemTransition& Z, const Rigid3& T_world_before,
                                      const Rigid3& T_world_after);

Vector6d inverse_sigmas(double sigma_m, double sigma_rad);  // of a stacked error

// Parameter blocks: T_world_before, T_world_after (7 each, see PoseManifold). 6 residuals, whitened.
class VoTransitionFactor final : public ceres::SizedCostFunction<6, 7, 7> {
 public:
  explicit VoTransitionFactor(const VemTransition& Z) : Z_(Z) {}
  bool Evaluate(double const* const* parameters, double* residuals, double** jacobians) const override;

 private:
  VemTransition Z_;
};

}  // namespace povslam
