#include "pipeline/frontend/relocalise.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

namespace povslam {

namespace {
constexpr double kNearlyAsGood = 0.3;  // of the best place's inliers
constexpr double kOneThingAsGood = 0.5;
constexpr int kMinToFind = 15;
constexpr int kTwinsPerCall = 2, kTwinCandidates = 2;
constexpr int kMinTwin = 25;         // landmarks of one place that show in a keyframe of another
constexpr double kKnownShare = 0.5;  // of the expected landmarks: a twin with fewer was not mapped from there
constexpr int kForgiven = 2;         // frames without an answer between two that agree
constexpr double kMoveM = 0.15, kMoveMps = 2.0;
constexpr double kTurnRad = 0.08, kTurnRadps = 2.0;

// Whether the other fit leaves it open which is right. A well known place that shows one thing alone, where the best
// shows others beside it, is where that thing stood before it was carried: it must explain more to count.
bool nearly_as_good(const PlaceFit& other, const PlaceFit& best) {
  const bool known = other.num_expected >= kKnownShare * best.num_expected;
  return other.num_inliers > (other.on_one_thing && known ? kOneThingAsGood : kNearlyAsGood) * best.num_inliers;
}

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

struct Relocaliser::Fits {
  std::array<PlaceFit, 2 * kMaxPlaces + 1> of;
  std::size_t count = 0;
  Answer best;  // as far as a single place tells
};

Relocaliser::Answer Relocaliser::search(const Map& map, PlaceIndex& index, const Frame& frame) {
  const FeatureView view(frame);
  words_.resize(view.size());
  index.vocabulary().words(view.descriptor, words_);
  index.query(words_);
  Fits fits;
  Likeliest likeliest;
  likeliest.fill(kNone);
  const std::int32_t known = map.find_keyframe(std::exchange(favourite_, -1));
  if (known != kNone) {
    const PlaceAround place(map, known);
    for (const std::int32_t near : place.keyframes()) index.leave_out(near);
    verify(map, known, view, fits);
  }
  const bool more = verify_page(map, index, view, fits, likeliest);
  if (fits.best.keyframe == kNone || !believable(fits.best.fit)) {
    page_ = more ? (page_ + 1) % kPages : 0;
    return fits.best;
  }
  // What looks more alike did not fit frames before; whether it fits this one as well is asked all the same.
  for (const std::int32_t slot : likeliest) {
    if (page_ > 0 && slot != kNone) verify(map, slot, view, fits);
  }
  page_ = 0;
  if (!believable(fits.best.fit)) return fits.best;
  favourite_ = map.keyframe(fits.best.keyframe).id;
  Answer best = fits.best;
  const bool rivalled = std::any_of(fits.of.begin(), fits.of.begin() + fits.count, [&best](const PlaceFit& other) {
    return nearly_as_good(other, best.fit) && !same_pose(other.T_camera_world, best.fit.T_camera_world);
  });
  const PlaceAround place(map, best.keyframe);
  best.twins_known = know_twins(map, index, place);
  best.verdict = rivalled || may_be_twin(map, place, view, best.fit) ? Verdict::ambiguous : Verdict::found;
  return best;
}

// Verifies the places of this page; false: there are none after them.
bool Relocaliser::verify_page(const Map& map, PlaceIndex& index, const FeatureView& view, Fits& fits,
                              Likeliest& likeliest) {
  const int first = page_ * kMaxPlaces;
  for (int rank = 0; rank < first + kMaxPlaces; ++rank) {
    const auto likely = index.next();
    if (!likely) return false;
    const PlaceAround place(map, likely->keyframe);
    for (const std::int32_t near : place.keyframes()) index.leave_out(near);
    if (rank < kMaxPlaces) likeliest[static_cast<std::size_t>(rank)] = likely->keyframe;
    if (rank >= first) verify(map, likely->keyframe, view, fits);
  }
  return true;
}

void Relocaliser::verify(const Map& map, std::int32_t keyframe, const FeatureView& view, Fits& fits) {
  ++fits.best.places_tried;
  const auto fit = verifier_.verify(map, PlaceAround(map, keyframe).keyframes(), view);
  if (!fit) return;
  fits.of[fits.count++] = *fit;
  if (fits.best.keyframe != kNone && fit->num_inliers <= fits.best.fit.num_inliers) return;
  fits.best.keyframe = keyframe;
  fits.best.fit = *fit;
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
    if (!known || nearly_as_good(as_twin, fit)) return true;
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
