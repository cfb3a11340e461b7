// Views of simulated scenes and of recordings as features, for training the vocabulary and measuring recognition.
#pragma once

#include <functional>
#include <memory>
#include <string>

#include "drivers/registry.hpp"
#include "drivers/synthetic/renderer.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"
#include "pipeline/frames/calibration.hpp"

namespace povslam {

// A simulated world to look at from anywhere.
class SceneViews {
 public:
  SceneViews(const std::string& scene, std::uint64_t seed) {
    synthetic::SyntheticOptions options;
    options.scene = scene;
    options.seed = seed;
    auto made = synthetic::World::create(options);
    EXPECTS(made);
    world_ = std::make_unique<synthetic::World>(std::move(*made));
    renderer_ = std::make_unique<synthetic::Renderer>(*world_);
  }

  const synthetic::World& world() const { return *world_; }
  SensorCalibration calibration() const { return synthetic::sensor_calibrations(world_->options()).front(); }
  double lap_s() const { return world_->lap_end_s(1.0); }

  // Valid until the next call. Things that change in a scene change with time.
  const RgbdFrame& look(const Rigid3& T_world_camera, double time_s) {
    renderer_->render(T_world_camera, time_s, frame_);
    frame_.stamp = frame_.depth_stamp = world_->start_stamp() + from_seconds(time_s);
    return frame_;
  }

 private:
  std::unique_ptr<synthetic::World> world_;  // the renderer refers to it
  std::unique_ptr<synthetic::Renderer> renderer_;
  RgbdFrame frame_;
};

// Calls take(calibration, frame) for each frame of a recording; an error says why there is none.
inline Status for_each_frame(const std::string& folder, const std::string& camera,
                             const std::function<void(const SensorCalibration&, const RgbdFrame&)>& take) {
  auto driver = make_driver("replay", {{"path", folder}, {"camera", camera}, {"realtime", "false"}});
  if (!driver) return driver.error();
  const Result<DriverSetup> setup = (*driver)->open();
  if (!setup) return setup.error();
  SensorFrame frame;
  while (true) {
    const Next next = (*driver)->next(frame);
    if (next.kind == Next::Kind::end) return Done{};
    if (next.kind == Next::Kind::failed) return Error{next.message};
    if (next.kind == Next::Kind::frame && frame.kind == SensorKind::rgbd) take(setup->sensors[0], frame.rgbd);
  }
}

}  // namespace povslam
