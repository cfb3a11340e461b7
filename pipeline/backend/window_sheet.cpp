#include "pipeline/backend/window_sheet.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "pipeline/backend/expect.hpp"

namespace povslam {

namespace {

constexpr double kLeastSpread_m = 0.01;  // of landmarks about their middle, level, to tell how the object is turned

double& lane(std::vector<Quad>& quads, std::size_t index) {
  return quads[index / kVemLanes].lane[index % kVemLanes];
}

// Number of the first of three in an array by block and axis, for a landmark's lane.
std::size_t axis_lane(int landmark_lane, int axis) {
  return static_cast<std::size_t>((landmark_lane / kVemLanes * 3 + axis) * kVemLanes + landmark_lane % kVemLanes);
}

bool tells_yaw(const VemWindow& window, std::size_t first, int count) {
  Eigen::Vector2d middle = Eigen::Vector2d::Zero();
  for (int i = 0; i < count; ++i) middle += window.landmarks[first + i].p_object.head<2>() / count;
  double spread2 = 0.0;
  for (int i = 0; i < count; ++i) spread2 += (window.landmarks[first + i].p_object.head<2>() - middle).squaredNorm();
  return spread2 > kLeastSpread_m * kLeastSpread_m * count;
}

}  // namespace

void WindowSheet::assign(const VemWindow& window, const VemOptions& options) {
  num_frames_ = static_cast<int>(window.poses.size());
  dimension_ = window.dimension;
  log_uniform_ = log_uniform(dimension_, options.e_max_m, options.uniform_measure);
  sigma_rigid_m_ = options.sigma_rigid_m;
  sigma_prior_m_ = options.sigma_prior_m;
  objects_.clear();
  int num_blocks = 0;
  std::size_t first = 0;
  for (const VemObject& object : window.objects) {
    const int blocks = (object.num_landmarks + kVemLanes - 1) / kVemLanes;
    const bool rigid = object.kind != ClassKind::structure && object.num_landmarks > 0;
    objects_.push_back({num_blocks, blocks, rigid, rigid && tells_yaw(window, first, object.num_landmarks)});
    num_blocks += blocks;
    first += static_cast<std::size_t>(object.num_landmarks);
  }
  const auto blocks = static_cast<std::size_t>(num_blocks), slots = blocks * static_cast<std::size_t>(num_frames_);
  for (auto* quads : {&p_object_, &p_prev_}) quads->assign(3 * blocks, Quad{});
  rigid_weight_.assign(blocks, Quad{});
  prior_weight_.assign(blocks, Quad{{1.0, 1.0, 1.0, 1.0}});  // of a lane without landmark
  p_camera_.assign(3 * slots, Quad{});
  for (auto* quads : {&inverse_variance_, &bias_}) quads->assign(slots, Quad{});
  place_landmarks(window);
  place_matches(window);
  set_least_sigma(0.0);
}

void WindowSheet::place_landmarks(const VemWindow& window) {
  lane_of_landmark_.clear();
  const double prior = 1.0 / (sigma_prior_m_ * sigma_prior_m_);
  const double rigid = 1.0 / (sigma_rigid_m_ * sigma_rigid_m_);
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    for (int i = 0; i < window.objects[object].num_landmarks; ++i) {
      const VemLandmark& landmark = window.landmarks[lane_of_landmark_.size()];
      const int at = objects_[object].first_block * kVemLanes + i;
      lane_of_landmark_.push_back(at);
      lane(prior_weight_, static_cast<std::size_t>(at)) = prior;
      lane(rigid_weight_, static_cast<std::size_t>(at)) = objects_[object].rigid ? rigid : 0.0;
      for (int axis = 0; axis < 3; ++axis) {
        lane(p_prev_, axis_lane(at, axis)) = landmark.p_prev[axis];
        if (objects_[object].rigid) lane(p_object_, axis_lane(at, axis)) = landmark.p_object[axis];
      }
    }
  }
}

void WindowSheet::place_matches(const VemWindow& window) {
  smallest_sigma_ = std::numeric_limits<double>::infinity();
  for (const VemMatch& match : window.matches) {
    const std::size_t at = lane_of_match(match);
    const double variance = match.sigma_m * match.sigma_m;
    lane(inverse_variance_, at) = 1.0 / variance;
    smallest_sigma_ = std::min(smallest_sigma_, match.sigma_m);
    lane(bias_, at) = log_gaussian_peak(dimension_, variance) - log_uniform_;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      lane(p_camera_, (at / kVemLanes * 3 + axis) * kVemLanes + at % kVemLanes) =
          match.p_camera[static_cast<Eigen::Index>(axis)];
    }
  }
}

void WindowSheet::set_least_sigma(double sigma_m) {
  const double variance = sigma_m * sigma_m;
  const bool any = variance > 0.0;
  most_inverse_ = any ? 1.0 / variance : std::numeric_limits<double>::infinity();
  its_bias_ = any ? log_gaussian_peak(dimension_, variance) - log_uniform_ : 0.0;
}

VemNoise WindowSheet::noise(std::size_t object) const {
  const std::size_t first = first_slot(object);
  return {slots_of(object), inverse_variance_.data() + first, bias_.data() + first, most_inverse_, its_bias_};
}

WindowSheet::Noise WindowSheet::noise_at(std::size_t slot, int lane) const {
  const double own = inverse_variance_[slot].lane[lane];
  return own > most_inverse_ ? Noise{most_inverse_, its_bias_} : Noise{own, bias_[slot].lane[lane]};
}

VemEstimate WindowSheet::initial(const VemWindow& window) const {
  VemEstimate estimate;
  estimate.poses = window.poses;
  for (const VemObject& object : window.objects) estimate.objects.push_back({object.position, object.yaw});
  estimate.landmarks.assign(3 * num_blocks(), Quad{});
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    set_landmark(estimate.landmarks, i, window.landmarks[i].p_world);
  }
  estimate.error2.assign(num_slots(), Quad{});
  return estimate;
}

VemBlocks WindowSheet::blocks(std::size_t object, const Quad* information) const {
  const auto first = static_cast<std::size_t>(objects_[object].first_block);
  return {objects_[object].num_blocks,
          num_frames_,
          p_camera_.data() + 3 * first_slot(object),
          information == nullptr ? nullptr : information + first_slot(object),
          p_object_.data() + 3 * first,
          p_prev_.data() + 3 * first,
          prior_weight_.data() + first,
          rigid_weight_.data() + first};
}

std::size_t WindowSheet::first_slot(std::size_t object) const {
  return static_cast<std::size_t>(objects_[object].first_block * num_frames_);
}

std::size_t WindowSheet::lane_of_match(const VemMatch& match) const {
  const int at = lane_of_landmark_[static_cast<std::size_t>(match.landmark)];
  return static_cast<std::size_t>((at / kVemLanes * num_frames_ + match.frame) * kVemLanes + at % kVemLanes);
}

Eigen::Vector3d WindowSheet::landmark(const std::vector<Quad>& landmarks, std::size_t index) const {
  Eigen::Vector3d p;
  for (int axis = 0; axis < 3; ++axis) {
    const std::size_t at = axis_lane(lane_of_landmark_[index], axis);
    p[axis] = landmarks[at / kVemLanes].lane[at % kVemLanes];
  }
  return p;
}

void WindowSheet::set_landmark(std::vector<Quad>& landmarks, std::size_t index, const Eigen::Vector3d& p) const {
  for (int axis = 0; axis < 3; ++axis) lane(landmarks, axis_lane(lane_of_landmark_[index], axis)) = p[axis];
}

}  // namespace povslam
