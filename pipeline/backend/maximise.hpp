// The M-step (POV-SLAM, section IV-C, eq. 18): poses, objects and landmarks that fit best with the weights of the
// matches as they are. Two solvers behind one interface, with the same optimum: one made for this problem, and Ceres as
// the reference. See docs/vem.md.
#pragma once

#include <memory>

#include "pipeline/backend/window_sheet.hpp"

namespace povslam {

struct MaximiseReport {
  int steps = 0;                               // that were taken
  double cost_before = 0.0, cost_after = 0.0;  // 1/2 sum of whitened squares; before: landmarks at their best already
  double matched_after = 0.0;                  // what of it is the matches'
  double moved_m = 0.0, moved_rad = 0.0;       // the furthest any pose went in the last step
  bool failed = false;                         // no step lowers the cost, or numbers that are none
  double preparation_s = 0.0;                  // by Ceres' own clock, what it took before and after minimising
};

class Maximiser {
 public:
  virtual ~Maximiser() = default;
  // A new problem; window and sheet are referred to until the next start.
  virtual void start(const VemWindow& window, const WindowSheet& sheet) = 0;
  // At most `max_steps` damped Gauss-Newton steps with `information` (by block and frame, [1/m^2]) from the estimate,
  // in place; error2 is that of the estimate afterwards. Stops before when a step moves nothing by more than
  // `tolerance` [m, rad]. Landmarks are always at their best for the poses. Never raises the cost.
  virtual MaximiseReport maximise(const std::vector<Quad>& information, int max_steps, double tolerance,
                                  VemEstimate& estimate) = 0;
};

std::unique_ptr<Maximiser> make_structured_maximiser();
std::unique_ptr<Maximiser> make_ceres_maximiser();
std::unique_ptr<Maximiser> make_maximiser(VemSolver solver);

// Squared residuals of the estimate as it is; the cost of all factors of landmarks but the matches'.
double measure_errors(const WindowSheet& sheet, VemEstimate& estimate);
// Landmarks to their best places for poses and objects as they are, and their squared residuals; the cost of all
// factors of landmarks.
VemCost settle_landmarks(const WindowSheet& sheet, const std::vector<Quad>& information, VemEstimate& estimate);
// Cost of transitions and prior.
double motion_cost(const VemWindow& window, const std::vector<Rigid3>& poses);

}  // namespace povslam
