// What values of objects, voxels, empty cells and events must be; store_world_rows.hpp says what it is for.
#include <algorithm>
#include <cmath>

#include "daemon/store_world_rows.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {
namespace {

using Fault = std::optional<std::string>;
constexpr double kUnitTolerance = 1e-6;  // of a quaternion's norm
constexpr std::size_t kMaxNameBytes = 255;

Fault named(const char* kind, std::int64_t id, const char* what) {
  return std::string(kind) + " " + std::to_string(id) + ": " + what;
}

bool in_use(std::int64_t id, std::int64_t next) {
  return id >= 0 && id < next;
}
bool sound(const ObjectPlace& place) {
  return place.position.allFinite() && std::isfinite(place.yaw);
}
bool is_size(const Eigen::Vector3d& size_m) {
  return size_m.allFinite() && (size_m.array() >= 0.0).all();
}
bool is_share(double value) {
  return value >= 0.0 && value <= 1.0;  // false for not-a-number
}
bool sound(const Belief& belief) {
  const bool finite = std::isfinite(belief.mu) && std::isfinite(belief.sigma2) && std::isfinite(belief.alpha) &&
                      std::isfinite(belief.beta);
  return finite && belief.sigma2 > 0.0 && belief.alpha > 0.0 && belief.beta > 0.0;
}

}  // namespace

Fault fault_in(const WorldMeta& meta) {
  return meta.next_object < 0 || meta.next_event_seq < 0 ? Fault("the next ids of objects or events are negative")
                                                         : std::nullopt;
}

Fault fault_in(const ObjectRow& row, const WorldMeta& meta) {
  const ObjectRecord& object = row.object;
  const auto fault = [&object](const char* what) { return named("object", object.id, what); };
  if (!in_use(object.id, meta.next_object)) return fault("the id is not in use");
  if (object.class_name.size() > kMaxNameBytes) return fault("the name of its class is too long");
  if (!sound(object.place)) return fault("the place is none");
  if (!is_size(object.size_m)) return fault("the size is none");
  if (!sound(object.belief)) return fault("the belief is none");
  if (object.observations < 0) return fault("negative counts");
  const Rigid3& T = row.T_world_volume;
  const bool unit = std::abs(T.rotation.norm() - 1.0) < kUnitTolerance;  // false for not-a-number
  if (!unit || !T.translation.allFinite()) return fault("the pose of its volume is none");
  if (!(row.voxel_size_m > 0.0 && row.truncation_m > 0.0 && row.voxel_size_m < 100.0 && row.truncation_m < 100.0)) {
    return fault("the voxels are none");
  }
  const bool known = std::all_of(object.landmarks.begin(), object.landmarks.end(), [](auto id) { return id >= 0; });
  return known ? std::nullopt : fault("has a landmark that cannot be");
}

Fault fault_in(const VoxelBlockRow& row, const WorldMeta& meta) {
  const auto fault = [&row](const char* what) { return named("voxel block of volume", row.volume, what); };
  if (row.volume != kStructureVolume && !in_use(row.volume, meta.next_object)) return fault("the id is not in use");
  if (!number_of(row)) return fault("too far from its volume's origin to be stored");
  const bool whole =
      row.distance.size() == kBlockVoxels && row.weight.size() == kBlockVoxels && row.color.size() == 3 * kBlockVoxels;
  const bool gone = row.distance.empty() && row.weight.empty() && row.color.empty();
  return whole || gone ? std::nullopt : fault("lists of wrong lengths");
}

Fault fault_in(const EmptyCellRow& row, const WorldMeta& /*meta*/) {
  const auto fault = [&row](const char* what) { return named("empty cell at x", row.x, what); };
  if (!number_of(row)) return fault("too far from the world's origin to be stored");
  return row.times < 0 || row.first > row.last ? fault("seen at times that cannot be") : std::nullopt;
}

Fault fault_in(const ObjectEvent& row, const WorldMeta& meta) {
  const auto fault = [&row](const char* what) { return named("event", row.seq, what); };
  if (!in_use(row.seq, meta.next_event_seq)) return fault("the number is not in use");
  if (!in_use(row.object, meta.next_object)) return fault("of an object whose id is not in use");
  if (row.class_name.size() > kMaxNameBytes) return fault("the name of its class is too long");
  if (!sound(row.place) || (row.from && !sound(*row.from))) return fault("the place is none");
  if (!is_size(row.size_m)) return fault("the size is none");
  return is_share(row.consistency) && is_share(row.probability) ? std::nullopt : fault("its figures are none");
}

}  // namespace povslam
