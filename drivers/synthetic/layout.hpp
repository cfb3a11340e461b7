// Where things stand in each scene, and where they go.
#pragma once

#include <optional>
#include <vector>

#include "drivers/synthetic/change.hpp"
#include "drivers/synthetic/ground.hpp"
#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

inline constexpr double kPathClearance_m = 0.45;  // of anything from the robot's path
inline constexpr double kGap_m = 0.15;            // between things on the floor

inline constexpr double kTwinPitch_m = 2.5;  // from one place of `twins` to the next; exact in binary

struct Layout {
  std::vector<Object> objects;
  std::vector<Eigen::AlignedBox2d> floors;  // see Scene
};

// Both plan the change as well and time it while nobody looks; no objects: the camera sees too much at once for that.
Layout lay_out_boxes(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch);
Layout lay_out_aisle(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch);

// Nothing changes in these.
Layout lay_out_twins(const SyntheticOptions& options, const RobotMotion& motion);
Layout lay_out_rooms(const SyntheticOptions& options, const RobotMotion& motion);
Layout lay_out_hall(const SyntheticOptions& options, const RobotMotion& motion);

// People who walk on the floor where nothing stands or will stand, clear of the robot's path.
void add_movers(std::vector<Object>& objects, const SyntheticOptions& options, const LapPath& path,
                const Eigen::AlignedBox2d& floor);

// An upright box on the floor, id still to be given.
Object make_box(const Eigen::Vector3d& size_m, Paint paint, ClassId class_id, const Eigen::Vector2d& place, double yaw,
                double bottom_m = 0.0);
void number_objects(std::vector<Object>& objects);  // ids 1 …

// Where things are put at random; one longer along y turns them so.
struct Zone {
  double x_min, x_max, y_min, y_max;
};
// Clear of the path and of all objects; square: along the zone's sides, nearly. Nothing when all tries fail.
std::optional<Placement> find_place(const Object& object, const Zone& zone, bool square,
                                    const std::vector<Object>& objects, const std::vector<Eigen::Vector2d>& path,
                                    Random& random);

// Puts a thing that stays; does without it when it finds no place.
void put(std::vector<Object>& objects, Object thing, const Zone& zone, bool square,
         const std::vector<Eigen::Vector2d>& path, Random& random);

// Whether the place is clear of the path and of every place, old or new, of all objects but one.
bool is_free(const Footprint& place, const std::vector<Object>& objects, const Object* except,
             const std::vector<Eigen::Vector2d>& path);

}  // namespace povslam::synthetic
