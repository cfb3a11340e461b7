#include "tools/povslam/scores/scene_report.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "tools/povslam/scores/event_score.hpp"
#include "tools/povslam/scores/moved_score.hpp"
#include "tools/povslam/scores/object_score.hpp"

namespace povslam::scores {
namespace {

using Json = nlohmann::ordered_json;

constexpr double kDegPerRad = 180.0 / std::numbers::pi;

// Of an upright box only the turn about z is kept: both worlds are level.
OrientedBox moved(const Rigid3& T, const OrientedBox& box) {
  const Eigen::Vector3d forward = T.rotation * Eigen::Vector3d(std::cos(box.yaw_rad), std::sin(box.yaw_rad), 0.0);
  return {T * box.center_world, box.size_m, std::atan2(forward.y(), forward.x())};
}

enum class Asked : std::uint8_t { what_shows, what_can_be_known };

// What shows: a place that is empty now, a thing that stands there now. That something changed can be known of a thing
// that went only if it was seen before; of one that came, if its place was seen empty before, or if it can be known to
// have gone from where it stood.
std::vector<PlaceChange> true_changes(const SceneTruth& truth, const Sightings* sightings, std::size_t min_frames,
                                      Asked asked) {
  std::vector<PlaceChange> changes;
  const bool known = sightings != nullptr && sightings->have_instances;
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const TrueObject& object = truth.objects[i];
    if (!object.changed) continue;
    const ObjectSightings seen = known ? sightings->objects[i] : ObjectSightings{};
    const bool any = asked == Asked::what_shows;
    const bool went = object.before && seen.old_place_after >= min_frames && (any || seen.object_before >= min_frames);
    const bool came = seen.object_after >= min_frames && (any || went || seen.new_place_before >= min_frames);
    if (object.before) changes.push_back({Fate::gone, object.class_name, *object.before, !known || went});
    if (object.after) changes.push_back({Fate::came, object.class_name, *object.after, !known || came});
  }
  return changes;
}

std::vector<ScoredObject> true_objects(const SceneTruth& truth, const Sightings* sightings,
                                       const SceneReportOptions& options) {
  std::vector<ScoredObject> objects;
  const bool known = sightings != nullptr && sightings->have_instances;
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const bool before = options.arrangement == Arrangement::before;
    const std::optional<OrientedBox>& box = before ? truth.objects[i].before : truth.objects[i].after;
    if (!box) continue;
    const ObjectSightings seen = known ? sightings->objects[i] : ObjectSightings{};
    const std::size_t frames = before ? seen.object_before : seen.object_after;
    objects.push_back({truth.objects[i].class_name, *box, !known || frames >= options.min_frames});
  }
  return objects;
}

Json counts_json(const Verdict& verdict) {
  return {{"truth", verdict.truth},
          {"reported", verdict.reported},
          {"matched", verdict.matched.size()},
          {"excused", verdict.excused}};
}

// Nothing if there are no values.
Json distances_json(std::vector<double> distances_m, double close_m) {
  if (distances_m.empty()) return nullptr;
  std::sort(distances_m.begin(), distances_m.end());
  const std::size_t half = distances_m.size() / 2;
  const double median_m =
      distances_m.size() % 2 == 1 ? distances_m[half] : 0.5 * (distances_m[half - 1] + distances_m[half]);
  const auto close = std::upper_bound(distances_m.begin(), distances_m.end(), close_m) - distances_m.begin();
  return {{"count", distances_m.size()}, {"close", close}, {"median_m", median_m}, {"max_m", distances_m.back()}};
}

// Null: not known.
const ObjectSightings* sightings_of(const SceneTruth& truth, const Sightings* sightings, int id) {
  if (sightings == nullptr || !sightings->have_instances) return nullptr;
  const auto object = std::ranges::find(truth.objects, id, &TrueObject::id);
  return object == truth.objects.end() ? nullptr
                                       : &sightings->objects[static_cast<std::size_t>(object - truth.objects.begin())];
}

double ratio(const Json& section, const char* part, const char* whole) {
  return section.at(part).get<double>() / section.at(whole).get<double>();
}

VoxelSet without_floor(VoxelSet voxels, const SceneReportOptions& options) {
  drop_floor(voxels, options.floor_z_m, options.voxel_size_m);
  return voxels;
}

Result<VoxelSet> map_voxels(PlyMesh map, const Rigid3& T_truth_estimate, const SceneReportOptions& options) {
  for (Eigen::Vector3d& vertex : map.vertices) vertex = T_truth_estimate * vertex;
  Result<VoxelSet> voxels = voxels_of_mesh(map, options.voxel_size_m);
  if (voxels) drop_floor(*voxels, options.floor_z_m, options.voxel_size_m);
  return voxels;
}

Json voxels_json(const VoxelSet& truth, const VoxelSet& map, const VoxelSet& excused,
                 const SceneReportOptions& options) {
  const std::int32_t first_layer = voxel_at({0.0, 0.0, options.floor_z_m}, options.voxel_size_m).z + 1;
  const VoxelCounts counts = score_voxels(truth, map, excused, first_layer);
  Json json{{"true_positive", counts.true_positive},
            {"false_positive", counts.false_positive},
            {"false_negative", counts.false_negative},
            {"false_positive_in_box", counts.false_positive_in_box},
            {"true_negative", counts.true_negative}};
  if (!excused.empty()) json["excused"] = counts.excused;
  add_ratios(json);
  return json;
}

}  // namespace

void add_ratios(Json& section) {
  const auto set = [&section](const char* key, const char* part, const char* whole) {
    section[key] = section.at(whole).get<double>() > 0.0 ? Json(ratio(section, part, whole)) : Json(nullptr);
  };
  if (section.contains("matched")) {
    set("precision", "matched", "reported");
    set("recall", "matched", "truth");
    return;
  }
  const double tp = section.at("true_positive"), fp = section.at("false_positive"), fn = section.at("false_negative");
  const double in_box = section.at("false_positive_in_box"), tn = section.at("true_negative");
  const auto share = [](double part, double rest) {
    return part + rest > 0.0 ? Json(part / (part + rest)) : Json(nullptr);
  };
  section["precision"] = share(tp, fp);
  section["recall"] = share(tp, fn);
  section["false_positive_rate"] = share(in_box, tn);
}

Json report_events(const SceneTruth& truth, const Sightings* sightings, const std::vector<ReportedEvent>& events,
                   const Rigid3& T_truth_estimate, const SceneReportOptions& options) {
  std::vector<PlaceChange> reported = changes_of(events);
  for (PlaceChange& change : reported) change.box = moved(T_truth_estimate, change.box);
  reported = join_touching(reported, options.touch_gap_m);
  const auto score = [&](Asked asked) {
    return score_events(join_touching(true_changes(truth, sightings, options.min_frames, asked), options.touch_gap_m),
                        reported, options.max_distance_m);
  };
  const Verdict verdict = score(Asked::what_shows);
  Json json = counts_json(verdict);
  add_ratios(json);
  json["knowable"] = counts_json(score(Asked::what_can_be_known));
  add_ratios(json["knowable"]);
  double sum_m = 0.0;
  for (const MatchedPair& pair : verdict.matched) sum_m += pair.cost;
  if (!verdict.matched.empty()) json["mean_distance_m"] = sum_m / static_cast<double>(verdict.matched.size());
  json["events"] = events.size();
  return json;
}

Json report_moved(const SceneTruth& truth, const Sightings* sightings, const std::vector<ReportedEvent>& events,
                  const std::vector<ReportedObject>& objects, const Rigid3& T_truth_estimate,
                  const SceneReportOptions& options) {
  std::vector<ReportedEvent> said = events;
  for (ReportedEvent& event : said) {
    event.box = moved(T_truth_estimate, event.box);
    if (event.from) event.from = moved(T_truth_estimate, *event.from);
  }
  std::vector<ReportedObject> now = objects;
  for (ReportedObject& object : now) object.box = moved(T_truth_estimate, object.box);
  Json boxes = Json::array();
  std::vector<double> told_m, end_m, told_seen_m, end_seen_m;
  for (const MovedBox& box : score_moved(truth, said, now, options.max_distance_m)) {
    told_m.push_back(box.distance_m);
    if (box.end_distance_m) end_m.push_back(*box.end_distance_m);
    const ObjectSightings* seen = sightings_of(truth, sightings, box.truth);
    if (seen != nullptr && seen->sides_after) {
      told_seen_m.push_back(box.distance_m);
      if (box.end_distance_m) end_seen_m.push_back(*box.end_distance_m);
    }
    boxes.push_back({{"object", box.object},
                     {"truth", box.truth},
                     {"distance_m", box.distance_m},
                     {"yaw_deg", box.yaw_rad * kDegPerRad},
                     {"edge_error_m", box.edge_error_m},
                     {"same_thing", box.same_thing},
                     {"sides_seen", seen == nullptr ? Json(nullptr) : Json(seen->sides_after)},
                     {"sides_seen_before", seen == nullptr ? Json(nullptr) : Json(seen->sides_before)},
                     {"end_distance_m", box.end_distance_m ? Json(*box.end_distance_m) : Json(nullptr)},
                     {"end_edge_error_m", box.end_edge_error_m ? Json(*box.end_edge_error_m) : Json(nullptr)}});
  }
  const auto moves =
      std::count_if(said.begin(), said.end(), [](const auto& event) { return event.type == EventType::moved; });
  return {{"reported", moves},
          {"told", distances_json(std::move(told_m), options.close_m)},
          {"end", distances_json(std::move(end_m), options.close_m)},
          {"told_sides_seen", distances_json(std::move(told_seen_m), options.close_m)},
          {"end_sides_seen", distances_json(std::move(end_seen_m), options.close_m)},
          {"boxes", boxes}};
}

Json report_objects(const SceneTruth& truth, const Sightings* sightings, const std::vector<ReportedObject>& objects,
                    const Rigid3& T_truth_estimate, const SceneReportOptions& options) {
  std::vector<ScoredObject> reported;
  for (const ReportedObject& object : objects)
    reported.push_back({object.class_name, moved(T_truth_estimate, object.box)});
  std::vector<ScoredObject> wanted = true_objects(truth, sightings, options);
  Json each_box = counts_json(score_objects(wanted, reported, options.min_iou));
  add_ratios(each_box);
  reported = join_touching(reported, options.touch_gap_m);
  wanted = join_touching(wanted, options.touch_gap_m);
  const Verdict verdict = score_objects(wanted, reported, options.min_iou);
  Json json = counts_json(verdict);
  add_ratios(json);
  json["each_box"] = std::move(each_box);
  if (verdict.matched.empty()) return json;
  double iou = 0.0, position_m = 0.0, yaw_rad = 0.0;
  std::size_t same_class = 0;
  for (const MatchedPair& pair : verdict.matched) {
    const ScoredObject &is = wanted[pair.truth], &said = reported[pair.reported];
    iou += 1.0 - pair.cost;
    position_m += (is.box.center_world - said.box.center_world).norm();
    yaw_rad += yaw_difference_mod_half_turn(is.box.yaw_rad, said.box.yaw_rad);
    same_class += is.class_name == said.class_name ? 1 : 0;
  }
  const double count = static_cast<double>(verdict.matched.size());
  json["of_right_class"] = same_class;
  json["mean_iou"] = iou / count;
  json["mean_position_error_m"] = position_m / count;
  json["mean_yaw_error_deg"] = yaw_rad / count * kDegPerRad;
  return json;
}

Result<Json> report_voxels(const PlyMesh& true_surface, const std::vector<std::size_t>& surface_frames,
                           const PlyMesh& map, const Rigid3& T_truth_estimate, const SceneReportOptions& options) {
  EXPECTS(surface_frames.size() == true_surface.vertices.size());
  std::vector<Eigen::Vector3d> seen;
  for (std::size_t i = 0; i < surface_frames.size(); ++i) {
    if (surface_frames[i] >= kMaxPointFrames) seen.push_back(true_surface.vertices[i]);
  }
  const VoxelSet truth = without_floor(voxels_of_points(seen, options.voxel_size_m), options);
  const VoxelSet all = without_floor(voxels_of_points(true_surface.vertices, options.voxel_size_m), options);
  const Result<VoxelSet> mapped = map_voxels(map, T_truth_estimate, options);
  if (!mapped) return mapped.error();
  Json json = voxels_json(truth, *mapped, {}, options);
  json["unseen_true_surface_excused"] = voxels_json(truth, *mapped, all, options);
  return json;
}

Result<Json> report_voxels_against_map(const PlyMesh& reference, const PlyMesh& map, const Rigid3& T_truth_estimate,
                                       const SceneReportOptions& options) {
  const Result<VoxelSet> truth = map_voxels(reference, Rigid3{}, options);
  if (!truth) return truth.error();
  const Result<VoxelSet> mapped = map_voxels(map, T_truth_estimate, options);
  if (!mapped) return mapped.error();
  return voxels_json(*truth, *mapped, {}, options);
}

}  // namespace povslam::scores
