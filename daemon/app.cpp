#include "daemon/app.hpp"

#include <utility>

#include "pipeline/base/log.hpp"

namespace povslam {
namespace {

constexpr std::size_t kPoseRing = 256;  // 8 s at 30 Hz: what a stalled publisher may hold back
constexpr std::size_t kWorldReports = 1024;
constexpr std::size_t kJobRing = 8;  // the pipeline asks for one of a kind at a time

Rigid3 start_of(const AppConfig& config, const AppOptions& options, const Rigid3& T_body_camera) {
  if (options.T_world_camera_start) return *options.T_world_camera_start * T_body_camera.inverse();
  return config.start.rigid();
}

}  // namespace

Rigid3 mount_of(const SensorConfig& config, const SensorCalibration& calibration) {
  if (config.has_mount) return config.T_body_sensor();
  // No camera looks along the body's z axis with its x forward: the identity means that the driver does not know.
  const Rigid3& known = calibration.T_body_sensor;
  const bool unknown = known.translation.isZero() && rotation_angle_rad(known) == 0.0;
  return unknown ? level_forward_camera() : known;
}

Result<std::unique_ptr<App>> App::start(const AppConfig& config, AppOptions options) {
  EXPECTS(config.sensors.size() == 1 && options.driver != nullptr);
  const SensorConfig& sensor = config.sensors[0];
  std::optional<OpenedStore> map;
  if (!options.map_store.empty()) {
    Result<OpenedStore> opened = open_or_quarantine(options.map_store);
    if (!opened) return Error{"map.store: " + opened.error().message};
    map.emplace(std::move(*opened));
    log::info("{}: {} keyframes, {} landmarks", map->store.file().string(), map->content.keyframes.size(),
              map->content.landmarks.size());
  }
  Result<DriverSetup> setup = options.driver->open();
  if (!setup) return Error{sensor.name + ": " + setup.error().message};
  if (setup->sensors.empty() || setup->sensors[0].kind != SensorKind::rgbd || !setup->sensors[0].camera.valid()) {
    return Error{sensor.name + ": " + setup->description + " delivers no RGB-D camera as its first sensor"};
  }
  SensorCalibration& calibration = setup->sensors[0];
  calibration.T_body_sensor = mount_of(sensor, calibration);
  log::info("{}: {}, {} x {} px, {:.1f} Hz", sensor.name, setup->description, calibration.camera.width,
            calibration.camera.height, calibration.fps);
  return std::unique_ptr<App>(new App(config, std::move(options), std::move(*setup), std::move(map)));
}

App::App(const AppConfig& config, AppOptions options, DriverSetup setup, std::optional<OpenedStore> map)
    : setup_(std::move(setup)),
      frames_(config.daemon.frame_slots),
      reports_(kPoseRing, kWorldReports),
      asked_(kJobRing),
      solved_(kJobRing),
      pipeline_(std::make_unique<Pipeline>(config.pipeline, setup_.sensors[0],
                                           start_of(config, options, T_body_camera()),
                                           map && map->content.meta.next_keyframe > 0 ? &map->content : nullptr)) {
  counters_.store_used = map.has_value();
  counters_.store_replaced = map && !map->quarantined.empty();
  reporter_.emplace(ReporterOptions{.health_period = from_seconds(config.daemon.health_period_s),
                                    .objects_period = from_seconds(config.daemon.objects_period_s)},
                    options.sinks, reports_, counters_);
  backend_.emplace(asked_, solved_, config.pipeline.backend, counters_);
  if (map) store_.emplace(std::move(map->store), changes_, counters_);
  tracking_.emplace(*pipeline_, frames_, reports_.poses, asked_, solved_, map ? &changes_.map : nullptr, counters_,
                    options.probe);
  reporter_->watch(&*tracking_);
  options.sensor.name = config.sensors[0].name;
  sensor_.emplace(options.sensor, std::move(options.driver), setup_, frames_, counters_, std::move(options.on_end));
}

App::~App() {
  stop();
}

void App::stop() {
  sensor_.reset();
  if (reporter_) reporter_->watch(nullptr);
  tracking_.reset();
  store_rest();
  backend_.reset();
  reporter_.reset();
}

// The pipeline hands a change out only when the one before is back.
void App::store_rest() {
  if (store_ && store_->finish()) {
    while (const auto change = changes_.map.stored.try_pop()) pipeline_->give_back(*change);
    if (MapChange* rest = pipeline_->collect_change()) {
      if (store_->commit_rest(rest, nullptr)) pipeline_->give_back(rest);
    }
  }
  store_.reset();
}

}  // namespace povslam
