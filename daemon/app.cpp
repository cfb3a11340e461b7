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
  std::unique_ptr<App> app(new App(config, options, std::move(*setup), map ? &*map : nullptr));
  if (map) map->content = {};  // taken over; what the objects need may have its memory
  const Status started = app->start_threads(config, std::move(options), std::move(map));
  if (!started) return started.error();
  return app;
}

App::App(const AppConfig& config, const AppOptions& options, DriverSetup setup, const OpenedStore* map)
    : setup_(std::move(setup)),
      frames_(config.daemon.frame_slots),
      reports_(kPoseRing, kWorldReports),
      asked_(kJobRing),
      solved_(kJobRing),
      windows_(kJobRing),
      windows_solved_(kJobRing),
      pipeline_(std::make_unique<Pipeline>(
          config.pipeline, setup_.sensors[0], start_of(config, options, T_body_camera()),
          map != nullptr && map->content.meta.next_keyframe > 0 ? &map->content : nullptr)) {}

Status App::start_threads(const AppConfig& config, AppOptions options, std::optional<OpenedStore> map) {
  counters_.store_used = map.has_value();
  counters_.store_replaced = map && !map->quarantined.empty();
  auto understanding = UnderstandingUnit::start(
      config, setup_, map ? &map->world : nullptr,
      {understanding_bell_, reports_.world, *pipeline_, map ? &changes_.world : nullptr, options.mesh_wanted});
  if (!understanding) return understanding.error();
  understanding_ = std::move(*understanding);
  reporter_.emplace(ReporterOptions{.health_period = from_seconds(config.daemon.health_period_s),
                                    .objects_period = from_seconds(config.daemon.objects_period_s)},
                    options.sinks, reports_, counters_);
  backend_.emplace("backend", asked_, solved_, config.pipeline.backend, counters_.backend);
  vem_.emplace("vem", windows_, windows_solved_, config.pipeline.backend, counters_.vem);
  if (map) store_.emplace(std::move(map->store), changes_, counters_);
  TrackingLinks links{frames_, reports_.poses, asked_, solved_};
  links.windows = &windows_;
  links.windows_solved = &windows_solved_;
  if (map) links.changes = &changes_.map;
  if (understanding_) {
    links.views = &understanding_->views();
    links.owners = &understanding_->owners();
    links.beliefs = &understanding_->beliefs();
  }
  tracking_.emplace(*pipeline_, links, counters_, options.probe);
  reporter_->watch(&*tracking_);
  options.sensor.name = config.sensors[0].name;
  sensor_.emplace(options.sensor, std::move(options.driver), setup_, frames_,
                  understanding_ ? understanding_->sensor_labels() : nullptr, counters_, std::move(options.on_end));
  return Done{};
}

App::~App() {
  stop();
}

void App::stop() {
  sensor_.reset();
  if (reporter_) reporter_->watch(nullptr);
  tracking_.reset();
  if (understanding_) understanding_->finish();
  store_rest();
  vem_.reset();
  backend_.reset();
  reporter_.reset();
}

// Pipeline and understanding hand a change out only when the one before is back.
void App::store_rest() {
  if (store_ && store_->finish()) {
    while (const auto change = changes_.map.stored.try_pop()) pipeline_->give_back(*change);
    MapChange* map = pipeline_->collect_change();
    WorldChange* world = understanding_ ? understanding_->rest() : nullptr;
    if ((map != nullptr || world != nullptr) && store_->commit_rest(map, world)) {
      if (map != nullptr) pipeline_->give_back(map);
      if (world != nullptr) understanding_->stored(world);
    }
  }
  store_.reset();
}

}  // namespace povslam
