#include "pipeline/vem_exchange.hpp"

#include <algorithm>

namespace povslam {

namespace {
constexpr int kMinMatches = 8;  // of an object in the current frame, before it is judged
constexpr double kOtherPlaceM = 0.2;
constexpr double kInPlaceSigmas = 4.0, kFarMore = 1.5;
}  // namespace

VemExchange::VemExchange(const PinholeCamera& camera, const FrontendOptions& frontend, const WindowOptions& options,
                         const BeliefOptions& belief)
    : camera_(camera),
      options_(options),
      match_variance_(options.match_sigma_m * options.match_sigma_m),
      depth_noise_(frontend.noise.depth_sigma_quadratic_per_m),
      search_(camera, frontend),
      matcher_(frontend.orb.num_features),
      index_of_landmark_(static_cast<std::size_t>(frontend.map.max_landmarks), kNone),
      found_at_(static_cast<std::size_t>(frontend.map.max_landmarks), -1) {
  const auto features = static_cast<std::size_t>(frontend.orb.num_features);
  frames_.reserve(static_cast<std::size_t>(options.frames) + 1);
  spare_.resize(static_cast<std::size_t>(options.frames) + 1);
  for (WindowFrame& frame : spare_) frame.seen.reserve(2 * features);
  wanted_.reserve(features);
  elsewhere_.reserve(2 * features);
  problem_.belief = belief;
}

void VemExchange::know(const ObjectBelief& belief, ObjectTrust& trust) {
  if (belief.gone) {
    known_.erase(belief.object);
    trust.forget(belief.object);
    return;
  }
  Known& known = known_[belief.object];
  const bool elsewhere = (belief.place.position - known.belief.place.position).norm() > kOtherPlaceM;
  if (elsewhere) known = {};  // what moved and was found again: what was said, was said of its old place
  known.belief = belief;
  known.consistency = belief.belief.expected_consistency();
  trust.set(belief.object, known.trust());
}

VemProblem* VemExchange::take(const Map& map) {
  if (state_ != State::idle || !due_) return nullptr;
  due_ = false;
  if (!fill(map)) return nullptr;
  state_ = State::out;
  outdated_ = false;
  return &problem_;
}

void VemExchange::give_back(VemProblem* problem) {
  EXPECTS(problem == &problem_ && state_ == State::out);
  state_ = State::answered;
}

std::optional<Rigid3> VemExchange::apply(ObjectTrust& trust) {
  if (state_ != State::answered) return std::nullopt;
  state_ = State::idle;
  const VemResult& result = problem_.result;
  if (!result.fault.empty()) ++counts_.faults;
  if (!result.solved) return std::nullopt;
  ++counts_.runs;
  counts_.iterations += result.spent_iterations;
  counts_.matches += std::ssize(problem_.window.matches);
  counts_.landmarks += std::ssize(problem_.window.landmarks);
  for (std::size_t i = 0; i < result.objects.size(); ++i) judge(i, trust);
  const std::optional<Rigid3> T_new_old = outdated_ ? std::nullopt : correction();
  correcting_ = T_new_old ? correcting_ + 1 : 0;
  if (correcting_ < options_.verdicts) return std::nullopt;
  correcting_ = 0;
  ++counts_.corrections;
  forget();
  return T_new_old;
}

// One window may err; an object is doubted, and believed again, when several say so.
void VemExchange::judge(std::size_t object, ObjectTrust& trust) {
  const VemObjectResult& result = problem_.result.objects[object];
  const auto entry = known_.find(problem_.object[object]);
  const bool current = result.latest_frame + 1 == std::ssize(problem_.window.poses);
  if (entry == known_.end() || !current || result.num_matches < kMinMatches) return;
  Known& known = entry->second;
  known.consistency = result.consistency;
  known.streak = result.accepted ? std::max(known.streak, 0) + 1 : std::min(known.streak, 0) - 1;
  if (!known.doubted && known.streak <= -options_.verdicts) {
    known.doubted = true;
    ++counts_.doubted;
  } else if (known.doubted && known.streak >= options_.verdicts) {
    known.doubted = false;
    ++counts_.believed_again;
  }
  trust.set(entry->first, known.trust());
}

// Of the current frame's matches, those that show their landmarks where the map has them, from this pose.
int VemExchange::num_in_place(const Rigid3& T_world_camera) const {
  const VemWindow& window = problem_.window;
  int in_place = 0;
  for (const VemMatch& match : window.matches) {
    if (match.frame + 1 != std::ssize(window.poses)) continue;
    const Eigen::Vector3d& p_world = window.landmarks[static_cast<std::size_t>(match.landmark)].p_prev;
    in_place += (T_world_camera * match.p_camera - p_world).norm() < kInPlaceSigmas * match.sigma_m ? 1 : 0;
  }
  return in_place;
}

// Where the window puts the camera, if that is elsewhere than tracking does and explains far more of what is seen: two
// answers that explain about as much would take turns.
std::optional<Rigid3> VemExchange::correction() const {
  const VemResult& result = problem_.result;
  const Rigid3& tracked = problem_.window.poses.back();
  const Rigid3& solved = result.poses.back();
  const bool elsewhere = (solved.translation - tracked.translation).norm() > options_.correct_m ||
                         rotation_angle_rad(tracked.inverse() * solved) > options_.correct_rad;
  if (!elsewhere || result.num_accepted < options_.correct_matches) return std::nullopt;
  if (num_in_place(solved) < kFarMore * num_in_place(tracked) + options_.correct_matches) return std::nullopt;
  return solved * tracked.inverse();
}

void VemExchange::doubted(std::vector<std::int64_t>& objects) const {
  objects.clear();
  for (const std::int64_t object : problem_.object) {
    const auto entry = known_.find(object);
    if (entry != known_.end() && entry->second.doubted) objects.push_back(object);
  }
}

}  // namespace povslam
