// Variational EM: robot poses, objects and landmarks of a window, while what is believed of each object's consistency
// is inferred (POV-SLAM, sections III-E and IV). docs/vem.md: equation by equation, and where we do otherwise.
// Deterministic; no clocks, no threads. Never throws for a window, whatever is in it.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "pipeline/backend/expect.hpp"
#include "pipeline/backend/maximise.hpp"
#include "pipeline/backend/vem_options.hpp"
#include "pipeline/backend/window.hpp"

namespace povslam {

struct VemIteration {
  double elbo = 0.0;                      // before its M-step: of all matches, minus the cost of all other factors
  double cost = 0.0;                      // after its M-step, with its weights
  double moved_m = 0.0, moved_rad = 0.0;  // the furthest any pose went in its M-step
  int num_accepted = 0, num_flipped = 0;  // matches; flipped: decided otherwise than the iteration before
  Rigid3 T_world_camera;                  // of the current frame, after it
  double preparation_s = 0.0;             // Ceres' own, by its clock, of what its M-step took
};

struct VemObjectResult {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // where it was, if it is not accepted
  double yaw = 0.0;                                    // (-pi, pi]
  Belief working;                                      // of the last iteration, for a look: not to be stored
  double consistency = 0.0;                            // its E[v]
  int latest_frame = -1;                               // that matched it; -1: none of the window
  double change_m = 0.0;                               // Delta at the end, in that frame
  int num_matches = 0, num_accepted = 0;               // in that frame
  bool accepted = false;                               // it stands as believed: enough of these are accepted
};

struct VemMatchResult {
  double responsibility = 0.0;  // E[pi]
  double error_m = 0.0;
  bool accepted = false;
};

struct VemResult {
  std::string fault;       // not empty: the window was no problem, nothing moved
  bool solved = false;     // all numbers are fine: poses may be used
  bool converged = false;  // it stopped because nothing changed any more, not because iterations ran out
  int num_accepted = 0;    // matches in the current frame: what its pose hangs on, beside odometry
  std::vector<Rigid3> poses;
  std::vector<VemObjectResult> objects;
  std::vector<Eigen::Vector3d> landmarks;  // p_world; p_prev again, where the object is matched and not accepted
  std::vector<VemMatchResult> matches;
  std::vector<VemIteration> iterations;
  std::vector<double> consistency;  // E[v] by iteration and object
  int num_starts = 1;               // from which it was solved; all but this part is of the one with the largest ELBO
  bool other_start = false;         // that is not the window's own
  int spent_iterations = 0;         // of all starts
  double elbo() const { return iterations.empty() ? 0.0 : iterations.back().elbo; }
};

class Vem {
 public:
  explicit Vem(const VemOptions& options);
  VemResult solve(const VemWindow& window);

 private:
  struct Schedule {  // how a start is begun
    double anneal_sigma_m = 0.0;
    int burn_in = 0;
  };

  VemResult solve_from(const VemWindow& window, const std::vector<Rigid3>& poses, const Schedule& schedule);
  bool doubtful(const VemResult& result) const;
  double least_sigma(int iteration) const;  // of matches; 0: their own
  VemIteration iterate(int iteration);
  void maximise(int iteration, VemIteration& out);
  bool settled(int iteration, const VemResult& result) const;
  void report_matches(const VemWindow& window, VemResult& result) const;
  void report_objects(const VemWindow& window, VemResult& result) const;
  void report_places(const VemWindow& window, VemResult& result) const;

  VemOptions options_;
  Schedule schedule_;
  std::unique_ptr<Maximiser> maximiser_;
  WindowSheet sheet_;
  Expectation expectation_;
  VemEstimate estimate_;
  std::vector<Quad> information_;
  double other_cost_ = 0.0;  // of all factors but the matches', of the estimate
};

}  // namespace povslam
