#include "pipeline/frontend/triangulate.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/frontend/match.hpp"

namespace povslam {

namespace {
constexpr int kNeighbours = 4;  // covisible keyframes tried
constexpr double kMinBaselineM = 0.05;
constexpr double kMaxLineDistance = 2.0;     // in standard deviations of the feature's place
constexpr double kMinParallaxCos = 0.99985;  // one degree: less, and the depth is a guess
constexpr double kNearestM = 0.1;
constexpr double kChi2 = 5.991;  // 2 dof, 95 %
}  // namespace

Triangulator::Triangulator(const PinholeCamera& camera, const FrontendOptions& options) : camera_(camera) {
  open_.reserve(static_cast<std::size_t>(options.orb.num_features));
  made_.reserve(static_cast<std::size_t>(options.orb.num_features));
}

Eigen::Vector3d Triangulator::ray(const Keyframe& keyframe, int feature) const {
  const std::size_t k = static_cast<std::size_t>(feature);
  return {(keyframe.x[k] - camera_.cx) / camera_.fx, (keyframe.y[k] - camera_.cy) / camera_.fy, 1.0};
}

bool Triangulator::fits(const Keyframe& keyframe, int feature, const Eigen::Vector3d& p_world) const {
  const Eigen::Vector3d p = keyframe.T_world_camera.inverse() * p_world;
  if (p.z() < kNearestM) return false;
  const std::size_t k = static_cast<std::size_t>(feature);
  const double du = camera_.fx * p.x() / p.z() + camera_.cx - keyframe.x[k];
  const double dv = camera_.fy * p.y() / p.z() + camera_.cy - keyframe.y[k];
  return du * du + dv * dv < kChi2 * keyframe.sigma_px[k] * keyframe.sigma_px[k];
}

// The open feature near the line whose look is closest, if it stands out. line: in rays of the other keyframe.
int Triangulator::find_along_line(const Keyframe& other, const Eigen::Vector3d& line, int level,
                                  const Descriptor& descriptor) const {
  const double per_px = line.head<2>().norm() / camera_.fx;
  int best = -1, best_distance = 257, second_distance = 257;
  for (const std::int32_t j : open_) {
    const std::size_t k = static_cast<std::size_t>(j);
    if (std::abs(static_cast<int>(other.level[k]) - level) > 1) continue;
    if (std::abs(line.dot(ray(other, j))) > kMaxLineDistance * other.sigma_px[k] * per_px) continue;
    const int distance = hamming_distance(descriptor, other.descriptor[k]);
    if (distance < best_distance) {
      second_distance = best_distance;
      best_distance = distance;
      best = j;
    } else {
      second_distance = std::min(second_distance, distance);
    }
  }
  const bool stands_out = best_distance <= kMaxDistanceFar && best_distance < kNearestRatio * second_distance;
  return stands_out ? best : -1;
}

void Triangulator::with(Map& map, std::int32_t slot, std::int32_t other_slot) {
  Keyframe& kf = map.keyframe(slot);
  Keyframe& other = map.keyframe(other_slot);
  const Rigid3 T_other_kf = other.T_world_camera.inverse() * kf.T_world_camera;
  if (T_other_kf.translation.norm() < kMinBaselineM) return;
  open_.clear();
  for (int j = 0; j < static_cast<int>(other.x.size()); ++j) {
    const std::size_t k = static_cast<std::size_t>(j);
    if (other.landmark[k] == kNone && other.inverse_depth[k] == 0.0F) open_.push_back(j);
  }
  const Eigen::Matrix3d R = T_other_kf.matrix3();
  const Eigen::Matrix3d essential = skew(T_other_kf.translation) * R;
  for (int i = 0; i < static_cast<int>(kf.x.size()); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    if (kf.landmark[k] != kNone || kf.inverse_depth[k] > 0.0F) continue;
    const Eigen::Vector3d r = ray(kf, i);
    const int j = find_along_line(other, essential * r, kf.level[k], kf.descriptor[k]);
    if (j < 0) continue;
    // s r + t = u q, by least squares over s and u.
    const Eigen::Vector3d a = R * r, q = ray(other, j), t = T_other_kf.translation;
    if (a.dot(q) > kMinParallaxCos * a.norm() * q.norm()) continue;
    const double aa = a.dot(a), aq = a.dot(q), qq = q.dot(q);
    const double s = (aq * t.dot(q) - qq * t.dot(a)) / (aa * qq - aq * aq);
    if (!(s > kNearestM)) continue;
    const Eigen::Vector3d p_world = kf.T_world_camera * (s * r);
    if (!fits(kf, i, p_world) || !fits(other, j, p_world)) continue;
    const std::int32_t landmark = map.create_landmark(slot, i, p_world);
    if (landmark == kNone) return;
    map.add_sighting(landmark, other_slot, j);
    open_.erase(std::find(open_.begin(), open_.end(), j));
    made_.push_back({landmark, i});
  }
}

const std::vector<Triangulator::Made>& Triangulator::create(Map& map, std::int32_t keyframe) {
  made_.clear();
  const Keyframe& kf = map.keyframe(keyframe);
  for (int c = 0; c < std::min(kf.num_covisible, kNeighbours); ++c) {
    with(map, keyframe, kf.covisible[static_cast<std::size_t>(c)].keyframe);
  }
  return made_;
}

}  // namespace povslam
