// What a real RGB-D camera adds to the truth. Every draw depends on seed, frame and row only, so that a frame is the
// same whatever was rendered before it.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/synthetic/raster.hpp"

namespace povslam::synthetic {

class SensorNoise {
 public:
  // `noise` is a factor on everything below; 0 leaves images perfect.
  SensorNoise(std::uint64_t seed, double noise);

  // Slow drift of the exposure, a factor on brightness.
  double exposure(double time_s) const;

  // Adds noise of 3 grey levels to each channel. Row-major, `row_bytes` a row.
  void add_to_color(std::uint8_t* color, int row_bytes, int rows, std::uint64_t frame) const;

  // Depth in units from inverse depth: sigma = 0.0025 z^2, holes at depth edges and grazing surfaces, 0 beyond
  // max_depth_m. plane_distance_m holds one entry per hit id.
  void measure_depth(const Raster& raster, const PinholeCamera& camera, const std::vector<float>& plane_distance_m,
                     double max_depth_m, float depth_scale, std::uint64_t frame, ImageU16& depth);

 private:
  void find_edges(const Raster& raster, int row);

  std::uint64_t seed_;
  float noise_;
  double phase_rad_;
  std::vector<std::int8_t> grey_;  // tables of draws, longer than a row beyond kTable
  std::vector<float> gaussian_;
  std::vector<float> uniform_;
  std::vector<float> ray_length_;  // per column of the row at hand
  std::vector<std::uint8_t> edge_;
};

}  // namespace povslam::synthetic
