// The E-step (POV-SLAM, section IV-A): from residuals to what is believed of each object and how much each match
// counts. Densities are of vectors of n = `dimension` numbers in metres.
#pragma once

#include <vector>

#include "pipeline/backend/window_sheet.hpp"
#include "pipeline/objects/state.hpp"

namespace povslam {

inline constexpr double kMaxConsistency = 0.9999;  // v_max: E[v] of structure, and where a logarithm of E[v] is taken

double log_gaussian_peak(int dimension, double variance);  // log N(0 | 0, variance I)
double log_uniform(int dimension, double e_max_m, VemUniform measure);

struct ConsistencyLogs {
  double log_v = 0.0, log_not_v = 0.0;
  double odds() const { return log_v - log_not_v; }  // psi(alpha + beta) cancels
};
ConsistencyLogs expected_logs(double alpha, double beta);  // eq. 14: E[log v], E[log(1 - v)]
ConsistencyLogs logs_of_expected(const Belief& belief);    // single point: log E[v], log(1 - E[v])

// Eq. 12-13. bias = log_gaussian_peak - log_uniform.
double responsibility(double odds, double bias, double error2, double variance);
// Eq. 15 with its constants, q(v) held: log( e^log_v N + e^log_not_v U ).
double match_bound(const ConsistencyLogs& logs, double log_gaussian, double log_uniform);
// Eq. 16-17: the residual below which the max-mixture takes the Gaussian; 0 if there is none.
double gate_radius(double expected_v, double sigma_m, double bias);
double kl_beta(double alpha, double beta, double prior_alpha, double prior_beta);  // KL( Beta || prior )

// The E-step of a window, iteration after iteration.
class Expectation {
 public:
  void start(const VemWindow& window, const WindowSheet& sheet, const VemOptions& options);

  // Beliefs after the residuals were measured once more (or as they are: held), then responsibilities.
  void run(const WindowSheet& sheet, const std::vector<Quad>& error2, bool held);
  // information of each match: E[pi] / variance where accepted, else 0. gated = false: all matches are accepted.
  VemDecision decide(const WindowSheet& sheet, const std::vector<Quad>& error2, bool gated,
                     std::vector<Quad>& information) const;

  double expected_v(std::size_t object) const;  // structure: v_max
  const Belief& belief(std::size_t object) const { return states_[object].working; }
  double change_m(std::size_t object) const { return states_[object].change_m; }  // Delta; 0 if it has no match
  const std::vector<Quad>& responsibilities() const { return pi_; }
  double bound() const { return bound_; }  // ELBO of all matches, after run()

 private:
  struct State {
    ObjectClass object_class;
    Belief stored, working;
    double q_alpha = 0.0, q_beta = 0.0;  // of q(v); with mean_field the responsibilities are in it
    double change_m = 0.0, bound = 0.0;
    int num_matches = 0, latest_frame = -1;
    bool structure = false;
  };

  double measure_change(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2) const;
  void update_belief(State& state) const;
  ConsistencyLogs logs(const State& state) const;
  double gate_odds(const State& state) const;
  double weigh(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2);  // sum of E[pi]
  double weigh_pooled(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2);
  VemDecision decide_by_pi(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2,
                           std::vector<Quad>& information) const;
  VemDecision decide_pooled(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2,
                            std::vector<Quad>& information) const;

  VemOptions options_;
  double log_uniform_ = 0.0;
  std::vector<State> states_;
  std::vector<Quad> pi_;
  double bound_ = 0.0;
};

}  // namespace povslam
