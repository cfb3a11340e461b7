#include "drivers/synthetic/world.hpp"

#include <utility>

#include "drivers/synthetic/faces.hpp"
#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

// Goods carry one print on all four sides, and nobody looks below things on the floor: saves time.
int print_of(const Object& object, const Part& part, int face) {
  constexpr int kUpperSide = 4, kLowerSide = 5;
  if (part.paint == Paint::steel || part.paint == Paint::cloth) return 0;
  if (part.paint == Paint::goods) return face < kUpperSide ? 0 : kUpperSide;
  return face == kLowerSide && object.class_id == ClassId::box ? kUpperSide : face;
}

// Stamps survive being written with six decimals.
TimeNs whole_microseconds(double time_s) {
  return static_cast<TimeNs>(time_s * 1e6 + 0.5) * kNsPerUs;
}

}  // namespace

World::World(SyntheticOptions options, RobotMotion motion, Scene scene)
    : options_(std::move(options)), motion_(std::move(motion)), scene_(std::move(scene)) {
  plan_prints();
}

Result<World> World::create(const SyntheticOptions& options) {
  RobotMotion motion(scene_path(options.scene, options.seed), options.speed_mps, options.seed);
  Result<Scene> scene = build_scene(options, motion);
  if (!scene) return scene.error();
  return World(options, std::move(motion), std::move(*scene));
}

// Ids are one more than indices.
void World::share_pictures(const Object& object) {
  const auto first = static_cast<std::size_t>(first_surface_[object.print - 1U]);
  for (std::size_t i = 0; i < object.parts.size() * kFacesPerPart; ++i) picture_of_.push_back(picture_of_[first + i]);
}

void World::plan_prints() {
  for (const Object& object : scene_.objects) {
    first_surface_.push_back(static_cast<int>(picture_of_.size()));
    if (object.print != 0) {
      share_pictures(object);
      continue;
    }
    for (std::size_t p = 0; p < object.parts.size(); ++p) {
      const Part& part = object.parts[p];
      const std::array<FaceShape, kFacesPerPart> faces = faces_of(part);
      const std::size_t first = picture_of_.size();
      for (int i = 0; i < kFacesPerPart; ++i) {
        const FaceShape& face = faces[static_cast<std::size_t>(i)];
        const int print = print_of(object, part, i);
        if (print < i) {
          picture_of_.push_back(picture_of_[first + static_cast<std::size_t>(print)]);
          continue;
        }
        const std::uint64_t seed = mix(mix(options_.seed, object.id), p * kFacesPerPart + static_cast<std::size_t>(i));
        picture_of_.push_back(static_cast<int>(prints_.size()));
        prints_.push_back({part.paint, face.across.norm(), face.down.norm(), seed});
      }
    }
  }
}

Texture World::paint(int picture) const {
  const Print& print = prints_[static_cast<std::size_t>(picture)];
  return paint_face(print.paint, print.width_m, print.height_m, print.seed);
}

TimeNs World::frame_time(std::uint64_t frame) const {
  return whole_microseconds(static_cast<double>(frame) / options_.fps);
}

TimeNs World::start_stamp() const {
  return whole_microseconds(options_.start_time_s);
}

std::uint64_t World::num_frames() const {
  const auto whole = static_cast<std::uint64_t>(motion_.lap_end_s(options_.laps) * options_.fps) + 1;
  return options_.frames > 0 ? std::min(options_.frames, whole) : whole;
}

}  // namespace povslam::synthetic
