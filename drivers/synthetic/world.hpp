// A simulated world with a robot that drives through it: the truth behind the frames.
#pragma once

#include <cstdint>
#include <vector>

#include "drivers/synthetic/options.hpp"
#include "drivers/synthetic/paint.hpp"
#include "drivers/synthetic/scene.hpp"
#include "drivers/synthetic/texture.hpp"
#include "pipeline/base/time.hpp"

namespace povslam::synthetic {

// Times are seconds since the start of the drive. Constant after create(): may be shared between threads.
class World {
 public:
  // Lays out the scene; nothing is painted yet. The options must be valid().
  static Result<World> create(const SyntheticOptions& options);

  const SyntheticOptions& options() const { return options_; }
  const Scene& scene() const { return scene_; }
  Rigid3 T_world_camera(double time_s) const { return motion_.T_world_camera(time_s); }
  Rigid3 T_world_body(double time_s) const { return motion_.T_world_body(time_s); }
  double lap_end_s(double laps) const { return motion_.lap_end_s(laps); }

  std::uint64_t num_frames() const;              // of the camera, in the whole drive
  TimeNs frame_time(std::uint64_t frame) const;  // since the start of the drive, a whole number of microseconds
  TimeNs start_stamp() const;                    // stamp of the start of the drive, likewise

  // What is printed on a face; several may carry one picture. surface as in ProjectedFace.
  int picture(int object, int surface) const {
    return picture_of_[static_cast<std::size_t>(first_surface_[static_cast<std::size_t>(object)] + surface)];
  }
  int num_pictures() const { return static_cast<int>(prints_.size()); }
  Texture paint(int picture) const;  // the same each time; 0.1 to 1 ms, a long wall 7

 private:
  World(SyntheticOptions options, RobotMotion motion, Scene scene);
  struct Print {  // how a picture is made
    Paint paint = Paint::carton;
    double width_m = 0.0, height_m = 0.0;
    std::uint64_t seed = 0;
  };
  void plan_prints();
  void share_pictures(const Object& object);

  SyntheticOptions options_;
  RobotMotion motion_;
  Scene scene_;
  std::vector<Print> prints_;       // by picture
  std::vector<int> picture_of_;     // surface -> picture
  std::vector<int> first_surface_;  // object -> surface
};

}  // namespace povslam::synthetic
