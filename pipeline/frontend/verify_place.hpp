// Does this view show that place of the map, and from where? For being found again and for closing loops.
//   1. looks of the place's landmarks against the view's features, without any prediction
//   2. a pose by RANSAC (PoseRansac)
//   3. all landmarks of the place projected with it: those that should be seen are looked for where they should be,
//      in pixels and depth. One whose surface the view sees through speaks against the place.
// Bounded work (about 3 ms), no allocation after construction; the same input gives the same answer.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/frontend/feature_grid.hpp"
#include "pipeline/frontend/feature_view.hpp"
#include "pipeline/frontend/look_matcher.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/pose_ransac.hpp"
#include "pipeline/frontend/thing_count.hpp"

namespace povslam {

inline constexpr std::size_t kMaxPlaceKeyframes = 12;

struct PlaceFit {
  Rigid3 T_camera_world;     // of the view, in the world as this place knows it
  int num_pairs = 0;         // looks that resemble, before any geometry
  int num_inliers = 0;       // landmarks found where the pose puts them, in pixels and depth
  int num_expected = 0;      // that it should have seen, found or not; not those hidden, nor where the view is blank…
  int num_possible = 0;      // …and with those that it might have, from far aside
  int num_contradicted = 0;  // of these, seen through
  int num_cells = 0;         // of 8 x 6 over the image that hold inliers
  int num_expected_cells = 0;  // that should: several landmarks are expected there…
  int num_missed_cells = 0;    // …and of these, that hold none
  double thinnest = 0.0;       // standard deviation of the inliers along their short axis, in widths of the image
  bool on_one_thing = false;   // see ThingCount
  int num_rival = 0;           // inliers of another pose (see same_pose) at this place, 0: none
  double share() const { return num_expected > 0 ? static_cast<double>(num_inliers) / num_expected : 0.0; }
  double possible_share() const { return num_possible > 0 ? static_cast<double>(num_inliers) / num_possible : 0.0; }
};

// Within 0.3 m and 5 degrees.
bool same_pose(const Rigid3& T_camera_world_a, const Rigid3& T_camera_world_b);

// Whether the fit alone is enough to believe it: inliers, share, spread, contradictions, no rival as good, and more
// than one object, or structure, says so: a camera that was carried sees one thing as it would if the thing had been.
bool believable(const PlaceFit& fit);

class PlaceVerifier {
 public:
  PlaceVerifier(const PinholeCamera& camera, const FrontendOptions& options);

  // place: slots of keyframes that see one another's landmarks, the likeliest first; more than kMaxPlaceKeyframes are
  // not looked at. Nothing when no pose agrees with enough of the view.
  std::optional<PlaceFit> verify(const Map& map, std::span<const std::int32_t> place, const FeatureView& view);

  // What the place would explain of the view if it were seen from there; the pose is refined where it can be.
  PlaceFit explain(const Map& map, std::span<const std::int32_t> place, const FeatureView& view,
                   const Rigid3& T_camera_world);

  using Pair = FeatureOfLandmark;
  std::span<const Pair> pairs() const { return pairs_; }  // the inliers of the last fit

 private:
  PlaceFit search_guided(const Map& map, const FeatureView& view, const Rigid3& T_camera_world);
  struct Expected {
    std::int32_t landmark = -1;
    Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
    float u_px = 0.0F, v_px = 0.0F;
    int level = 0;
    bool sure = true;  // else seen from so far aside that it may look otherwise, or be behind something
  };
  void expect(const Map& map, const Rigid3& T_camera_world);
  void find_expected(const Map& map, const FeatureView& view, float radius_px);
  bool solve_found(const Map& map, const FeatureView& view, Rigid3& T_camera_world);
  void count(const Map& map, const FeatureView& view, PlaceFit& fit);
  enum class Surface { there, hidden, seen_through };
  Surface surface_at(const FeatureView& view, const Expected& expected) const;
  static constexpr int kColumns = 8, kRows = 6;
  using Cells = std::array<int, kColumns * kRows>;
  Cells count_features(const FeatureView& view) const;
  std::size_t cell_of(float x_px, float y_px) const;
  void describe_spread(const FeatureView& view, PlaceFit& fit) const;
  PoseObservation observe(const Map& map, const FeatureView& view, std::size_t feature, std::int32_t landmark) const;
  int rival_of(const Map& map, const FeatureView& view, const PlaceFit& fit);

  PinholeCamera camera_;
  double log_scale_;
  int num_levels_;
  LookMatcher looks_;
  PoseRansac ransac_;
  ThingCount things_;
  FeatureGrid grid_;  // of the view
  std::int64_t mark_ = 0;
  std::vector<std::int64_t> marked_;    // by landmark slot
  std::vector<std::int32_t> taken_by_;  // by feature: what shows there, and how closely
  std::vector<int> taken_distance_;
  std::vector<Expected> expected_;
  std::vector<PoseObservation> observations_;
  std::vector<Pair> observed_;  // of each observation
  std::vector<Pair> pairs_, rival_pairs_;
};

}  // namespace povslam
