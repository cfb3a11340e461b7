#include "drivers/synthetic/raster.hpp"

#include <algorithm>
#include <cmath>

namespace povslam::synthetic {

namespace {

constexpr double kHorizon_per_m = 1.0 / 60.0;  // the floor ends here, 60 m away

struct Columns {
  double first, last;
};

// Keeps the columns where slope * x + value >= 0.
void keep(Columns& columns, double slope, double value) {
  if (slope > 0.0)
    columns.first = std::max(columns.first, -value / slope);
  else if (slope < 0.0)
    columns.last = std::min(columns.last, -value / slope);
  else if (value < 0.0)
    columns.last = -1.0;
}

}  // namespace

void Raster::cast(const View& view, const std::vector<ProjectedFace>& faces) {
  const PinholeCamera& camera = view.camera();
  w_.resize(camera.width, camera.height);
  hit_.resize(camera.width, camera.height);
  while (column_.size() < static_cast<std::size_t>(camera.width)) column_.push_back(static_cast<float>(column_.size()));
  const Plane floor = view.floor();
  for (int row = 0; row < camera.height; ++row) {
    cast_floor(floor, row);
    for (std::size_t i = 0; i < faces.size(); ++i) {
      if (row < faces[i].row_begin || row >= faces[i].row_end) continue;
      cast_face(faces[i], kFirstFace + static_cast<std::int32_t>(i), row);
    }
  }
}

void Raster::cast_floor(const Plane& floor, int row) {
  const auto value = static_cast<float>(floor.w.at(0.0, row)), slope = static_cast<float>(floor.w.x);
  const auto horizon = static_cast<float>(kHorizon_per_m);
  float* w = w_.row(row);
  std::int32_t* hit = hit_.row(row);
  const float* column = column_.data();
  const int width = w_.width();
  for (int x = 0; x < width; ++x) {
    const float here = value + slope * column[x];
    const bool floor_seen = here > horizon;
    w[x] = floor_seen ? here : 0.0F;
    hit[x] = floor_seen ? kFloor : kSky;
  }
}

void Raster::cast_face(const ProjectedFace& face, std::int32_t id, int row) {
  const double s = face.s.at(0.0, row), t = face.t.at(0.0, row), w0 = face.plane.w.at(0.0, row);
  Columns columns{0.0, w_.width() - 1.0};
  keep(columns, face.s.x, s);
  keep(columns, face.plane.w.x - face.s.x, w0 - s);
  keep(columns, face.t.x, t);
  keep(columns, face.plane.w.x - face.t.x, w0 - t);
  keep(columns, face.plane.w.x, w0);
  if (columns.first > columns.last) return;
  const int first = static_cast<int>(std::ceil(columns.first)), last = static_cast<int>(std::floor(columns.last));
  const auto value = static_cast<float>(w0), slope = static_cast<float>(face.plane.w.x);
  float* w = w_.row(row);
  std::int32_t* hit = hit_.row(row);
  const float* column = column_.data();
  for (int x = first; x <= last; ++x) {
    const float here = value + slope * column[x];
    const bool nearer = here > w[x];
    w[x] = nearer ? here : w[x];
    hit[x] = nearer ? id : hit[x];
  }
}

}  // namespace povslam::synthetic
