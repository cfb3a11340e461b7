// A map as a floor plan for navigation: the form of ROS' map_server (an image and a YAML file beside it).
#pragma once

#include <cstdint>
#include <filesystem>
#include <vector>

#include "daemon/store.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

struct OccupancyOptions {
  double resolution_m = 0.05;            // edge of a cell
  double min_height_m = 0.1;             // only what lies between the two stands in the way
  double max_height_m = 2.0;             // (z in the world)
  std::int64_t max_cells = 100'000'000;  // a stray landmark must not ask for all memory
};

// Cells by row from the south (smallest y), each from the west (smallest x).
struct OccupancyGrid {
  enum Cell : std::uint8_t { occupied = 0, unknown = 205, free = 254 };  // grey levels of map_server
  int width = 0, height = 0;
  double resolution_m = 0.0;
  double west_m = 0.0, south_m = 0.0;  // outer corner of the first cell, world
  std::vector<std::uint8_t> cells;

  std::uint8_t at(double x_m, double y_m) const;  // unknown outside
};

// Free is what a keyframe's camera looked through to a landmark it sees, as far as the ray runs within the heights;
// occupied is where a landmark lies within them. Fails when nothing lies there, or the grid would be too large.
Result<OccupancyGrid> occupancy_of(const MapContent& map, const OccupancyOptions& options);

// BASE.pgm (top row is north) and BASE.yaml.
Status write_occupancy(const std::filesystem::path& base, const OccupancyGrid& grid);

}  // namespace povslam
