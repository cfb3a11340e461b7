#include "pipeline/frontend/verify_place.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace povslam {

namespace {
constexpr int kMinPairs = 12;
constexpr int kGuidedDistance = 75;                           // bits
constexpr float kFirstRadiusPx = 8.0F, kLastRadiusPx = 4.0F;  // on the predicted level
constexpr double kFloorSigmaPx = 1.0;                         // the map has errors of its own, on level 0
constexpr double kMaxViewChangeCos = 0.45;  // from farther aside a landmark may look otherwise: a floor does not
constexpr double kNearestM = 0.1;
constexpr float kNeighbourPx = 10.0F;  // whose depth tells what surface is there

// What makes a fit believable.
constexpr int kMinInliers = 40;
constexpr double kMinShare = 0.07;          // of the expected…
constexpr double kMinPossibleShare = 0.05;  // …and of the possible landmarks
constexpr double kMinStrength = 6.0;        // inliers times that share: few must be most of what is possible
constexpr double kMaxMissed = 0.4;          // of the cells in which landmarks are expected
constexpr double kMaxContradicted = 0.5;    // of inliers
constexpr int kMinCells = 6;
constexpr double kMinThinnest = 0.03;
constexpr double kRivalShare = 0.2;  // of the inliers; where nothing repeats and nothing moved it is 0
constexpr double kSameM = 0.3, kSameRad = 5.0 * 3.14159265358979 / 180.0;
constexpr int kManyInCell = 8;  // landmarks expected
constexpr int kFewInCell = 4;   // features: with fewer the view shows nothing there that would tell
}  // namespace

bool same_pose(const Rigid3& a, const Rigid3& b) {
  const Rigid3 T_camera_a_camera_b = a * b.inverse();
  return T_camera_a_camera_b.translation.norm() <= kSameM && rotation_angle_rad(T_camera_a_camera_b) <= kSameRad;
}

bool believable(const PlaceFit& fit) {
  return fit.num_inliers >= kMinInliers && fit.share() >= kMinShare &&
         fit.num_inliers * fit.possible_share() >= kMinStrength && fit.possible_share() >= kMinPossibleShare &&
         fit.num_missed_cells <= kMaxMissed * fit.num_expected_cells &&
         fit.num_contradicted <= kMaxContradicted * fit.num_inliers && fit.num_cells >= kMinCells &&
         fit.thinnest >= kMinThinnest && fit.num_rival <= kRivalShare * fit.num_inliers && !fit.on_one_thing;
}

PlaceVerifier::PlaceVerifier(const PinholeCamera& camera, const FrontendOptions& options)
    : camera_(camera),
      log_scale_(std::log(options.orb.scale_factor)),
      num_levels_(options.orb.num_levels),
      looks_(options),
      ransac_(camera, LookMatcher::kMaxMatched),
      things_(static_cast<std::size_t>(options.orb.num_features)),
      grid_(options.orb.num_features, -0.25F * static_cast<float>(camera.width),
            -0.25F * static_cast<float>(camera.height), 1.25F * static_cast<float>(camera.width),
            1.25F * static_cast<float>(camera.height)) {
  const std::size_t features = static_cast<std::size_t>(options.orb.num_features);
  marked_.resize(static_cast<std::size_t>(options.map.max_landmarks));
  taken_by_.resize(features);
  taken_distance_.resize(features);
  expected_.reserve(LookMatcher::kMaxLandmarks);
  observations_.reserve(std::max(features, LookMatcher::kMaxMatched));
  observed_.reserve(features);
  pairs_.reserve(features);
  rival_pairs_.reserve(features);
}

std::optional<PlaceFit> PlaceVerifier::verify(const Map& map, std::span<const std::int32_t> place,
                                              const FeatureView& view) {
  pairs_.clear();
  looks_.match(map, place.first(std::min(place.size(), kMaxPlaceKeyframes)), view);
  if (looks_.pairs().size() < static_cast<std::size_t>(kMinPairs)) return std::nullopt;
  observations_.clear();
  for (const Pair& pair : looks_.pairs()) {
    observations_.push_back(observe(map, view, static_cast<std::size_t>(pair.feature), pair.landmark));
  }
  const auto start = ransac_.find(observations_, kMinPairs);
  if (!start) return std::nullopt;
  grid_.build(view.x, view.y);
  PlaceFit fit = search_guided(map, view, *start);
  fit.num_pairs = static_cast<int>(looks_.pairs().size());
  if (believable(fit)) fit.num_rival = rival_of(map, view, fit);
  return fit;
}

PlaceFit PlaceVerifier::explain(const Map& map, std::span<const std::int32_t> place, const FeatureView& view,
                                const Rigid3& T_camera_world) {
  looks_.match(map, place.first(std::min(place.size(), kMaxPlaceKeyframes)), view);
  grid_.build(view.x, view.y);
  PlaceFit fit = search_guided(map, view, T_camera_world);
  if (fit.num_inliers == 0) {  // too few were found for a pose; that they were expected counts all the same
    fit.num_expected = static_cast<int>(std::ranges::count_if(expected_, &Expected::sure));
  }
  return fit;
}

PoseObservation PlaceVerifier::observe(const Map& map, const FeatureView& view, std::size_t f,
                                       std::int32_t landmark) const {
  PoseObservation o;
  o.p_world = map.landmark(landmark).p_world;
  o.u_px = view.x[f];
  o.v_px = view.y[f];
  const double sigma_px = std::max<double>(view.sigma_px[f], kFloorSigmaPx * map.level_scale(view.level[f]));
  o.weight_px = 1.0 / (sigma_px * sigma_px);
  if (view.inverse_depth[f] > 0.0F && view.sigma_inverse_depth[f] > 0.0F) {
    const double sigma_d = view.sigma_inverse_depth[f];
    o.inverse_depth_per_m = view.inverse_depth[f];
    o.weight_inverse_depth = 0.5 / (sigma_d * sigma_d);  // the landmark's own depth was measured likewise
  }
  return o;
}

PlaceFit PlaceVerifier::search_guided(const Map& map, const FeatureView& view, const Rigid3& T_camera_world) {
  PlaceFit fit;
  fit.T_camera_world = T_camera_world;
  pairs_.clear();
  for (const float radius_px : {kFirstRadiusPx, kLastRadiusPx}) {
    expect(map, fit.T_camera_world);
    find_expected(map, view, radius_px);
    if (!solve_found(map, view, fit.T_camera_world)) return fit;
  }
  count(map, view, fit);
  describe_spread(view, fit);
  things_.clear();
  for (const Pair& pair : pairs_) things_.add(map.landmark(pair.landmark).owner);
  fit.on_one_thing = things_.hangs_on_one();
  return fit;
}

// Landmarks of the place that lie in the image, near enough to how they were seen.
void PlaceVerifier::expect(const Map& map, const Rigid3& T_camera_world) {
  expected_.clear();
  const Eigen::Matrix3d R = T_camera_world.matrix3();
  const Eigen::Vector3d p_world_camera = T_camera_world.inverse().translation;
  for (const std::int32_t slot : looks_.landmarks()) {
    const Landmark& point = map.landmark(slot);
    const Eigen::Vector3d p = R * point.p_world + T_camera_world.translation;
    if (!(p.z() > kNearestM)) continue;
    const double u = camera_.fx * p.x() / p.z() + camera_.cx, v = camera_.fy * p.y() / p.z() + camera_.cy;
    if (!camera_.contains({u, v})) continue;
    const Eigen::Vector3d toward = p_world_camera - point.p_world;
    const double distance = toward.norm();
    const bool sure = toward.dot(point.toward_camera) >= kMaxViewChangeCos * distance;
    const double level = point.reference_level + std::log(point.reference_distance_m / distance) / log_scale_;
    if (!(level > -1.5 && level < num_levels_ + 0.5)) continue;
    expected_.push_back(
        {slot, p, static_cast<float>(u), static_cast<float>(v), static_cast<int>(std::lround(level)), sure});
  }
}

void PlaceVerifier::find_expected(const Map& map, const FeatureView& view, float radius_px) {
  std::fill_n(taken_by_.begin(), view.size(), kNone);
  std::fill_n(taken_distance_.begin(), view.size(), 257);
  for (std::size_t e = 0; e < expected_.size(); ++e) {
    const Expected& expected = expected_[e];
    const float radius = radius_px * map.level_scale(std::clamp(expected.level, 0, num_levels_ - 1));
    const Descriptor& look = map.landmark(expected.landmark).descriptor;
    int best_distance = kGuidedDistance + 1;
    std::size_t best = 0;
    grid_.for_each_near(expected.u_px, expected.v_px, radius, [&](std::int32_t i) {
      const std::size_t f = static_cast<std::size_t>(i);
      if (std::abs(view.level[f] - expected.level) > 1) return;
      if (std::abs(view.x[f] - expected.u_px) > radius || std::abs(view.y[f] - expected.v_px) > radius) return;
      const int distance = hamming_distance(look, view.descriptor[f]);
      if (distance < best_distance) best_distance = distance, best = f;
    });
    if (best_distance > kGuidedDistance || best_distance >= taken_distance_[best]) continue;
    taken_distance_[best] = best_distance;
    taken_by_[best] = static_cast<std::int32_t>(e);
  }
}

bool PlaceVerifier::solve_found(const Map& map, const FeatureView& view, Rigid3& T_camera_world) {
  observations_.clear();
  observed_.clear();
  for (std::size_t f = 0; f < view.size(); ++f) {
    if (taken_by_[f] == kNone) continue;
    const std::int32_t landmark = expected_[static_cast<std::size_t>(taken_by_[f])].landmark;
    observations_.push_back(observe(map, view, f, landmark));
    observed_.push_back({static_cast<std::int32_t>(f), landmark});
  }
  PoseSolverOptions options;
  options.first_gate = 4.0;
  const PoseSolution solution = solve_pose(camera_, T_camera_world, observations_, options);
  if (!solution.converged || solution.num_inliers < kMinPairs) return false;
  T_camera_world = solution.T_camera_world;
  return true;
}

void PlaceVerifier::count(const Map& map, const FeatureView& view, PlaceFit& fit) {
  const std::int64_t found = ++mark_;
  for (std::size_t o = 0; o < observations_.size(); ++o) {
    const PoseObservation& seen = observations_[o];
    if (!seen.fits || !PoseRansac::agrees(camera_, seen, fit.T_camera_world * seen.p_world, false)) continue;
    pairs_.push_back(observed_[o]);
    marked_[static_cast<std::size_t>(observed_[o].landmark)] = found;
  }
  fit.num_inliers = static_cast<int>(pairs_.size());
  expect(map, fit.T_camera_world);
  const Cells features_in = count_features(view);
  Cells expected_in{}, found_in{};
  for (const Expected& expected : expected_) {
    const bool is_found = marked_[static_cast<std::size_t>(expected.landmark)] == found;
    const Surface surface = is_found ? Surface::there : surface_at(view, expected);
    const std::size_t cell = cell_of(expected.u_px, expected.v_px);
    const bool blank = features_in[cell] < kFewInCell && !is_found && surface == Surface::there;
    if (surface == Surface::hidden || blank) continue;
    ++fit.num_possible;
    if (!is_found && !expected.sure) continue;
    ++fit.num_expected;
    ++expected_in[cell];
    found_in[cell] += is_found ? 1 : 0;
    fit.num_contradicted += surface == Surface::seen_through ? 1 : 0;
  }
  for (std::size_t cell = 0; cell < expected_in.size(); ++cell) {
    if (expected_in[cell] < kManyInCell) continue;
    ++fit.num_expected_cells;
    if (found_in[cell] == 0) ++fit.num_missed_cells;
  }
}

PlaceVerifier::Cells PlaceVerifier::count_features(const FeatureView& view) const {
  Cells count{};
  for (std::size_t f = 0; f < view.size(); ++f) {
    if (camera_.contains({view.x[f], view.y[f]})) ++count[cell_of(view.x[f], view.y[f])];
  }
  return count;
}

// What the depth of the features around tells.
PlaceVerifier::Surface PlaceVerifier::surface_at(const FeatureView& view, const Expected& expected) const {
  int nearer = 0, farther = 0, same = 0;
  const double inverse = 1.0 / expected.p_camera.z();
  grid_.for_each_near(expected.u_px, expected.v_px, kNeighbourPx, [&](std::int32_t i) {
    const std::size_t f = static_cast<std::size_t>(i);
    if (!(view.inverse_depth[f] > 0.0F)) return;
    if (std::hypot(view.x[f] - expected.u_px, view.y[f] - expected.v_px) > kNeighbourPx) return;
    const double clearly = 6.0 * view.sigma_inverse_depth[f] + 0.1 * inverse, off = view.inverse_depth[f] - inverse;
    ++(off > clearly ? nearer : off < -clearly ? farther : same);
  });
  if (same > 0 || nearer + farther == 0) return Surface::there;
  return nearer > 0 ? Surface::hidden : Surface::seen_through;
}

std::size_t PlaceVerifier::cell_of(float x_px, float y_px) const {
  const int column = static_cast<int>(x_px * kColumns / static_cast<float>(camera_.width));
  const int row = static_cast<int>(y_px * kRows / static_cast<float>(camera_.height));
  return static_cast<std::size_t>(std::clamp(row, 0, kRows - 1) * kColumns + std::clamp(column, 0, kColumns - 1));
}

void PlaceVerifier::describe_spread(const FeatureView& view, PlaceFit& fit) const {
  std::uint64_t cells = 0;
  Eigen::Vector2d mean = Eigen::Vector2d::Zero();
  Eigen::Matrix2d square = Eigen::Matrix2d::Zero();
  for (const Pair& pair : pairs_) {
    const std::size_t f = static_cast<std::size_t>(pair.feature);
    const Eigen::Vector2d p(view.x[f], view.y[f]);
    mean += p;
    square += p * p.transpose();
    cells |= std::uint64_t{1} << cell_of(view.x[f], view.y[f]);
  }
  fit.num_cells = std::popcount(cells);
  if (pairs_.empty()) return;
  const double n = static_cast<double>(pairs_.size());
  mean /= n;
  const Eigen::Matrix2d C = square / n - mean * mean.transpose();
  const double half_trace = 0.5 * C.trace();
  const double root = std::sqrt(std::max(0.0, half_trace * half_trace - C.determinant()));
  fit.thinnest = std::sqrt(std::max(0.0, half_trace - root)) / camera_.width;
}

// Repeated structure gives looks that fit another pose as well: what is left over without those that fit this one, and
// what looks the same elsewhere.
int PlaceVerifier::rival_of(const Map& map, const FeatureView& view, const PlaceFit& fit) {
  observations_.clear();
  for (const std::span<const Pair> pairs : {looks_.pairs(), looks_.doubles()}) {
    for (const Pair& pair : pairs) {
      const PoseObservation o = observe(map, view, static_cast<std::size_t>(pair.feature), pair.landmark);
      if (!PoseRansac::agrees(camera_, o, fit.T_camera_world * o.p_world, true)) observations_.push_back(o);
    }
  }
  if (observations_.size() < static_cast<std::size_t>(kMinPairs)) return 0;
  const auto other = ransac_.find(observations_, kMinPairs);
  if (!other || same_pose(*other, fit.T_camera_world)) return 0;
  std::swap(pairs_, rival_pairs_);
  const PlaceFit rival = search_guided(map, view, *other);
  std::swap(pairs_, rival_pairs_);
  return same_pose(rival.T_camera_world, fit.T_camera_world) ? 0 : rival.num_inliers;
}

}  // namespace povslam
