#include "pipeline/backend/expect.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/backend/kernels/dispatch.hpp"

namespace povslam {

namespace {

constexpr int kInnerIterations = 20;  // of E[pi] against q(v), until neither changes
constexpr double kInnerTolerance = 1e-9;

ConsistencyLogs structure_logs() {
  return {std::log(kMaxConsistency), std::log1p(-kMaxConsistency)};
}

// All matches of an object as one: sum of what each says for "unchanged" against "changed".
double pooled_evidence(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2) {
  double sum = 0.0;
  const std::size_t first = sheet.first_slot(object), end = first + static_cast<std::size_t>(sheet.slots_of(object));
  for (std::size_t slot = first; slot < end; ++slot) {
    for (int i = 0; i < kVemLanes; ++i) {
      const WindowSheet::Noise noise = sheet.noise_at(slot, i);
      if (noise.inverse_variance > 0.0) sum += noise.bias - 0.5 * error2[slot].lane[i] * noise.inverse_variance;
    }
  }
  return sum;
}

void take(double now, double& information, VemDecision& decision) {
  decision.accepted += now > 0.0 ? 1 : 0;
  decision.flipped += (now > 0.0) != (information > 0.0) ? 1 : 0;
  information = now;
}

}  // namespace

void Expectation::start(const VemWindow& window, const WindowSheet& sheet, const VemOptions& options) {
  options_ = options;
  log_uniform_ = log_uniform(window.dimension, options.e_max_m, options.uniform_measure);
  states_.assign(window.objects.size(), State{});
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i < states_.size(); ++i) {
    const VemObject& object = window.objects[i];
    State& state = states_[i];
    state.object_class.kind = object.kind;
    state.object_class.k_inlier = object.k_inlier;
    state.object_class.k_outlier = object.k_outlier;
    state.stored = state.working = object.belief;
    state.q_alpha = object.belief.alpha;
    state.q_beta = object.belief.beta;
    state.structure = object.kind == ClassKind::structure;
    owner.insert(owner.end(), static_cast<std::size_t>(object.num_landmarks), i);
  }
  for (const VemMatch& match : window.matches) {
    State& state = states_[owner[static_cast<std::size_t>(match.landmark)]];
    ++state.num_matches;
    state.latest_frame = std::max(state.latest_frame, static_cast<int>(match.frame));
  }
  pi_.assign(sheet.num_slots(), Quad{});
}

void Expectation::run(const WindowSheet& sheet, const std::vector<Quad>& error2, bool held) {
  bound_ = 0.0;
  for (std::size_t object = 0; object < states_.size(); ++object) {
    State& state = states_[object];
    if (state.num_matches == 0) continue;
    state.change_m = measure_change(sheet, object, error2);
    if (!state.structure && !held) update_belief(state);
    double sum_pi = weigh(sheet, object, error2);
    const bool inner = options_.mean_field && !state.structure;
    for (int i = 0; inner && i < kInnerIterations; ++i) {
      const double before = state.q_alpha;
      state.q_alpha = state.working.alpha + sum_pi;
      state.q_beta = state.working.beta + state.num_matches - sum_pi;
      sum_pi = weigh(sheet, object, error2);
      if (std::abs(state.q_alpha - before) < kInnerTolerance) break;
    }
    bound_ += state.bound;
    if (inner) bound_ -= kl_beta(state.q_alpha, state.q_beta, state.working.alpha, state.working.beta);
  }
}

double Expectation::measure_change(const WindowSheet& sheet, std::size_t object,
                                   const std::vector<Quad>& error2) const {
  double sum = 0.0;
  int count = 0;
  const auto frames = static_cast<std::size_t>(sheet.num_frames());
  const std::size_t first = sheet.first_slot(object), end = first + static_cast<std::size_t>(sheet.slots_of(object));
  for (std::size_t slot = first + static_cast<std::size_t>(states_[object].latest_frame); slot < end; slot += frames) {
    for (int i = 0; i < kVemLanes; ++i) {
      if (!sheet.matched(slot, i)) continue;
      sum += std::sqrt(error2[slot].lane[i]);
      ++count;
    }
  }
  return sum / count;
}

void Expectation::update_belief(State& state) const {
  if (options_.em_state == VemState::held) return;
  Belief before = state.stored;
  if (options_.em_state == VemState::full) before = state.working;
  if (options_.em_state == VemState::beta) {
    before.alpha = state.working.alpha;
    before.beta = state.working.beta;
  }
  state.working = observe_change(before, state.change_m, state.object_class, options_.belief).belief;
  if (options_.em_state == VemState::beta) {
    state.working.mu = state.stored.mu;
    state.working.sigma2 = state.stored.sigma2;
  }
  if (options_.mean_field) return;  // q(v) goes on from where it was
  state.q_alpha = state.working.alpha;
  state.q_beta = state.working.beta;
}

ConsistencyLogs Expectation::logs(const State& state) const {
  if (state.structure) return structure_logs();
  if (options_.weights == VemWeights::single_point) return logs_of_expected({0.0, 1.0, state.q_alpha, state.q_beta});
  return expected_logs(state.q_alpha, state.q_beta);
}

double Expectation::expected_v(std::size_t object) const {
  const State& state = states_[object];
  return state.structure ? kMaxConsistency : state.q_alpha / (state.q_alpha + state.q_beta);
}

double Expectation::gate_odds(const State& state) const {
  return state.structure ? structure_logs().odds() : logs_of_expected({0.0, 1.0, state.q_alpha, state.q_beta}).odds();
}

double Expectation::weigh(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2) {
  if (options_.pool == VemPool::object) return weigh_pooled(sheet, object, error2);
  State& state = states_[object];
  const ConsistencyLogs at = logs(state);
  const std::size_t first = sheet.first_slot(object);
  VemExpect sums{at.odds(), 0.0, 0.0};
  const VemNoise noise = sheet.noise(object);
  vem_kernels().expect(&noise, error2.data() + first, &sums, pi_.data() + first);
  state.bound = state.num_matches * (at.log_not_v + log_uniform_) + sums.sum_excess;
  return sums.sum_pi;
}

double Expectation::weigh_pooled(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2) {
  State& state = states_[object];
  const ConsistencyLogs at = logs(state);
  const double evidence = pooled_evidence(sheet, object, error2);
  const double pi = responsibility(at.odds(), evidence, 0.0, 1.0);
  const std::size_t first = sheet.first_slot(object), end = first + static_cast<std::size_t>(sheet.slots_of(object));
  for (std::size_t slot = first; slot < end; ++slot) {
    for (int i = 0; i < kVemLanes; ++i) pi_[slot].lane[i] = sheet.matched(slot, i) ? pi : 0.0;
  }
  state.bound = state.num_matches * log_uniform_ + match_bound(at, evidence, 0.0);
  return state.num_matches * pi;
}

VemDecision Expectation::decide(const WindowSheet& sheet, const std::vector<Quad>& error2, bool gated,
                                std::vector<Quad>& information) const {
  const bool open = !gated || options_.gate == VemGate::none;
  VemDecision all{0, 0};
  for (std::size_t object = 0; object < states_.size(); ++object) {
    VemDecision part{0, 0};
    if (!open && options_.pool == VemPool::object) {
      part = decide_pooled(sheet, object, error2, information);
    } else if (!open && options_.gate == VemGate::expected_pi && !states_[object].structure) {
      part = decide_by_pi(sheet, object, error2, information);
    } else {
      const std::size_t first = sheet.first_slot(object);
      const double odds = open ? std::numeric_limits<double>::infinity() : gate_odds(states_[object]);
      const VemNoise noise = sheet.noise(object);
      part = vem_kernels().gate(&noise, odds, error2.data() + first, pi_.data() + first, information.data() + first);
    }
    all.accepted += part.accepted;
    all.flipped += part.flipped;
  }
  return all;
}

VemDecision Expectation::decide_by_pi(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2,
                                      std::vector<Quad>& information) const {
  VemDecision decision{0, 0};
  const std::size_t first = sheet.first_slot(object), end = first + static_cast<std::size_t>(sheet.slots_of(object));
  for (std::size_t slot = first; slot < end; ++slot) {
    for (int i = 0; i < kVemLanes; ++i) {
      const WindowSheet::Noise noise = sheet.noise_at(slot, i);
      const double p = pi_[slot].lane[i], iv = noise.inverse_variance;
      const double logit = std::log(p / (1.0 - p)) + noise.bias - 0.5 * error2[slot].lane[i] * iv;
      take(logit >= 0.0 ? p * iv : 0.0, information[slot].lane[i], decision);
    }
  }
  return decision;
}

VemDecision Expectation::decide_pooled(const WindowSheet& sheet, std::size_t object, const std::vector<Quad>& error2,
                                       std::vector<Quad>& information) const {
  const bool accepted = gate_odds(states_[object]) + pooled_evidence(sheet, object, error2) >= 0.0;
  VemDecision decision{0, 0};
  const std::size_t first = sheet.first_slot(object), end = first + static_cast<std::size_t>(sheet.slots_of(object));
  for (std::size_t slot = first; slot < end; ++slot) {
    for (int i = 0; i < kVemLanes; ++i) {
      const double now = accepted ? pi_[slot].lane[i] * sheet.noise_at(slot, i).inverse_variance : 0.0;
      take(now, information[slot].lane[i], decision);
    }
  }
  return decision;
}

}  // namespace povslam
