// The simulated RGB-D camera: what it measures at a pose and a time. Usable without any driver around it.
#pragma once

#include "drivers/synthetic/raster.hpp"
#include "drivers/synthetic/sensor_noise.hpp"
#include "drivers/synthetic/shader.hpp"
#include "drivers/synthetic/world.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/frames/rgbd_frame.hpp"

namespace povslam::synthetic {

// One thread at a time; the world must outlive it. A frame depends on its arguments only, never on earlier frames.
class Renderer {
 public:
  explicit Renderer(const World& world);

  // Colour (R, G, B) and depth in millimetres; the caller owns stamps and seq. Time in seconds since the start.
  void render(const Rigid3& T_world_camera, double time_s, RgbdFrame& frame);
  void render_at(double time_s, RgbdFrame& frame) { render(world_.T_world_camera(time_s), time_s, frame); }

  // Class and instance of every pixel of the frame rendered last.
  void label(LabelFrame& labels) const;

  // The truth of the frame rendered last, before any noise.
  const Raster& raster() const { return raster_; }
  const std::vector<ProjectedFace>& faces() const { return faces_; }

 private:
  void expose(const Rigid3& T_world_camera, double time_s, ImageU8& color);

  const World& world_;
  SensorNoise noise_;
  Shader shader_;
  Raster raster_;
  std::vector<ProjectedFace> faces_;
  std::vector<float> plane_distance_m_;
  ImageU8 exposure_;
  ImageU16 sum_;
};

}  // namespace povslam::synthetic
