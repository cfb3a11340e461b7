#include "pipeline/mapping/depth_view.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {

// Raw pixel of each one of the undistorted image, -1: outside.
std::vector<std::int32_t> rectification(const PinholeCamera& camera) {
  std::vector<std::int32_t> source;
  source.reserve(static_cast<std::size_t>(camera.width) * static_cast<std::size_t>(camera.height));
  for (int y = 0; y < camera.height; ++y) {
    for (int x = 0; x < camera.width; ++x) {
      const auto raw = camera.project({(x - camera.cx) / camera.fx, (y - camera.cy) / camera.fy, 1.0});
      std::int32_t pixel = -1;
      if (raw && raw->x() > -0.5 && raw->y() > -0.5 && raw->x() < camera.width - 0.5 &&
          raw->y() < camera.height - 0.5) {
        pixel = static_cast<std::int32_t>(std::lround(raw->y())) * camera.width +
                static_cast<std::int32_t>(std::lround(raw->x()));
      }
      source.push_back(pixel);
    }
  }
  return source;
}

void rectify_color(const std::vector<std::int32_t>& source, const ImageU8& raw, ImageU8& color) {
  const auto channels = static_cast<std::size_t>(raw.channels());
  color.resize(raw.width(), raw.height(), raw.channels());
  for (std::size_t k = 0; k < source.size(); ++k) {
    const auto from = static_cast<std::size_t>(std::max(source[k], 0));
    for (std::size_t c = 0; c < channels; ++c) {
      color.data()[k * channels + c] = source[k] < 0 ? std::uint8_t{0} : raw.data()[from * channels + c];
    }
  }
}

}  // namespace

DepthViewBuilder::DepthViewBuilder(const PinholeCamera& camera, const DepthViewOptions& options)
    : camera_(camera), options_(options) {
  EXPECTS(camera.valid() && options.min_depth_m >= 0.0 && options.max_depth_m > options.min_depth_m);
  if (camera.distorted()) source_ = rectification(camera);
}

void DepthViewBuilder::build(const RgbdFrame& frame, const Rigid3& T_world_camera, DepthView& view) const {
  EXPECTS(frame.depth.width() == camera_.width && frame.depth.height() == camera_.height && frame.depth_scale > 0.0F);
  view.stamp = frame.stamp;
  view.camera = camera_;
  view.camera.distortion = {};
  view.T_world_camera = T_world_camera;
  view.min_depth_m = options_.min_depth_m;
  view.max_depth_m = options_.max_depth_m;
  view.owner.resize(camera_.width, camera_.height);
  view.owner.fill(kNobody);

  view.depth_m.resize(camera_.width, camera_.height);
  const float per_unit = 1.0F / frame.depth_scale;
  const auto least = static_cast<float>(options_.min_depth_m), most = static_cast<float>(options_.max_depth_m);
  const auto metres = [=](std::uint16_t units) {
    const float depth_m = static_cast<float>(units) * per_unit;
    return units > 0 && depth_m >= least && depth_m <= most ? depth_m : 0.0F;
  };
  const std::size_t pixels = view.depth_m.size();
  const std::uint16_t* units = frame.depth.data();
  float* depth_m = view.depth_m.data();
  if (source_.empty()) {
    for (std::size_t k = 0; k < pixels; ++k) depth_m[k] = metres(units[k]);
  } else {
    for (std::size_t k = 0; k < pixels; ++k) depth_m[k] = source_[k] < 0 ? 0.0F : metres(units[source_[k]]);
  }

  const int channels = frame.color.channels();
  if (frame.color.width() != camera_.width || frame.color.height() != camera_.height ||
      (channels != 1 && channels != 3)) {
    view.color.resize(0, 0);
  } else if (source_.empty()) {
    view.color = frame.color;
  } else {
    rectify_color(source_, frame.color, view.color);
  }
}

void DepthViewBuilder::rectify_labels(const LabelFrame& labels, ImageU8& classes) const {
  classes.resize(camera_.width, camera_.height);
  if (labels.classes.empty()) return classes.fill(0);
  const auto place = [](int at, int size, int from_size) {
    return static_cast<int>((2 * static_cast<std::int64_t>(at) + 1) * from_size /
                            (2 * static_cast<std::int64_t>(size)));
  };
  std::vector<int> columns(static_cast<std::size_t>(camera_.width));
  for (int x = 0; x < camera_.width; ++x)
    columns[static_cast<std::size_t>(x)] = place(x, camera_.width, labels.classes.width());
  for (int y = 0; y < camera_.height; ++y) {
    std::uint8_t* out = classes.row(y);
    for (int x = 0; x < camera_.width; ++x) {
      const int raw = source_.empty() ? y * camera_.width + x
                                      : source_[static_cast<std::size_t>(y) * static_cast<std::size_t>(camera_.width) +
                                                static_cast<std::size_t>(x)];
      if (raw < 0) {
        out[x] = 0;
        continue;
      }
      const int row = place(raw / camera_.width, camera_.height, labels.classes.height());
      out[x] = labels.classes.at(columns[static_cast<std::size_t>(raw % camera_.width)], row);
    }
  }
}

}  // namespace povslam
