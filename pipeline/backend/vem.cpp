#include "pipeline/backend/vem.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "pipeline/backend/vem_starts.hpp"
#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {

double wrapped(double angle) {
  return std::remainder(angle, 2.0 * std::numbers::pi);
}

bool fine(const VemEstimate& estimate) {
  const auto fine_pose = [](const Rigid3& T) { return T.translation.allFinite() && T.rotation.coeffs().allFinite(); };
  const auto fine_object = [](const VemEstimate::Object& o) { return o.position.allFinite() && std::isfinite(o.yaw); };
  const auto fine_quad = [](const Quad& q) {
    return std::ranges::all_of(q.lane, [](double value) { return std::isfinite(value); });
  };
  return std::ranges::all_of(estimate.poses, fine_pose) && std::ranges::all_of(estimate.objects, fine_object) &&
         std::ranges::all_of(estimate.landmarks, fine_quad);
}

// A camera that was carried sees one thing as it would if the thing had been.
bool on_one_thing(const VemResult& result) {
  return std::ranges::count_if(result.objects, [](const VemObjectResult& o) { return o.accepted; }) < 2;
}

}  // namespace

Vem::Vem(const VemOptions& options) : options_(options), maximiser_(make_maximiser(options.solver)) {
  EXPECTS(options.sigma_rigid_m > 0.0 && options.sigma_prior_m > 0.0 && options.e_max_m > 0.0);
  EXPECTS(options.max_iterations >= 1 && options.steps >= 1);
  EXPECTS(options.anneal_sigma_m >= 0.0 && options.anneal_factor > 0.0 && options.anneal_factor < 1.0);
  EXPECTS(options.other_starts >= 0 && options.doubtful_share >= 0.0);
}

// From where the window is, then, if that leaves much unexplained, from other places: the largest ELBO wins. All ends
// are compared with the matches' own sigmas and the same stored beliefs.
VemResult Vem::solve(const VemWindow& window) {
  VemResult best;
  best.fault = fault_of(window);
  if (!best.fault.empty()) return best;
  sheet_.assign(window, options_);
  best = solve_from(window, window.poses, {options_.anneal_sigma_m, options_.burn_in});
  best.spent_iterations = static_cast<int>(best.iterations.size());
  if (options_.other_starts == 0 || !doubtful(best)) return best;
  for (const VemStart& start : other_starts(window, best.poses, options_.other_starts)) {
    std::vector<Rigid3> poses = window.poses;
    for (Rigid3& pose : poses) pose = start.T_start_window * pose;
    VemResult other = solve_from(window, poses, {0.0, 0});
    const int spent = best.spent_iterations + static_cast<int>(other.iterations.size()), starts = best.num_starts + 1;
    const bool better = !best.solved || other.elbo() > best.elbo();
    if (other.solved && !on_one_thing(other) && better) {
      best = std::move(other);
      best.other_start = true;
    }
    best.spent_iterations = spent;
    best.num_starts = starts;
  }
  return best;
}

VemResult Vem::solve_from(const VemWindow& window, const std::vector<Rigid3>& poses, const Schedule& schedule) {
  VemResult result;
  schedule_ = schedule;
  sheet_.set_least_sigma(0.0);
  estimate_ = sheet_.initial(window);
  estimate_.poses = poses;
  expectation_.start(window, sheet_, options_);
  maximiser_->start(window, sheet_);
  information_.assign(sheet_.num_slots(), Quad{});
  other_cost_ = measure_errors(sheet_, estimate_) + motion_cost(window, estimate_.poses);
  for (int n = 0; n < options_.max_iterations && !result.converged; ++n) {
    result.iterations.push_back(iterate(n));
    for (std::size_t i = 0; i < window.objects.size(); ++i) result.consistency.push_back(expectation_.expected_v(i));
    result.converged = settled(n, result);
  }
  result.solved = fine(estimate_);
  if (!result.solved) estimate_ = sheet_.initial(window);
  report_matches(window, result);
  report_objects(window, result);
  report_places(window, result);
  return result;
}

bool Vem::doubtful(const VemResult& result) const {
  const auto rejected = std::ranges::count_if(result.matches, [](const VemMatchResult& m) { return !m.accepted; });
  return !result.solved ||
         static_cast<double>(rejected) > options_.doubtful_share * static_cast<double>(result.matches.size());
}

double Vem::least_sigma(int iteration) const {
  return schedule_.anneal_sigma_m * std::pow(options_.anneal_factor, iteration);
}

VemIteration Vem::iterate(int iteration) {
  sheet_.set_least_sigma(least_sigma(iteration));
  expectation_.run(sheet_, estimate_.error2, iteration < options_.hold_belief);
  VemIteration out;
  out.elbo = expectation_.bound() - other_cost_;
  maximise(iteration, out);
  out.T_world_camera = estimate_.poses.back();
  return out;
}

void Vem::maximise(int iteration, VemIteration& out) {
  const std::vector<Rigid3> before = estimate_.poses;
  for (int step = 0; step < options_.steps; ++step) {
    const VemDecision decision =
        expectation_.decide(sheet_, estimate_.error2, iteration >= schedule_.burn_in, information_);
    out.num_accepted = decision.accepted;
    out.num_flipped += decision.flipped;
    const MaximiseReport report = maximiser_->maximise(information_, 1, 0.0, estimate_);
    out.cost = report.cost_after;
    out.preparation_s += report.preparation_s;
    other_cost_ = report.cost_after - report.matched_after;
    if (report.failed) break;
  }
  for (std::size_t t = 0; t < before.size(); ++t) {
    const Vector6d moved = local(before[t], estimate_.poses[t]);
    out.moved_m = std::max(out.moved_m, moved.head<3>().norm());
    out.moved_rad = std::max(out.moved_rad, moved.tail<3>().norm());
  }
}

bool Vem::settled(int iteration, const VemResult& result) const {
  const VemIteration& last = result.iterations.back();
  const bool early = iteration == 0 || iteration < std::max(schedule_.burn_in, options_.hold_belief) ||
                     least_sigma(iteration) > sheet_.smallest_sigma();
  if (early || last.num_flipped > 0 || last.moved_m > options_.stop_m || last.moved_rad > options_.stop_rad)
    return false;
  const std::size_t objects = estimate_.objects.size();
  const double* now = result.consistency.data() + result.consistency.size() - objects;
  for (std::size_t i = 0; i < objects; ++i) {
    if (std::abs(now[i] - *(now + i - objects)) > options_.stop_consistency) return false;
  }
  return true;
}

void Vem::report_matches(const VemWindow& window, VemResult& result) const {
  for (const VemMatch& match : window.matches) {
    const std::size_t at = sheet_.lane_of_match(match), slot = at / kVemLanes, lane = at % kVemLanes;
    const bool accepted = result.solved && information_[slot].lane[lane] > 0.0;
    result.matches.push_back(
        {expectation_.responsibilities()[slot].lane[lane], std::sqrt(estimate_.error2[slot].lane[lane]), accepted});
    result.num_accepted += accepted && match.frame + 1 == std::ssize(window.poses) ? 1 : 0;
  }
}

void Vem::report_objects(const VemWindow& window, VemResult& result) const {
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i < window.objects.size(); ++i) {
    const VemObject& asked = window.objects[i];
    owner.insert(owner.end(), static_cast<std::size_t>(asked.num_landmarks), i);
    VemObjectResult object{asked.position, wrapped(asked.yaw), expectation_.belief(i)};
    object.consistency = expectation_.expected_v(i);
    result.objects.push_back(object);
  }
  for (const VemMatch& match : window.matches) {
    int& latest = result.objects[owner[static_cast<std::size_t>(match.landmark)]].latest_frame;
    latest = std::max(latest, static_cast<int>(match.frame));
  }
  for (std::size_t i = 0; i < window.matches.size(); ++i) {
    VemObjectResult& object = result.objects[owner[static_cast<std::size_t>(window.matches[i].landmark)]];
    if (window.matches[i].frame != object.latest_frame) continue;
    ++object.num_matches;
    object.num_accepted += result.matches[i].accepted ? 1 : 0;
    object.change_m += result.matches[i].error_m;
  }
  for (VemObjectResult& object : result.objects) {
    if (object.num_matches > 0) object.change_m /= object.num_matches;
    object.accepted = object.num_accepted >= options_.accept_matches &&
                      object.num_accepted >= options_.accept_share * object.num_matches;
  }
}

void Vem::report_places(const VemWindow& window, VemResult& result) const {
  result.poses = estimate_.poses;
  for (std::size_t i = 0; i < window.objects.size(); ++i) {
    VemObjectResult& object = result.objects[i];
    const bool stays = object.num_matches > 0 && !object.accepted;  // what is not believed must not drift
    if (!stays) {
      object.position = estimate_.objects[i].position;
      object.yaw = wrapped(estimate_.objects[i].yaw);
    }
    for (int k = 0; k < window.objects[i].num_landmarks; ++k) {
      const std::size_t at = result.landmarks.size();
      result.landmarks.push_back(stays ? window.landmarks[at].p_prev : sheet_.landmark(estimate_.landmarks, at));
    }
  }
}

}  // namespace povslam
