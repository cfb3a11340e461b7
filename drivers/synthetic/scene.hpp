// What stands in the simulated world, before and after its change. World: z up, the floor is z = 0, metres.
#pragma once

#include <Eigen/Geometry>
#include <cstdint>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "drivers/synthetic/motion.hpp"
#include "drivers/synthetic/options.hpp"
#include "drivers/synthetic/paint.hpp"

namespace povslam::synthetic {

enum class ClassId : std::uint8_t { none, floor, wall, pillar, rack, box, pallet, goods, forklift, person };

struct ClassRow {  // one row of classes.csv
  ClassId id = ClassId::none;
  const char* name = "";
  const char* kind = "";
};
std::span<const ClassRow> class_table();
const char* class_name(ClassId id);

struct Part {  // a box, aligned with its object's axes
  Eigen::Vector3d center_object = Eigen::Vector3d::Zero();
  Eigen::Vector3d half_m = Eigen::Vector3d::Zero();
  Paint paint = Paint::carton;
};

struct Placement {
  bool present = true;
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, of the centre of the object's bounding box
  double yaw = 0.0;
};

struct Walk {  // to and fro between two places, turning at the ends
  Eigen::Vector3d from = Eigen::Vector3d::Zero(), to = Eigen::Vector3d::Zero();
  double speed_mps = 1.0, start_s = 0.0;
};

enum class Change : std::uint8_t { unchanged, moved, removed, appeared };
const char* to_string(Change change);

struct Object {
  std::uint16_t id = 0;  // 1 …; 0 is no object
  ClassId class_id = ClassId::box;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  std::vector<Part> parts;
  std::uint16_t print = 0;  // id of an earlier object of the same shape whose pictures it carries too; 0: its own
  Placement before, after;
  double switch_time_s = 0.0;  // since the start of the drive; before holds earlier, after from then on
  std::optional<Walk> walk;    // of people; then before and after mean nothing

  Change change() const;
  Placement at(double time_s) const;
};

struct Scene {
  std::vector<Object> objects;
  LapPath path;
  std::vector<Eigen::AlignedBox2d> floors;  // world, where one may stand if nothing is there; the lap's room first
  double twin_pitch_m = 0.0;                // from one place to the next that looks the same, along x; 0: none do
};

// The scene of the options, its change planned and timed so that no place is in view while it changes. Error: the
// camera's view is so wide that nothing can change unseen.
Result<Scene> build_scene(const SyntheticOptions& options, const RobotMotion& motion);

// The lap each scene is driven on.
LapPath scene_path(const std::string& scene, std::uint64_t seed);

}  // namespace povslam::synthetic
