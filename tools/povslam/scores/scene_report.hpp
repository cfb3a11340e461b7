// Figures of what a run reported about a changing scene, as JSON. Counts stand beside every ratio, so that runs can be
// pooled by summing them.
#pragma once

#include <nlohmann/json.hpp>
#include <optional>
#include <string>

#include "tools/povslam/scores/visibility.hpp"
#include "tools/povslam/scores/voxel_score.hpp"

namespace povslam::scores {

enum class Arrangement : std::uint8_t { before, after };  // of the objects: before or after the change

struct SceneReportOptions {
  double max_distance_m = 0.5;  // events
  double close_m = 0.1;         // a moved box found again
  std::size_t min_frames = 10;  // a place or object seen in fewer frames is not asked for
  double touch_gap_m = 0.02;    // boxes no further apart count as one
  double min_iou = 0.5;         // objects
  Arrangement arrangement = Arrangement::after;
  double voxel_size_m = 0.2;
  double floor_z_m = 0.0;  // in the truth's world
};

// sightings: nothing = not known, then every true object and place is asked for.
// T_truth_estimate brings the run's world onto the truth's (first pose fixed).
nlohmann::ordered_json report_events(const SceneTruth& truth, const Sightings* sightings,
                                     const std::vector<ReportedEvent>& events, const Rigid3& T_truth_estimate,
                                     const SceneReportOptions& options);
// Of the moves reported: how many stand where they were said to, within close_m, when told and, by `objects` of the
// same ids, at the end; of all, and of those of which two sides that meet were seen at the new place.
nlohmann::ordered_json report_moved(const SceneTruth& truth, const Sightings* sightings,
                                    const std::vector<ReportedEvent>& events,
                                    const std::vector<ReportedObject>& objects, const Rigid3& T_truth_estimate,
                                    const SceneReportOptions& options);
nlohmann::ordered_json report_objects(const SceneTruth& truth, const Sightings* sightings,
                                      const std::vector<ReportedObject>& objects, const Rigid3& T_truth_estimate,
                                      const SceneReportOptions& options);

// surface_frames: per truth point, in how many frames of the last lap it was seen (up to kMaxPointFrames).
Result<nlohmann::ordered_json> report_voxels(const PlyMesh& true_surface,
                                             const std::vector<std::size_t>& surface_frames, const PlyMesh& map,
                                             const Rigid3& T_truth_estimate, const SceneReportOptions& options);
// reference: a map made with true poses, as the paper took it.
Result<nlohmann::ordered_json> report_voxels_against_map(const PlyMesh& reference, const PlyMesh& map,
                                                         const Rigid3& T_truth_estimate,
                                                         const SceneReportOptions& options);

// Adds the ratios that belong to the counts of a section ("events", "objects" or a voxel section).
void add_ratios(nlohmann::ordered_json& section);

}  // namespace povslam::scores
