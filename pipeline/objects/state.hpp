// The belief about one object: how far it changed (Gaussian) and whether it stays where it is (Beta), updated exactly
// for each measurement by moment matching (POCD, Qian et al., RSS 2022, supplement eq. 7-23).
#pragma once

#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/object_event.hpp"
#include "pipeline/objects/options.hpp"

namespace povslam {

struct ChangeMeasurement {
  double change_m = 0.0;    // Delta; clamped to Dmax
  double tau2 = 0.01;       // its variance [m^2]
  double max_change_m = 4;  // Dmax: the outlier's density is 1 / (2 Dmax)
  bool stationary = false;  // s: class that hardly changes
  double k = 0.0;           // weight of the class
};

struct BeliefUpdate {
  Belief belief;
  double inlier = 0.0;    // C1: probability that the measurement speaks of the object as believed
  double evidence = 0.0;  // density of the measurement: eta1 N + eta2 U, in which eta1 + eta2 < 1 for k > 0
};

// Supplement eq. 14-23. Counts are not capped.
BeliefUpdate update(const Belief& belief, const ChangeMeasurement& measurement);

// The update with k as the class says for an inlier or an outlier (decided with k = 0), then the cap on counts.
BeliefUpdate observe_change(const Belief& belief, double change_m, const ObjectClass& object_class,
                            const BeliefOptions& options);

Belief initial_belief(const ObjectClass& object_class, const BeliefOptions& options);

// E[v] where its logarithm is taken: within [1e-4, 0.9999].
double clamped_consistency(const Belief& belief);

}  // namespace povslam
