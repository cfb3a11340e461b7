// A frame against the last one and against the local map: pairs, pose, the landmarks that fit it.
#include <algorithm>
#include <cmath>

#include "pipeline/frontend/pose_covariance.hpp"
#include "pipeline/frontend/track.hpp"

namespace povslam {

namespace {
constexpr double kMinFitting = 0.4;      // share of the points of the last frame that must agree on a pose
constexpr int kMinJoined = 40;           // fitting landmarks that say alone where the camera is
constexpr float kRemoteWidening = 2.0F;  // else: of the search for what an older visit left
}  // namespace

// Returns how many of the last frame's points fit the pose that came out, 0 when that is no pose to trust; else the
// frame then has this pose and its landmarks.
int Tracker::match_last(const Rigid3& T_camera_world, float radius_px) {
  frame_.T_camera_world = T_camera_world;
  compensate_shutter();
  search_.match_last(map_, last_, frame_, T_camera_world, radius_px, matcher_);
  if (matcher_.count() < kMinFromLast) return 0;
  observe_matches();
  PoseSolverOptions solver;
  solver.first_gate = 4.0;
  const PoseSolution solution = solve_pose(camera_, T_camera_world, observations_, solver);
  if (!solution.converged || solution.num_inliers < std::max<double>(kMinFromLast, kMinFitting * matcher_.count())) {
    return 0;
  }
  frame_.T_camera_world = solution.T_camera_world;
  take_landmarks();
  return solution.num_inliers;
}

bool Tracker::track_local_map(const Rigid3& T_camera_world, float widening) {
  frame_.T_camera_world = T_camera_world;
  compensate_shutter();
  local_map_.collect(map_, frame_, T_camera_world.inverse());
  PoseSolution solution = match_local_map(T_camera_world, widening, widening > 1.0F ? 9.0 : 2.0);
  if (solution.converged && refine_matches(solution) > 0) {
    frame_.T_camera_world = solution.T_camera_world;
    compensate_shutter();
    observe_matches();
    PoseSolverOptions solver;
    solver.first_gate = 2.0;
    solution = solve_pose(camera_, solution.T_camera_world, observations_, solver);
  }
  if (!solution.converged || solution.num_inliers < options_.track.min_inliers_degraded) return false;
  take_landmarks();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t seen = frame_.landmark[static_cast<std::size_t>(i)];
    if (seen != kNone) ++map_.landmark(seen).found;
  }
  learn_noise(solution);
  accept(solution);
  return true;
}

// An older visit's landmarks lie off by the drift since. Were all matched alike, both copies of the place would pull,
// and what most of them fit may be a pose of neither. So what hangs together with the last frames says where the camera
// is, if there is enough of it; of the rest that joins which agrees.
PoseSolution Tracker::match_local_map(const Rigid3& T_camera_world, float widening, double gate) {
  PoseSolverOptions solver;
  solver.first_gate = gate;
  search_.match_local(map_, local_map_.joined(), frame_, T_camera_world, widening, matcher_);
  observe_matches();
  PoseSolution solution = solve_pose(camera_, T_camera_world, observations_, solver);
  if (local_map_.remote().empty()) return solution;
  const bool enough = solution.converged && solution.num_inliers >= kMinJoined;
  const Rigid3 T_known = enough ? solution.T_camera_world : T_camera_world;
  search_.match_more(map_, local_map_.remote(), frame_, T_known, enough ? 1.0F : kRemoteWidening * widening, matcher_);
  observe_matches();
  solver.first_gate = enough ? 1.0 : gate;
  return solve_pose(camera_, T_known, observations_, solver);
}

// Turns the matcher's pairs into observations for the pose.
void Tracker::observe_matches() {
  observations_.clear();
  observed_feature_.clear();
  const Rigid3 T_world_last = last_.T_camera_world.inverse();
  for (int i = 0; i < frame_.size(); ++i) {
    const std::int32_t tag = matcher_.tag_of(i);
    if (tag == kNone) continue;
    const std::size_t k = static_cast<std::size_t>(i);
    PoseObservation o;
    o.trust = tag < kPointOfLast ? map_.trust(tag) : 1.0;
    double point_variance = 1.0;  // of the point's own inverse depth, in units of one reading's
    if (tag >= kPointOfLast) {
      o.p_world = T_world_last * last_.point_camera(tag - kPointOfLast, camera_);
    } else {
      o.p_world = map_.landmark(tag).p_world;
      point_variance = 1.0 / map_.landmark(tag).num_sightings;
    }
    const double sigma_px = frame_.sigma_px[k];
    o.u_px = frame_.x[k];
    o.v_px = frame_.y[k];
    o.weight_px = 1.0 / (sigma_px * sigma_px);
    if (frame_.has_depth(i)) {
      const double sigma_d = frame_.sigma_inverse_depth[k];
      o.inverse_depth_per_m = frame_.inverse_depth[k];
      o.weight_inverse_depth = 1.0 / (sigma_d * sigma_d * (1.0 + point_variance));
    }
    observations_.push_back(o);
    observed_feature_.push_back(i);
  }
}

int Tracker::refine_matches(const PoseSolution& solution) {
  int refined = 0;
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    if (!observations_[o].fits) continue;
    const int feature = observed_feature_[o];
    const std::int32_t slot = matcher_.tag_of(feature);
    if (refiner_.refine(map_, slot, builder_, solution.T_camera_world, frame_, feature)) ++refined;
  }
  return refined;
}

// The frame keeps the landmarks whose observations fit.
void Tracker::take_landmarks() {
  std::fill_n(frame_.landmark.begin(), frame_.size(), kNone);
  std::fill_n(frame_.misfit.begin(), frame_.size(), kNone);
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    const std::int32_t tag = matcher_.tag_of(observed_feature_[o]);
    if (tag >= kPointOfLast) continue;
    auto& kept = observations_[o].fits ? frame_.landmark : frame_.misfit;
    kept[static_cast<std::size_t>(observed_feature_[o])] = tag;
  }
}

void Tracker::learn_noise(const PoseSolution& solution) {
  depth_noise_.start();
  refiner_.start_learning();
  for (std::size_t i = 0; i < observations_.size(); ++i) {
    const PoseObservation& o = observations_[i];
    if (!o.fits) continue;
    const Eigen::Vector3d p = solution.T_camera_world * o.p_world;
    if (o.weight_inverse_depth > 0.0) {
      const double whitened = std::abs(1.0 / p.z() - o.inverse_depth_per_m) * std::sqrt(o.weight_inverse_depth);
      depth_noise_.add(whitened * depth_noise_.value());
    }
    const double du = camera_.fx * p.x() / p.z() + camera_.cx - o.u_px;
    const double dv = camera_.fy * p.y() / p.z() + camera_.cy - o.v_px;
    refiner_.learn(observed_feature_[i], std::hypot(du, dv));
  }
  depth_noise_.finish(1.1503);  // of a standard normal's absolute value
  refiner_.finish_learning();
}

// With the pose the frame has now, how fast the camera moves is known, and so where its rows would have seen the
// features at one instant.
void Tracker::compensate_shutter() {
  if (rolling_shutter_s_ == 0.0) return;
  const Rigid3 T_before_now = last_.T_camera_world * frame_.T_camera_world.inverse();
  frame_.compensate_motion(camera_, motion_.speed_after(T_before_now, frame_.stamp - last_.stamp), rolling_shutter_s_);
}

void Tracker::accept(const PoseSolution& solution) {
  frame_.T_camera_world = solution.T_camera_world;
  result_.T_world_camera = solution.T_camera_world.inverse();
  result_.num_landmarks = solution.num_inliers;
  if (local_map_.reference() != kNone) reference_id_ = map_.keyframe(local_map_.reference()).id;
  result_.covariance = covariance_to_landmarks(solution) + covariance_of_anchors(map_, frame_, result_.T_world_camera);
}

}  // namespace povslam
