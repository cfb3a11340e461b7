// What a row's values must be; store_rows.hpp says what it is for.
#include <algorithm>
#include <cmath>

#include "daemon/store_rows.hpp"

namespace povslam {
namespace {

using Fault = std::optional<std::string>;
constexpr double kUnitTolerance = 1e-6;  // of a quaternion's norm

bool finite(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); });
}
bool finite_and_not_negative(std::span<const float> values) {
  return std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value) && value >= 0.0F; });
}

Fault named(const char* kind, std::int64_t id, const char* what) {
  return std::string(kind) + " " + std::to_string(id) + ": " + what;
}

bool in_use(std::int64_t id, std::int64_t next) {
  return id >= 0 && id < next;
}
bool in_use_or_none(std::int64_t id, std::int64_t next) {
  return id >= -1 && id < next;
}

}  // namespace

Fault fault_in(const MapMeta& meta) {
  if (meta.next_keyframe < 0 || meta.next_landmark < 0) return "the map's next ids are negative";
  const bool numbers = std::isfinite(meta.cx) && std::isfinite(meta.cy) && std::isfinite(meta.level_scale);
  const bool camera = std::isfinite(meta.fx) && std::isfinite(meta.fy) && meta.fx >= 0.0 && meta.fy >= 0.0;
  return numbers && camera ? std::nullopt : Fault("the map's camera is none");
}

Fault fault_in(const KeyframeFeatures& row, const MapMeta& meta) {
  const auto fault = [&row](const char* what) { return named("features of keyframe", row.keyframe, what); };
  const std::size_t count = row.x.size();
  const bool one_length = row.y.size() == count && row.sigma_px.size() == count && row.inverse_depth.size() == count &&
                          row.sigma_inverse_depth.size() == count && row.level.size() == count &&
                          row.descriptor.size() == count && (row.word.empty() || row.word.size() == count);
  if (!in_use(row.keyframe, meta.next_keyframe)) return fault("the id is not in use");
  if (!one_length) return fault("lists of different lengths");
  if (!finite(row.x) || !finite(row.y)) return fault("a position is no number");
  if (!finite_and_not_negative(row.sigma_px) || !finite_and_not_negative(row.inverse_depth) ||
      !finite_and_not_negative(row.sigma_inverse_depth)) {
    return fault("an uncertainty or inverse depth is negative or no number");
  }
  const bool known_levels =
      std::all_of(row.level.begin(), row.level.end(), [](int level) { return level < kMaxPyramidLevels; });
  return known_levels ? std::nullopt : fault("a pyramid level that there is none of");
}

Fault fault_in(const KeyframeRow& row, const MapMeta& meta) {
  const auto fault = [&row](const char* what) { return named("keyframe", row.keyframe, what); };
  if (!in_use(row.keyframe, meta.next_keyframe)) return fault("the id is not in use");
  if (!in_use_or_none(row.parent, meta.next_keyframe) || row.parent == row.keyframe) return fault("impossible parent");
  const bool unit = std::abs(row.T_world_camera.rotation.norm() - 1.0) < kUnitTolerance;  // false for not-a-number
  if (!unit || !row.T_world_camera.translation.allFinite()) return fault("the pose is none");
  if (!row.covariance.allFinite()) return fault("the covariance is none");
  const bool known = std::all_of(row.landmark.begin(), row.landmark.end(),
                                 [&meta](std::int64_t id) { return in_use_or_none(id, meta.next_landmark); });
  return known ? std::nullopt : fault("sees a landmark whose id is not in use");
}

Fault fault_in(const LandmarkRow& row, const MapMeta& meta) {
  const auto fault = [&row](const char* what) { return named("landmark", row.landmark, what); };
  if (!in_use(row.landmark, meta.next_landmark)) return fault("the id is not in use");
  if (!in_use(row.anchor, meta.next_keyframe)) return fault("impossible anchor");
  if (!in_use_or_none(row.born_keyframe, meta.next_keyframe)) return fault("impossible first keyframe");
  if (!row.p_anchor.allFinite()) return fault("the place is none");
  if (!row.tangent_x_anchor.allFinite() || !row.tangent_y_anchor.allFinite()) return fault("the surface is none");
  return row.visible >= 0 && row.found >= 0 ? std::nullopt : fault("negative counts");
}

Fault fault_in(const LandmarkLook& row, const MapMeta& meta) {
  if (in_use(row.landmark, meta.next_landmark)) return std::nullopt;
  return named("look of landmark", row.landmark, "the id is not in use");
}

}  // namespace povslam
