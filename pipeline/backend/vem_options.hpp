// Options of the variational EM. What the paper leaves open is an option here; docs/vem.md says why the default is so.
#pragma once

#include <cstdint>

#include "pipeline/objects/options.hpp"

namespace povslam {

enum class VemSolver : std::uint8_t { structured, ceres };
enum class VemWeights : std::uint8_t { elbo, single_point };  // E[pi] by E[log v], or by log E[v]
enum class VemUniform : std::uint8_t { norm, ball };          // outlier's density: 1 / e_max, or 1 / volume of the ball
enum class VemGate : std::uint8_t { expected_v, expected_pi, none };  // what decides the max-mixture; none: no gate
enum class VemPool : std::uint8_t { landmark, object };               // one pi for a landmark's match, or for an object
// What goes on from one iteration to the next: nothing changes (the stored belief is used), each iteration updates the
// stored belief anew, the Beta is carried, or the Gaussian as well.
enum class VemState : std::uint8_t { held, none, beta, full };

struct VemOptions {
  VemSolver solver = VemSolver::structured;
  VemWeights weights = VemWeights::elbo;
  VemUniform uniform_measure = VemUniform::norm;
  VemGate gate = VemGate::expected_v;
  VemPool pool = VemPool::landmark;
  VemState em_state = VemState::beta;
  bool mean_field = false;  // q(v) takes the responsibilities in: the whole coordinate ascent

  double sigma_rigid_m = 0.03;
  double sigma_prior_m = 0.02;  // see docs/vem.md: a window weighs each match anew, the prior once
  double e_max_m = 4.0;

  int max_iterations = 30;  // of EM
  int steps = 1;            // of Gauss-Newton in each M-step, the gate decided anew before each
  double stop_m = 1e-4;     // both: no pose moved further and nothing was decided otherwise
  double stop_rad = 1e-4;
  double stop_consistency = 0.02;  // and no E[v] changed by more
  // Not in the paper: at first all matches count by E[pi] alone, beliefs stay as stored, and sigma of the matches
  // begins large.
  int burn_in = 5;              // iterations without gate; 0: none
  int hold_belief = 3;          // iterations without update of beliefs; 0: none
  double anneal_sigma_m = 0.5;  // 0: none
  double anneal_factor = 0.75;  // per iteration, until the match's own sigma

  // Not in the paper: where the window's own start leaves much unexplained, others are tried and the largest ELBO is
  // taken.
  int other_starts = 1;         // at most; 0: none
  double doubtful_share = 0.2;  // of all matches: if more are rejected

  double accept_share = 0.5;  // of an object's matches in the current frame that must be accepted, and…
  int accept_matches = 3;     // …at least so many
  BeliefOptions belief;
};

}  // namespace povslam
