#include "pipeline/objects/segment_floor.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

namespace povslam {

namespace {

constexpr float kBin_m = 0.02F, kDeepest_m = 3.0F;  // below the camera
constexpr int kBins = static_cast<int>(kDeepest_m / kBin_m), kLevelBins = 5;
constexpr float kUpCosine = 0.9F;
constexpr double kLeastShare = 0.015;  // of the grid's cells, for a level to be one
constexpr float kSame_m = 0.15F, kFollow = 0.3F;
constexpr int kConvinced = 10;      // frames of another level alone
constexpr float kSteepest = 0.05F;  // of a floor in a world whose z is up
constexpr int kCellsForTilt = 800;

}  // namespace

std::optional<FloorTracker::Level> FloorTracker::lowest_level(const SegmentGrid& grid, float camera_height_m) {
  histogram_.assign(kBins + kLevelBins, 0);
  for (std::size_t i = 0; i < grid.w.size(); ++i) {
    const float below = camera_height_m - grid.z[i];
    if (grid.w[i] <= 0.0F || grid.normal_z[i] < kUpCosine || below <= 0.0F || below >= kDeepest_m) continue;
    ++histogram_[static_cast<std::size_t>(below / kBin_m)];
  }
  const int least = static_cast<int>(kLeastShare * grid.width * grid.height);
  Level level;
  for (int first = kBins - 1; first >= 0; --first) {  // from the lowest upwards, until it gets less again
    int cells = 0;
    float sum = 0.0F;
    for (int bin = first; bin < first + kLevelBins; ++bin) {
      const int count = histogram_[static_cast<std::size_t>(bin)];
      cells += count;
      sum += static_cast<float>(count) * (static_cast<float>(bin) + 0.5F);
    }
    if (cells > level.cells) {
      level = {camera_height_m - kBin_m * sum / static_cast<float>(cells), cells};
    } else if (level.cells > least && cells < level.cells) {
      return level;
    }
  }
  return std::nullopt;
}

void FloorTracker::follow(const std::optional<Level>& seen, int cells_of_grid) {
  if (!seen) return;
  if (!height_) {
    height_ = seen->height;
  } else if (std::abs(seen->height - *height_) < kSame_m) {
    *height_ += kFollow * (seen->height - *height_);
    contradicted_ = 0;
  } else {
    // Something that is no floor, seen without it; or what was taken for the floor was none.
    const bool broad = seen->cells > 3 * kLeastShare * cells_of_grid;
    contradicted_ = broad ? contradicted_ + 1 : contradicted_;
    if (contradicted_ < kConvinced) return;
    height_ = seen->height;
    contradicted_ = 0;
  }
}

FloorPlane FloorTracker::fit(const SegmentGrid& grid) const {
  FloorPlane plane{0.0F, 0.0F, *height_};
  for (const float gate_m : {kSame_m, 0.06F}) {
    Eigen::Matrix3d A = Eigen::Matrix3d::Zero();
    Eigen::Vector3d b = Eigen::Vector3d::Zero();
    int cells = 0;
    for (std::size_t i = 0; i < grid.w.size(); ++i) {
      const float off = grid.z[i] - plane.at(grid.x[i], grid.y[i]);
      if (grid.w[i] <= 0.0F || grid.normal_z[i] < kUpCosine || std::abs(off) > gate_m) continue;
      const Eigen::Vector3d row(grid.x[i], grid.y[i], 1.0);
      A += row * row.transpose();
      b += off * row;
      ++cells;
    }
    if (cells < kCellsForTilt) break;
    A.diagonal().head<2>().array() += 0.05 * cells;  // a narrow strip of floor does not tell its tilt
    const Eigen::Vector3f step = A.ldlt().solve(b).cast<float>();
    plane.tilt_x = std::clamp(plane.tilt_x + step.x(), -kSteepest, kSteepest);
    plane.tilt_y = std::clamp(plane.tilt_y + step.y(), -kSteepest, kSteepest);
    plane.height += step.z();
  }
  return plane;
}

std::optional<FloorPlane> FloorTracker::track(const SegmentGrid& grid, float camera_height_m) {
  follow(lowest_level(grid, camera_height_m), grid.width * grid.height);
  if (!height_) return std::nullopt;
  return fit(grid);
}

void label_floor(const FloorPlane& floor, const SegmentOptions& options, SegmentGrid& grid) {
  const auto tolerance = static_cast<float>(options.floor_tolerance_m);
  const float sigma = 3.0F * smooth_sigma(options, grid);
  for (std::size_t i = 0; i < grid.w.size(); ++i) {
    if (grid.w[i] <= 0.0F) continue;
    // An error of w moves the point along its ray: the further below the camera, the more in height.
    const float reach = tolerance + sigma / grid.w[i];
    const float above = grid.z[i] - floor.at(grid.x[i], grid.y[i]);
    if (above < -2.0F * reach) {
      grid.w[i] = 0.0F;
    } else if (above < 0.4F * reach || (above < reach && grid.normal_z[i] > 0.6F)) {
      grid.label[i] = kStructurePart;
    }
  }
}

}  // namespace povslam
