// What a small simulated camera sees of a simulated room: images with a known truth.
#pragma once

#include <memory>

#include "drivers/synthetic/renderer.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"
#include "pipeline/frames/calibration.hpp"
#include "pipeline/frontend/options.hpp"

namespace povslam {

// Half the standard size, ten frames a second, a static room: fast enough for a sanitizer.
inline synthetic::SyntheticOptions small_drive(std::uint64_t seed) {
  synthetic::SyntheticOptions options;
  options.scene = "static";
  options.seed = seed;
  options.camera = {320, 240, 262.5, 262.5, 159.5, 119.5, {}};
  options.fps = 10.0;
  options.speed_mps = 0.4;
  return options;
}

class SimulatedView {
 public:
  explicit SimulatedView(const synthetic::SyntheticOptions& options) {
    auto world = synthetic::World::create(options);
    EXPECTS(world);
    world_ = std::make_unique<synthetic::World>(std::move(*world));
    renderer_ = std::make_unique<synthetic::Renderer>(*world_);
  }

  // Valid until the next call.
  const RgbdFrame& look(const Rigid3& T_world_camera, double time_s = 0.0) {
    renderer_->render(T_world_camera, time_s, frame_);
    frame_.stamp = frame_.depth_stamp = world_->start_stamp() + from_seconds(time_s);
    return frame_;
  }
  const RgbdFrame& drive(double time_s) { return look(world_->T_world_camera(time_s), time_s); }
  // A covered lens.
  const RgbdFrame& black(double time_s) {
    drive(time_s);
    frame_.color.fill(0);
    frame_.depth.fill(0);
    return frame_;
  }

  Rigid3 T_world_camera(double time_s) const { return world_->T_world_camera(time_s); }
  Rigid3 T_world_body(double time_s) const { return world_->T_world_body(time_s); }
  double period_s() const { return 1.0 / world_->options().fps; }
  double lap_s() const { return world_->lap_end_s(1.0); }
  SensorCalibration calibration() const { return synthetic::sensor_calibrations(world_->options()).front(); }

 private:
  std::unique_ptr<synthetic::World> world_;  // the renderer refers to it
  std::unique_ptr<synthetic::Renderer> renderer_;
  RgbdFrame frame_;
};

inline FrontendOptions small_frontend() {
  FrontendOptions options;
  options.orb.num_features = 600;
  return options;
}

}  // namespace povslam
