// The running daemon without its process: owns the driver, the rings, the threads and the pipeline. The order of the
// members is the order of starting; stop() ends them in reverse: sensor, tracking, understanding, store, backend,
// reporter.
#pragma once

#include <functional>
#include <memory>
#include <optional>
#include <vector>

#include "daemon/backend_thread.hpp"
#include "daemon/config.hpp"
#include "daemon/counters.hpp"
#include "daemon/frame_exchange.hpp"
#include "daemon/reporter.hpp"
#include "daemon/sensor_thread.hpp"
#include "daemon/sink.hpp"
#include "daemon/store.hpp"
#include "daemon/store_thread.hpp"
#include "daemon/tracking_thread.hpp"
#include "daemon/understanding_unit.hpp"

namespace povslam {

struct AppOptions {
  std::unique_ptr<Driver> driver;              // of config.sensors[0], not yet open
  std::vector<Sink*> sinks;                    // outlive the App
  std::function<void()> on_end;                // a finite source is over; called on the sensor thread
  std::optional<Rigid3> T_world_camera_start;  // overrides config.start
  std::filesystem::path map_store;             // the map's file; empty: it is not kept. In place of config.map
  SensorThreadOptions sensor;  // pauses between attempts to reopen; its name comes from the configuration
  TrackingProbe probe;
  bool mesh_wanted = false;  // understanding()->mesh() shall have surfaces that are nobody's as well
};

class App {
 public:
  // Opens the map and the sensor and starts all threads. Fails with the sensor's message when it cannot be opened, with
  // the store's when it cannot be used, and when labels are asked for that nobody delivers; a damaged store is set
  // aside and the map begins empty.
  static Result<std::unique_ptr<App>> start(const AppConfig& config, AppOptions options);
  ~App();

  // Stops within 2 s (a driver's next() returns within 1 s): what was received is tracked and given to the sinks,
  // what was learned is stored.
  void stop();

  const Counters& counters() const { return counters_; }
  const DriverSetup& setup() const { return setup_; }
  const Rigid3& T_body_camera() const { return setup_.sensors[0].T_body_sensor; }
  const Pipeline& pipeline() const { return *pipeline_; }  // after stop()
  Understanding* understanding() {                         // after stop(); null: understanding.labels is off
    return understanding_ ? &understanding_->understanding() : nullptr;
  }

 private:
  App(const AppConfig& config, const AppOptions& options, DriverSetup setup, const OpenedStore* map);
  Status start_threads(const AppConfig& config, AppOptions options, std::optional<OpenedStore> map);
  void store_rest();

  DriverSetup setup_;
  Counters counters_;
  FrameExchange frames_;
  ReportRings reports_;
  JobRing asked_, solved_, windows_, windows_solved_;
  Doorbell understanding_bell_;
  ChangeRings changes_{&understanding_bell_};
  std::unique_ptr<Pipeline> pipeline_;
  std::optional<Reporter> reporter_;
  std::optional<BackendThread> backend_, vem_;
  std::optional<StoreThread> store_;
  std::unique_ptr<UnderstandingUnit> understanding_;
  std::optional<TrackingThread> tracking_;
  std::optional<SensorThread> sensor_;
};

// The mount that holds: the configuration's, else the driver's, else level and forward at the body's origin.
Rigid3 mount_of(const SensorConfig& config, const SensorCalibration& calibration);

}  // namespace povslam
