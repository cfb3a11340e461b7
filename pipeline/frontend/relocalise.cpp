#include "pipeline/frontend/relocalise.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {
constexpr double kNearlyAsGood = 0.3;  // of the best place's inliers
constexpr int kMinToFind = 15;
constexpr int kForgiven = 2;  // frames without an answer between two that agree
constexpr double kMoveM = 0.15, kMoveMps = 2.0;
constexpr double kTurnRad = 0.08, kTurnRadps = 2.0;
}  // namespace

PlaceAround::PlaceAround(const Map& map, std::int32_t slot) {
  keyframes_[size_++] = slot;
  const Keyframe& kf = map.keyframe(slot);
  for (int c = 0; c < kf.num_covisible && size_ < kMaxPlaceKeyframes; ++c) {
    keyframes_[size_++] = kf.covisible[static_cast<std::size_t>(c)].keyframe;
  }
}

Relocaliser::Relocaliser(const PinholeCamera& camera, const FrontendOptions& options) : verifier_(camera, options) {
  words_.reserve(static_cast<std::size_t>(options.orb.num_features));
}

Relocaliser::Answer Relocaliser::search(const Map& map, PlaceIndex& index, const Frame& frame) {
  const FeatureView view(frame);
  words_.resize(view.size());
  index.vocabulary().words(view.descriptor, words_);
  index.query(words_);
  Answer best;
  std::array<PlaceFit, kMaxPlaces> fits;
  std::size_t num_fits = 0;
  while (best.places_tried < kMaxPlaces) {
    const auto likely = index.next();
    if (!likely) break;
    const PlaceAround place(map, likely->keyframe);
    for (const std::int32_t near : place.keyframes()) index.leave_out(near);
    ++best.places_tried;
    const auto fit = verifier_.verify(map, place.keyframes(), view);
    if (!fit) continue;
    fits[num_fits++] = *fit;
    if (best.keyframe != kNone && fit->num_inliers <= best.fit.num_inliers) continue;
    best.keyframe = likely->keyframe;
    best.fit = *fit;
  }
  if (best.keyframe == kNone || !believable(best.fit)) return best;
  const bool rivalled = std::any_of(fits.begin(), fits.begin() + num_fits, [&best](const PlaceFit& other) {
    return other.num_inliers > kNearlyAsGood * best.fit.num_inliers &&
           !same_pose(other.T_camera_world, best.fit.T_camera_world);
  });
  best.verdict = rivalled ? Verdict::ambiguous : Verdict::found;
  return best;
}

std::optional<Relocaliser::Found> Relocaliser::against(const Map& map, std::int32_t keyframe, const Frame& frame) {
  const auto fit = verifier_.verify(map, std::span(&keyframe, 1), FeatureView(frame));
  if (!fit || fit->num_inliers < kMinToFind) return std::nullopt;
  return Found{fit->T_camera_world, fit->num_inliers};
}

bool Agreement::add(const Relocaliser::Answer& answer, TimeNs stamp) {
  if (answer.verdict == Relocaliser::Verdict::unknown) {
    if (++missed_ > kForgiven) forget();
    return false;
  }
  if (answer.verdict == Relocaliser::Verdict::ambiguous) {
    forget();
    return false;
  }
  const Rigid3 moved = answer.fit.T_camera_world * T_camera_world_.inverse();
  const double passed_s = std::abs(to_seconds(stamp - stamp_));
  const bool agrees = agreeing_ > 0 && moved.translation.norm() < kMoveM + kMoveMps * passed_s &&
                      rotation_angle_rad(moved) < kTurnRad + kTurnRadps * passed_s;
  agreeing_ = agrees ? agreeing_ + 1 : 1;
  missed_ = 0;
  stamp_ = stamp;
  T_camera_world_ = answer.fit.T_camera_world;
  return agreeing_ >= kFrames;
}

}  // namespace povslam
