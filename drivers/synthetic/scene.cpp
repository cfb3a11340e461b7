#include "drivers/synthetic/scene.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/synthetic/change.hpp"
#include "drivers/synthetic/layout.hpp"
#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr std::array<ClassRow, 10> kClasses = {{{ClassId::none, "unlabelled", "ignore"},
                                                {ClassId::floor, "floor", "structure"},
                                                {ClassId::wall, "wall", "structure"},
                                                {ClassId::pillar, "pillar", "structure"},
                                                {ClassId::rack, "rack", "structure"},
                                                {ClassId::box, "box", "semi_static"},
                                                {ClassId::pallet, "pallet", "semi_static"},
                                                {ClassId::goods, "goods", "semi_static"},
                                                {ClassId::forklift, "forklift", "semi_static"},
                                                {ClassId::person, "person", "dynamic"}}};

double heading(const Eigen::Vector3d& from, const Eigen::Vector3d& to) {
  return std::atan2(to.y() - from.y(), to.x() - from.x());
}

Placement walking(const Walk& walk, double time_s) {
  const double length = (walk.to - walk.from).norm();
  const double way = std::max(0.0, time_s - walk.start_s) * walk.speed_mps / length;
  const double round = way - 2.0 * std::floor(0.5 * way);
  const double share = round < 1.0 ? round : 2.0 - round;
  const double yaw = heading(walk.from, walk.to);
  return {true, walk.from + share * (walk.to - walk.from), round < 1.0 ? yaw : yaw + kPi};
}

Layout lay_out(const SyntheticOptions& options, const RobotMotion& motion) {
  if (options.scene == "twins") return lay_out_twins(options, motion);
  if (options.scene == "rooms") return lay_out_rooms(options, motion);
  if (options.scene == "hall") return lay_out_hall(options, motion);
  Watch watch(options.camera, motion);
  return options.scene == "aisle" ? lay_out_aisle(options, motion, watch) : lay_out_boxes(options, motion, watch);
}

}  // namespace

std::span<const ClassRow> class_table() {
  return kClasses;
}

const char* class_name(ClassId id) {
  return kClasses[static_cast<std::size_t>(id)].name;
}

const char* to_string(Change change) {
  switch (change) {
    case Change::unchanged:
      return "unchanged";
    case Change::moved:
      return "moved";
    case Change::removed:
      return "removed";
    case Change::appeared:
      return "appeared";
  }
  return "";
}

Change Object::change() const {
  if (before.present && !after.present) return Change::removed;
  if (!before.present && after.present) return Change::appeared;
  const bool same = before.position == after.position && before.yaw == after.yaw;
  return same ? Change::unchanged : Change::moved;
}

Placement Object::at(double time_s) const {
  if (walk) return walking(*walk, time_s);
  return time_s < switch_time_s ? before : after;
}

LapPath scene_path(const std::string& scene, std::uint64_t seed) {
  Random random(mix(seed, 303));
  if (scene == "aisle" || scene == "twins" || scene == "rooms") return {5.6, 2.0, 3.0};
  if (scene == "hall") return {13.4, 4.4, 3.0};
  return {random.uniform(3.55, 3.75), random.uniform(2.1, 2.2), 3.15};
}

Result<Scene> build_scene(const SyntheticOptions& options, const RobotMotion& motion) {
  Layout layout = lay_out(options, motion);
  if (layout.objects.empty()) {
    return Error{
        "synthetic: no layout of scene '" + options.scene +
        "' lets its objects change unseen by this camera; narrow its view (larger fx, fy) or take another seed"};
  }
  if (!options.changes) {
    for (Object& object : layout.objects) object.after = object.before;
    std::erase_if(layout.objects, [](const Object& object) { return !object.before.present; });
  }
  add_movers(layout.objects, options, motion.path(), layout.floors.front());
  return Scene{std::move(layout.objects), motion.path(), std::move(layout.floors),
               options.scene == "twins" ? kTwinPitch_m : 0.0};
}

}  // namespace povslam::synthetic
