#include "pipeline/frontend/relocalise.hpp"

#include <algorithm>
#include <cmath>

namespace povslam {

namespace {
constexpr double kNearlyAsGood = 0.3;  // of the best place's inliers
constexpr int kMinToFind = 15;
constexpr int kTwinsPerCall = 2, kTwinCandidates = 2;
constexpr int kMinTwin = 25;         // landmarks of one place that show in a keyframe of another
constexpr double kKnownShare = 0.5;  // of the expected landmarks: a twin with fewer was not mapped from there
constexpr int kForgiven = 2;         // frames without an answer between two that agree
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
  twins_.resize(static_cast<std::size_t>(options.map.max_keyframes));
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
  const PlaceAround place(map, best.keyframe);
  best.twins_known = know_twins(map, index, place);
  best.verdict = rivalled || may_be_twin(map, place, view, best.fit) ? Verdict::ambiguous : Verdict::found;
  return best;
}

// Some keyframes a call; true once all of the place were looked at. What is known stays known until the map grows.
bool Relocaliser::know_twins(const Map& map, PlaceIndex& index, const PlaceAround& place) {
  int looked = 0;
  for (const std::int32_t slot : place.keyframes()) {
    const Twin& twin = twins_[static_cast<std::size_t>(slot)];
    if (twin.of == map.keyframe(slot).id && twin.among == map.next_keyframe_id()) continue;
    if (looked++ == kTwinsPerCall) return false;
    look_for_twin(map, index, slot);
  }
  return true;
}

void Relocaliser::look_for_twin(const Map& map, PlaceIndex& index, std::int32_t slot) {
  const Keyframe& kf = map.keyframe(slot);
  Twin& twin = twins_[static_cast<std::size_t>(slot)];
  twin = {kf.id, map.next_keyframe_id(), -1, {}};
  index.query(kf.word);
  const PlaceAround here(map, slot);
  for (const std::int32_t near : here.keyframes()) index.leave_out(near);
  for (int tried = 0; tried < kTwinCandidates; ++tried) {
    const auto likely = index.next();
    if (!likely) return;
    const PlaceAround there(map, likely->keyframe);
    for (const std::int32_t near : there.keyframes()) index.leave_out(near);
    const auto fit = verifier_.verify(map, there.keyframes(), FeatureView(kf));
    if (!fit || fit->num_inliers < kMinTwin || same_pose(fit->T_camera_world, kf.T_world_camera.inverse())) continue;
    twin.keyframe = map.keyframe(likely->keyframe).id;
    twin.T_twin_world = fit->T_camera_world.inverse() * kf.T_world_camera.inverse();
    return;
  }
}

// Whether the frame may as well show a twin of the place: one that is not known from there, or fits as well.
bool Relocaliser::may_be_twin(const Map& map, const PlaceAround& place, const FeatureView& view, const PlaceFit& fit) {
  for (const std::int32_t slot : place.keyframes()) {
    const Twin& twin = twins_[static_cast<std::size_t>(slot)];
    const std::int32_t other = twin.of == map.keyframe(slot).id ? map.find_keyframe(twin.keyframe) : kNone;
    if (other == kNone) continue;
    const PlaceAround there(map, other);
    const PlaceFit as_twin =
        verifier_.explain(map, there.keyframes(), view, fit.T_camera_world * twin.T_twin_world.inverse());
    const bool known = as_twin.num_expected >= kKnownShare * fit.num_expected;
    if (!known || as_twin.num_inliers > kNearlyAsGood * fit.num_inliers) return true;
  }
  return false;
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
  return agreeing_ >= kFrames && answer.twins_known;
}

}  // namespace povslam
