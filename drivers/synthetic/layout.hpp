// Where things stand in each scene, and where they go.
#pragma once

#include <vector>

#include "drivers/synthetic/change.hpp"
#include "drivers/synthetic/ground.hpp"
#include "drivers/synthetic/random.hpp"
#include "drivers/synthetic/scene.hpp"

namespace povslam::synthetic {

inline constexpr double kPathClearance_m = 0.45;  // of anything from the robot's path
inline constexpr double kGap_m = 0.15;            // between things on the floor

// Both plan the change as well and time it while nobody looks; empty: the camera sees too much at once for that.
std::vector<Object> lay_out_boxes(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch);
std::vector<Object> lay_out_aisle(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch);

// People who walk where nothing stands or will stand, clear of the robot's path.
void add_movers(std::vector<Object>& objects, const SyntheticOptions& options, const LapPath& path,
                double room_half_x_m, double room_half_y_m);

// An upright box on the floor, id still to be given.
Object make_box(const Eigen::Vector3d& size_m, Paint paint, ClassId class_id, const Eigen::Vector2d& place, double yaw,
                double bottom_m = 0.0);
void number_objects(std::vector<Object>& objects);  // ids 1 …

// Whether the place is clear of the path and of every place, old or new, of all objects but one.
bool is_free(const Footprint& place, const std::vector<Object>& objects, const Object* except,
             const std::vector<Eigen::Vector2d>& path);

}  // namespace povslam::synthetic
