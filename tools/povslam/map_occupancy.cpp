#include "tools/povslam/map_occupancy.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>
#include <limits>
#include <optional>

#include "tools/povslam/map_points.hpp"

namespace povslam {
namespace {

constexpr double kMargin_m = 0.5;  // unknown around what is known

struct Ray {
  Eigen::Vector3d from, to;  // world
};

// The part of a ray within the heights.
std::optional<Ray> clipped(const Ray& ray, const OccupancyOptions& options) {
  const double rise = ray.to.z() - ray.from.z();
  double begin = 0.0, end = 1.0;
  if (std::abs(rise) < 1e-9) {
    if (ray.from.z() < options.min_height_m || ray.from.z() > options.max_height_m) return std::nullopt;
  } else {
    const double low = (options.min_height_m - ray.from.z()) / rise;
    const double high = (options.max_height_m - ray.from.z()) / rise;
    begin = std::max(begin, std::min(low, high));
    end = std::min(end, std::max(low, high));
  }
  if (begin >= end) return std::nullopt;
  const Eigen::Vector3d along = ray.to - ray.from;
  return Ray{ray.from + begin * along, ray.from + end * along};
}

class Plan {
 public:
  Plan(const MapContent& map, const OccupancyOptions& options) : options_(options), points_(map) {
    for (const KeyframeRow& row : map.keyframes) {
      for (const std::int64_t landmark : row.landmark) {
        const Eigen::Vector3d* p = points_.find(landmark);
        if (p == nullptr) continue;
        if (const auto ray = clipped({row.T_world_camera.translation, *p}, options)) rays_.push_back(*ray);
      }
    }
    for (const auto& [id, p] : points_.all()) {
      if (p.z() >= options.min_height_m && p.z() <= options.max_height_m) obstacles_.push_back(p);
    }
  }

  Result<OccupancyGrid> draw() {
    if (const Status fits = lay_out(); !fits) return fits.error();
    for (const Ray& ray : rays_) sweep(ray);
    for (const Eigen::Vector3d& p : obstacles_) set(p.x(), p.y(), OccupancyGrid::occupied);
    return std::move(grid_);
  }

 private:
  Status lay_out() {
    Eigen::AlignedBox2d box;
    for (const Ray& ray : rays_) box.extend(ray.from.head<2>()).extend(ray.to.head<2>());
    for (const Eigen::Vector3d& p : obstacles_) box.extend(p.head<2>());
    if (box.isEmpty()) return Error{"nothing of the map lies between these heights"};
    // Cells begin at multiples of their size, so that exports of one map lie on one another.
    const double cell = options_.resolution_m;
    const auto begin = [cell](double low) { return std::floor((low - kMargin_m) / cell) * cell; };
    const Eigen::Vector2d sides = box.sizes() + Eigen::Vector2d::Constant(2.0 * (kMargin_m + cell));
    if (!(sides.x() / cell * (sides.y() / cell) <= static_cast<double>(options_.max_cells))) {
      return Error{"the map is " + std::to_string(sides.x()) + " x " + std::to_string(sides.y()) +
                   " m: too many cells; --resolution greater than " + std::to_string(cell) + " makes fewer"};
    }
    grid_.width = static_cast<int>(std::ceil(sides.x() / cell));
    grid_.height = static_cast<int>(std::ceil(sides.y() / cell));
    grid_.resolution_m = cell;
    grid_.west_m = begin(box.min().x());
    grid_.south_m = begin(box.min().y());
    grid_.cells.assign(static_cast<std::size_t>(grid_.width) * static_cast<std::size_t>(grid_.height),
                       OccupancyGrid::unknown);
    return Done{};
  }

  void set(double x_m, double y_m, OccupancyGrid::Cell cell) {
    const auto column = static_cast<std::int64_t>(std::floor((x_m - grid_.west_m) / grid_.resolution_m));
    const auto row = static_cast<std::int64_t>(std::floor((y_m - grid_.south_m) / grid_.resolution_m));
    if (column < 0 || row < 0 || column >= grid_.width || row >= grid_.height) return;
    grid_.cells[static_cast<std::size_t>(row * grid_.width + column)] = cell;
  }

  // Each cell the ray crosses, by going from one grid line to the next (Amanatides & Woo, Eurographics 1987).
  void sweep(const Ray& ray) {
    const double cell = grid_.resolution_m;
    const Eigen::Vector2d from((ray.from.x() - grid_.west_m) / cell, (ray.from.y() - grid_.south_m) / cell);
    const Eigen::Vector2d to((ray.to.x() - grid_.west_m) / cell, (ray.to.y() - grid_.south_m) / cell);
    Eigen::Vector2i at = from.array().floor().cast<int>();
    const Eigen::Vector2i last = to.array().floor().cast<int>();
    Eigen::Vector2i step;
    Eigen::Vector2d next, per_cell;
    for (int axis = 0; axis < 2; ++axis) {
      const double along = to[axis] - from[axis];
      step[axis] = along > 0.0 ? 1 : -1;
      per_cell[axis] = along == 0.0 ? std::numeric_limits<double>::infinity() : 1.0 / std::abs(along);
      const double line = along > 0.0 ? at[axis] + 1.0 : at[axis];
      next[axis] = along == 0.0 ? per_cell[axis] : (line - from[axis]) / along;
    }
    for (int left = (last - at).cwiseAbs().sum(); left >= 0; --left) {
      grid_.cells[static_cast<std::size_t>(at.y()) * static_cast<std::size_t>(grid_.width) +
                  static_cast<std::size_t>(at.x())] = OccupancyGrid::free;
      const int axis = next.x() < next.y() ? 0 : 1;
      if (left > 0) at[axis] += step[axis];
      next[axis] += per_cell[axis];
    }
  }

  OccupancyOptions options_;
  MapPoints points_;
  std::vector<Ray> rays_;
  std::vector<Eigen::Vector3d> obstacles_;
  OccupancyGrid grid_;
};

}  // namespace

std::uint8_t OccupancyGrid::at(double x_m, double y_m) const {
  const double column = std::floor((x_m - west_m) / resolution_m), row = std::floor((y_m - south_m) / resolution_m);
  if (!(column >= 0.0 && row >= 0.0 && column < width && row < height)) return unknown;
  return cells[static_cast<std::size_t>(row) * static_cast<std::size_t>(width) + static_cast<std::size_t>(column)];
}

Result<OccupancyGrid> occupancy_of(const MapContent& map, const OccupancyOptions& options) {
  return Plan(map, options).draw();
}

Status write_occupancy(const std::filesystem::path& base, const OccupancyGrid& grid) {
  const std::filesystem::path image = base.string() + ".pgm", description = base.string() + ".yaml";
  std::ofstream pgm(image, std::ios::binary);
  pgm << "P5\n" << grid.width << " " << grid.height << "\n255\n";
  const auto width = static_cast<std::size_t>(grid.width);
  for (auto row = static_cast<std::size_t>(grid.height); row-- > 0;) {
    pgm.write(reinterpret_cast<const char*>(grid.cells.data() + row * width), grid.width);
  }
  pgm.close();
  if (!pgm) return Error{image.string() + ": cannot be written"};
  std::ofstream yaml(description);
  yaml.precision(12);
  yaml << "image: " << image.filename().string() << "\nresolution: " << grid.resolution_m << "\norigin: ["
       << grid.west_m << ", " << grid.south_m << ", 0.0]\nnegate: 0\noccupied_thresh: 0.65\nfree_thresh: 0.196\n";
  yaml.close();
  if (!yaml) return Error{description.string() + ": cannot be written"};
  return Done{};
}

}  // namespace povslam
