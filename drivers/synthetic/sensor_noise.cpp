#include "drivers/synthetic/sensor_noise.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr std::size_t kTable = 1U << 16, kLongestRow = 3 * 4096;
constexpr double kGreySigma = 3.0;
constexpr float kDepthSigma_per_m = 0.0025F;  // times z^2 [m^2]
constexpr float kEdgeJump = 0.04F;            // relative step of inverse depth
constexpr float kEdgeLoss = 0.75F;            // share of edge pixels without depth
constexpr float kGrazingCosine = 0.15F;       // no loss above, certain loss at 0

std::size_t row_offset(std::uint64_t seed, std::uint64_t frame, int row, std::uint64_t use) {
  return mix(mix(seed + use, frame), static_cast<std::uint64_t>(row)) & (kTable - 1);
}

}  // namespace

SensorNoise::SensorNoise(std::uint64_t seed, double noise) : seed_(mix(seed, 505)), noise_(static_cast<float>(noise)) {
  Random random(seed_);
  phase_rad_ = random.uniform(0.0, 2.0 * kPi);
  for (std::size_t i = 0; i < kTable + kLongestRow; ++i) {
    const double g = random.gaussian();
    gaussian_.push_back(static_cast<float>(g));
    grey_.push_back(
        static_cast<std::int8_t>(std::clamp(std::floor(kGreySigma * noise * g + random.uniform()), -127.0, 127.0)));
    uniform_.push_back(static_cast<float>(random.uniform()));
  }
}

double SensorNoise::exposure(double time_s) const {
  const double drift =
      0.05 * sin_cos(0.23 * time_s + phase_rad_).sin + 0.03 * sin_cos(0.71 * time_s + 2.0 * phase_rad_).sin;
  return 1.0 + std::min(1.0, static_cast<double>(noise_)) * drift;
}

void SensorNoise::add_to_color(std::uint8_t* color, int row_bytes, int rows, std::uint64_t frame) const {
  if (noise_ <= 0.0F) return;
  for (int row = 0; row < rows; ++row) {
    std::uint8_t* value = color + static_cast<std::size_t>(row) * static_cast<std::size_t>(row_bytes);
    const std::int8_t* noise = grey_.data() + row_offset(seed_, frame, row, 1);
    for (int i = 0; i < row_bytes; ++i) {
      const int noisy = value[i] + noise[i];
      value[i] = static_cast<std::uint8_t>(noisy < 0 ? 0 : noisy > 255 ? 255 : noisy);
    }
  }
}

// A pixel is at an edge when another face stands clearly before or behind it within two columns or one row.
void SensorNoise::find_edges(const Raster& raster, int row) {
  const int width = raster.hit().width(), last = raster.hit().height() - 1;
  const float* w = raster.inverse_depth().row(row);
  const std::int32_t* hit = raster.hit().row(row);
  std::fill(edge_.begin(), edge_.end(), std::uint8_t{0});
  std::uint8_t* edge = edge_.data();
  const auto compare = [&](const float* other_w, const std::int32_t* other_hit, int begin, int end, int shift) {
    for (int x = begin; x < end; ++x) {
      const float jump = std::abs(other_w[x + shift] - w[x]);
      edge[x] = static_cast<std::uint8_t>(
          edge[x] | static_cast<int>((other_hit[x + shift] != hit[x]) & (jump > kEdgeJump * w[x])));
    }
  };
  for (const int shift : {1, 2}) {
    compare(w, hit, 0, width - shift, shift);
    compare(w, hit, shift, width, -shift);
  }
  if (row > 0) compare(raster.inverse_depth().row(row - 1), raster.hit().row(row - 1), 0, width, 0);
  if (row < last) compare(raster.inverse_depth().row(row + 1), raster.hit().row(row + 1), 0, width, 0);
}

void SensorNoise::measure_depth(const Raster& raster, const PinholeCamera& camera,
                                const std::vector<float>& plane_distance_m, double max_depth_m, float depth_scale,
                                std::uint64_t frame, ImageU16& depth) {
  const int width = camera.width;
  depth.resize(width, camera.height);
  ray_length_.resize(static_cast<std::size_t>(width));
  edge_.resize(static_cast<std::size_t>(width));
  const auto least_w = static_cast<float>(1.0 / max_depth_m);
  const float sigma = noise_ * kDepthSigma_per_m * depth_scale;
  const float loss = std::min(1.0F, noise_);
  for (int row = 0; row < camera.height; ++row) {
    const auto v = static_cast<float>((row - camera.cy) / camera.fy);
    for (int x = 0; x < width; ++x) {
      const auto u = (static_cast<float>(x) - static_cast<float>(camera.cx)) / static_cast<float>(camera.fx);
      ray_length_[static_cast<std::size_t>(x)] = std::sqrt(1.0F + u * u + v * v);
    }
    find_edges(raster, row);
    const float* w = raster.inverse_depth().row(row);
    const std::int32_t* hit = raster.hit().row(row);
    const float* gaussian = gaussian_.data() + row_offset(seed_, frame, row, 2);
    const float* uniform = uniform_.data() + row_offset(seed_, frame, row, 3);
    const float *length = ray_length_.data(), *distance = plane_distance_m.data();
    const std::uint8_t* edge = edge_.data();
    std::uint16_t* out = depth.row(row);
    for (int x = 0; x < width; ++x) {
      const float here = w[x] > 1e-4F ? w[x] : 1e-4F;
      const float z = 1.0F / here;
      const float cosine = distance[hit[x]] * here / length[x];
      const float grazing = 1.0F - cosine / kGrazingCosine;
      const float lost = edge[x] ? std::max(kEdgeLoss, grazing) : grazing;
      const float units = z * depth_scale + sigma * z * z * gaussian[x] + 0.5F;
      const bool valid = (w[x] >= least_w) & (uniform[x] >= loss * lost) & (units >= 1.0F) & (units < 65535.0F);
      out[x] = valid ? static_cast<std::uint16_t>(static_cast<std::int32_t>(units)) : std::uint16_t{0};
    }
  }
}

}  // namespace povslam::synthetic
