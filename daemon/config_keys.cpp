#include "daemon/config_keys.hpp"

#include <algorithm>
#include <numeric>
#include <utility>

#include "daemon/config_keys_rows.hpp"

namespace povslam {
namespace {

std::vector<Key<AppConfig>> daemon_table() {
  return {
      text("lcm.url", AT(lcm.url), "Where messages go: any LCM URL; ttl=0 keeps them on this machine, empty: nowhere"),
      key("lcm.robot_id", AT(lcm.robot_id), 1, 64, "Stands in every message"),
      text("log.level", AT(log.level), "One line a change of state", {"debug", "info", "warn", "error"}),
      text("log.file", AT(log.file), "Log to this file as well; empty: standard error (the journal) only"),
      key("daemon.frame_slots", AT(daemon.frame_slots), 3, 64,
          "Frames in flight between the sensor and tracking; more are dropped and counted (ring_full)"),
      key("daemon.health_period_s", AT(daemon.health_period_s), 0.05, 5.0,
          "POVSLAM_HEALTH and the watchdog, besides every change of state"),
      key("daemon.objects_period_s", AT(daemon.objects_period_s), 0.1, 5.0,
          "POVSLAM_OBJECTS: all objects again, for those who were not listening from the beginning"),
      key("daemon.exit_at_end", AT(daemon.exit_at_end), 0, 1, "Stop when a source that ends (a recording) has ended"),
      key("labels.socket", AT(labels.socket), 0, 107,
          "Unix socket that a label source connects to, for example /run/povslam/labels.sock; empty: none"),
      text("labels.lcm_channel", AT(labels.lcm_channel),
           "LCM channel on which povslam.label_image_t comes, for example POVSLAM_LABELS; empty: none"),
      text("labels.classes", AT(labels.classes),
           "What the ids of label images mean: synthetic, torwic, coco, geometric or a TOML file; auto: as the sensor "
           "says, and coco for a network's names"),
      key("start.translation_m", AT(start.translation_m), -1e7, 1e7,
          "Where the body is at the first frame (T_world_body), for example at its dock; the world is level there"),
      key("start.q_xyzw", AT(start.q_xyzw), -1, 1, "Its orientation"),
  };
}

std::vector<Key<AppConfig>> frontend_table() {
  return {
      key("orb.num_features", AT(pipeline.frontend.orb.num_features), 50, 20000, "Features wanted of an image"),
      key("orb.num_levels", AT(pipeline.frontend.orb.num_levels), 1, kMaxPyramidLevels, "Pyramid levels"),
      key("orb.scale_factor", AT(pipeline.frontend.orb.scale_factor), 1.05, 2.0, "Size ratio of neighbouring levels"),
      key("orb.fast_threshold", AT(pipeline.frontend.orb.fast_threshold), 1, 254,
          "Grey levels a corner differs from its circle: first choice"),
      key("orb.min_fast_threshold", AT(pipeline.frontend.orb.min_fast_threshold), 1, 254,
          "Grey levels: what a cell poor in corners is lowered to"),
      key("orb.cell_px", AT(pipeline.frontend.orb.cell_px), 8, 256, "Edge of the cells over which features are spread"),

      key("noise.pixel_sigma_px", AT(pipeline.frontend.noise.pixel_sigma_px), 0.05, 20.0,
          "Feature position, one standard deviation on level 0"),
      key("noise.patch_sigma_px", AT(pipeline.frontend.noise.patch_sigma_px), 0.05, 20.0,
          "The same of a position found by fitting the landmark's patch"),
      key("noise.depth_sigma_quadratic_per_m", AT(pipeline.frontend.noise.depth_sigma_quadratic_per_m), 0.0, 0.1,
          "Depth: sigma_z = this * z^2 [1/m]"),
      key("noise.depth_sigma_floor_m", AT(pipeline.frontend.noise.depth_sigma_floor_m), 1e-5, 1.0,
          "Depth: added in quadrature"),
      key("noise.min_depth_m", AT(pipeline.frontend.noise.min_depth_m), 0.0, 100.0, "Nearer measurements are not used"),
      key("noise.max_depth_m", AT(pipeline.frontend.noise.max_depth_m), 0.1, 300.0, "Farther ones neither"),

      key("track.search_radius_px", AT(pipeline.frontend.track.search_radius_px), 1.0, 200.0,
          "Around a landmark's predicted position; doubled when too few match"),
      key("track.min_inliers_ok", AT(pipeline.frontend.track.min_inliers_ok), 4, 2000, "Landmarks for state OK"),
      key("track.min_inliers_degraded", AT(pipeline.frontend.track.min_inliers_degraded), 4, 2000,
          "With fewer the pose is not trusted at all"),
      key("track.object_landmarks", AT(pipeline.frontend.track.object_landmarks), 0, 1000,
          "Of a small believed thing; where fewer were seen more features are wanted; 0: never"),
      key("track.frames_to_recover", AT(pipeline.frontend.track.frames_to_recover), 1, 300,
          "Good frames in a row before DEGRADED becomes OK"),
      key("track.frames_to_lost", AT(pipeline.frontend.track.frames_to_lost), 1, 300,
          "Frames in a row without a pose before LOST"),

      text("map.store", AT(map.store),
           "File the map is kept in; auto: map.db in the service's state folder (/var/lib/povslam), nowhere when not "
           "started by systemd; empty: nowhere"),
      key("map.max_keyframes", AT(pipeline.frontend.map.max_keyframes), 10, 100000, "Bounds the memory"),
      key("map.max_landmarks", AT(pipeline.frontend.map.max_landmarks), 1000, 5000000, "Bounds the memory"),
      key("map.keyframe_min_frames", AT(pipeline.frontend.map.keyframe_min_frames), 1, 1000,
          "At least so many frames between two keyframes"),
      key("map.keyframe_max_frames", AT(pipeline.frontend.map.keyframe_max_frames), 1, 10000, "At most so many"),
      key("map.smooth_max_poses", AT(pipeline.frontend.map.smooth_max_poses), 1, 1000,
          "Keyframes moved by one local bundle adjustment"),
      key("map.smooth_max_fixed_poses", AT(pipeline.frontend.map.smooth_max_fixed_poses), 1, 1000,
          "Keyframes that see the same landmarks and hold the window"),
      key("map.smooth_max_points", AT(pipeline.frontend.map.smooth_max_points), 10, 1000000, "Landmarks in it"),
      key("map.smooth_max_observations", AT(pipeline.frontend.map.smooth_max_observations), 100, 10000000,
          "Observations in it"),
      key("map.change_period_s", AT(pipeline.frontend.map.change_period_s), 0.1, 60.0,
          "So often what changed in the map is stored"),
      text("map.mode", AT(pipeline.frontend.map.mode), "localise: the map stays as it is", {"map", "localise"}),
      text("map.start", AT(pipeline.frontend.map.start),
           "On an existing map: search the whole map, or try the start pose first (a dock)", {"search", "known"}),
  };
}

std::vector<Key<AppConfig>> backend_table() {
  return {
      text("pipeline.mode", AT(pipeline.mode),
           "pov: what is believed of objects decides what tracking hangs on; static: every landmark counts alike",
           {"pov", "static"}),
      key("backend.delay_frames", AT(pipeline.backend.delay_frames), 1, 1000,
          "The answer of a background job enters this many frames after it was asked for; one that is late, when it "
          "comes"),
      key("smooth.max_iterations", AT(pipeline.backend.smooth.max_iterations), 1, 1000,
          "Of each round of a local bundle adjustment"),
      key("smooth.huber_pixel", AT(pipeline.backend.smooth.huber_pixel), 0.1, 100.0,
          "Whitened norm of a pixel's residual beyond which the loss is linear"),
      key("smooth.huber_depth", AT(pipeline.backend.smooth.huber_depth), 0.1, 100.0, "The same of its depth's"),
      key("smooth.outlier_chi2_pixel", AT(pipeline.backend.smooth.outlier_chi2_pixel), 0.1, 1000.0,
          "Whitened squared norm beyond which an observation is left out"),
      key("smooth.outlier_chi2_depth", AT(pipeline.backend.smooth.outlier_chi2_depth), 0.1, 1000.0,
          "The same of its depth's: beyond it only the pixel is used"),
      key("smooth.num_threads", AT(pipeline.backend.smooth.num_threads), 1, 64, "Threads of the solver"),
      key("loop.max_iterations", AT(pipeline.backend.close_loop.max_iterations), 1, 1000,
          "Of each round of closing a loop"),
      key("loop.max_solve_s", AT(pipeline.backend.close_loop.max_solve_s), 0.0, 600.0,
          "A loop not closed by then is dropped; 0: no limit, and replay gives the same bytes each time"),
      key("loop.loop_scale", AT(pipeline.backend.close_loop.loop_scale), 0.1, 100.0,
          "Whitened residual norm beyond which a recognised place is believed less and less"),
      key("loop.max_loop_error_m", AT(pipeline.backend.close_loop.max_loop_error_m), 0.001, 10.0,
          "A loop whose ends are still farther apart afterwards is refused"),
      key("loop.max_loop_error_rad", AT(pipeline.backend.close_loop.max_loop_error_rad), 0.001, 3.2,
          "The same of their orientation"),
      key("loop.max_strain", AT(pipeline.backend.close_loop.max_strain), 0.1, 1000.0,
          "It is also refused when neighbours would be bent by more than this whitened norm"),
  };
}

std::vector<Key<SensorConfig>> sensor_table() {
  const auto at = [](auto getter) { return Row<SensorConfig>::at(getter); };
  return {
      {.path = "name", .member = at(AT(name)), .doc = "Role on the robot", .min = 1, .max = 64},
      {.path = "driver", .member = at(AT(driver)), .doc = "Kind of sensor", .min = 1, .max = 64},
      {.path = "translation_m",
       .member = at(AT(translation_m)),
       .doc = "Mount: T_body_sensor",
       .min = -100,
       .max = 100},
      {.path = "q_xyzw",
       .member = at(AT(q_xyzw)),
       .doc = "Mount: orientation of T_body_sensor as it is",
       .min = -1,
       .max = 1},
      {.path = "rpy_deg",
       .member = at(AT(rpy_deg)),
       .doc = "or roll, pitch, yaw of the housing",
       .min = -360,
       .max = 360},
  };
}

// An option added to these structs changes their size: give it a key above, then the new size here.
static_assert(sizeof(OrbOptions) == 32 && sizeof(NoiseOptions) == 48 && sizeof(TrackOptions) == 32 &&
              sizeof(MapOptions) == 104 && sizeof(SmoothOptions) == 48 && sizeof(CloseLoopOptions) == 48 &&
              sizeof(PipelineOptions) - sizeof(UnderstandingOptions) == 616);

// Edit distance (Levenshtein), insertions, deletions and replacements cost 1.
std::size_t edit_distance(std::string_view a, std::string_view b) {
  std::vector<std::size_t> row(b.size() + 1);
  std::iota(row.begin(), row.end(), std::size_t{0});
  for (std::size_t i = 0; i < a.size(); ++i) {
    std::size_t diagonal = std::exchange(row[0], i + 1);
    for (std::size_t j = 0; j < b.size(); ++j) {
      const std::size_t replaced = diagonal + (a[i] == b[j] ? 0 : 1);
      diagonal = row[j + 1];
      row[j + 1] = std::min({replaced, row[j + 1] + 1, row[j] + 1});
    }
  }
  return row.back();
}

}  // namespace

std::span<const Key<AppConfig>> config_keys() {
  static const std::vector<Key<AppConfig>> keys = [] {
    std::vector<Key<AppConfig>> all = daemon_table();
    for (const auto& part : {frontend_table(), backend_table(), vem_table(), understanding_table()})
      all.insert(all.end(), part.begin(), part.end());
    return all;
  }();
  return keys;
}

std::span<const Key<SensorConfig>> sensor_keys() {
  static const std::vector<Key<SensorConfig>> keys = sensor_table();
  return keys;
}

std::span<const OrderRule> order_rules() {
  static const std::vector<OrderRule> rules = {
      {"orb.min_fast_threshold", "orb.fast_threshold"},       {"noise.min_depth_m", "noise.max_depth_m"},
      {"track.min_inliers_degraded", "track.min_inliers_ok"}, {"map.keyframe_min_frames", "map.keyframe_max_frames"},
      {"map.smooth_max_poses", "map.max_keyframes"},          {"view.min_depth_m", "view.max_depth_m"},
      {"structure.voxel_size_m", "structure.truncation_m"},   {"object.voxel_size_m", "object.truncation_m"},
  };
  return rules;
}

std::string nearest_name(std::string_view unknown, std::span<const std::string> known) {
  std::string best;
  std::size_t best_distance = std::max<std::size_t>(2, unknown.size() / 2);
  for (const std::string& name : known) {
    const std::size_t distance = edit_distance(unknown, name);
    if (distance >= best_distance) continue;
    best_distance = distance;
    best = name;
  }
  return best;
}

}  // namespace povslam
