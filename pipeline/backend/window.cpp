#include "pipeline/backend/window.hpp"

#include <algorithm>
#include <cmath>
#include <numeric>

#include "pipeline/backend/kernels/kernels.hpp"

namespace povslam {

namespace {

constexpr double kMaxUnitError = 1e-3;  // of a quaternion's norm
constexpr double kMaxLength_m = 1e6;    // beyond it squares lose what is asked for
constexpr double kMinSigma = 1e-6, kMaxSigma = 1e6;

bool fine(const Eigen::Vector3d& p) {
  return p.allFinite() && p.cwiseAbs().maxCoeff() < kMaxLength_m;
}
bool fine(const Rigid3& T) {
  return fine(T.translation) && std::abs(T.rotation.norm() - 1.0) < kMaxUnitError;
}
bool fine_sigma(double sigma) {
  return sigma >= kMinSigma && sigma <= kMaxSigma;
}
bool fine(const Belief& belief) {
  return std::isfinite(belief.mu) && belief.sigma2 > 0.0 && std::isfinite(belief.sigma2) && belief.alpha > 0.0 &&
         std::isfinite(belief.alpha) && belief.beta > 0.0 && std::isfinite(belief.beta);
}

bool flat(const Rigid3& T) {
  return T.translation.z() == 0.0 && T.rotation.x() == 0.0 && T.rotation.y() == 0.0;
}
bool flat(const Eigen::Vector3d& p) {
  return p.z() == 0.0;
}

std::string fault_of_motion(const VemWindow& window) {
  const auto frames = window.poses.size();
  if (frames == 0 || frames > kVemMaxFrames) return "a window has 1 to " + std::to_string(kVemMaxFrames) + " frames";
  if (window.transitions.size() + 1 != frames) return "a transition is needed between any two neighbouring frames";
  for (const Rigid3& pose : window.poses) {
    if (!fine(pose)) return "a pose is none";
  }
  for (const VemTransition& Z : window.transitions) {
    if (!fine(Z.T_before_after) || !fine_sigma(Z.sigma_m) || !fine_sigma(Z.sigma_rad)) return "a transition is none";
  }
  const VemPosePrior& prior = window.prior;
  if (!fine(prior.T_world_camera) || !fine_sigma(prior.sigma_m) || !fine_sigma(prior.sigma_rad)) {
    return "the prior of the oldest pose is none";
  }
  return {};
}

std::string fault_of_objects(const VemWindow& window) {
  std::int64_t landmarks = 0;
  for (const VemObject& object : window.objects) {
    if (!fine(object.position) || !std::isfinite(object.yaw)) return "an object's place is none";
    if (!fine(object.belief)) return "a belief is none";
    if (!(object.k_inlier >= 0.0 && object.k_outlier >= 0.0 && object.k_inlier + object.k_outlier < kMaxSigma)) {
      return "the weight k of a class is none";
    }
    if (object.num_landmarks < 0) return "an object has less than no landmarks";
    landmarks += object.num_landmarks;
  }
  if (landmarks != std::ssize(window.landmarks)) return "objects have other landmarks than there are";
  for (const VemLandmark& landmark : window.landmarks) {
    if (!fine(landmark.p_world) || !fine(landmark.p_object) || !fine(landmark.p_prev)) return "a landmark is none";
  }
  return {};
}

std::string fault_of_matches(const VemWindow& window) {
  const auto frames = std::ssize(window.poses), landmarks = std::ssize(window.landmarks);
  std::vector<char> taken(static_cast<std::size_t>(frames * landmarks), 0);
  for (const VemMatch& match : window.matches) {
    if (match.frame < 0 || match.frame >= frames || match.landmark < 0 || match.landmark >= landmarks) {
      return "a match names a frame or landmark that is not there";
    }
    if (!fine(match.p_camera) || !fine_sigma(match.sigma_m)) return "a match is none";
    char& pair = taken[static_cast<std::size_t>(match.frame * landmarks + match.landmark)];
    if (pair != 0) return "a landmark is matched twice in one frame";
    pair = 1;
  }
  return {};
}

bool all_flat(const VemWindow& window) {
  const auto flat_transition = [](const VemTransition& Z) { return flat(Z.T_before_after); };
  const auto flat_landmark = [](const VemLandmark& l) { return flat(l.p_world) && flat(l.p_object) && flat(l.p_prev); };
  return std::ranges::all_of(window.poses, [](const Rigid3& T) { return flat(T); }) &&
         std::ranges::all_of(window.transitions, flat_transition) && flat(window.prior.T_world_camera) &&
         std::ranges::all_of(window.objects, [](const VemObject& object) { return flat(object.position); }) &&
         std::ranges::all_of(window.landmarks, flat_landmark) &&
         std::ranges::all_of(window.matches, [](const VemMatch& match) { return flat(match.p_camera); });
}

}  // namespace

std::string fault_of(const VemWindow& window) {
  if (window.dimension != 2 && window.dimension != 3) return "a window has 2 or 3 dimensions";
  for (const auto& look : {fault_of_motion, fault_of_objects, fault_of_matches}) {
    if (std::string fault = look(window); !fault.empty()) return fault;
  }
  if (window.dimension == 2 && !all_flat(window)) return "something is off the plane of a window in the plane";
  return {};
}

}  // namespace povslam
