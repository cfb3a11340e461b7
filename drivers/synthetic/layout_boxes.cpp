// The scenes of boxes only: two rings of boxes beside the path, so that some are always near and in view.
#include <algorithm>
#include <cmath>

#include "drivers/synthetic/layout.hpp"

namespace povslam::synthetic {

namespace {

constexpr int kOuterBoxes = 12, kInnerBoxes = 5;
constexpr double kArena_m = 6.0;      // half of the floor's side
constexpr double kLeastShare = 0.19;  // of the image filled by boxes within kReach_m, at every pose
constexpr double kReach_m = 7.0;
constexpr int kLeastBoxes = 4;
constexpr int kAttempts = 60;

int boxes_to_move(const std::string& scene) {
  if (scene == "static") return 0;
  return scene == "majority" ? 11 : 6;
}

bool inside_arena(const Footprint& place) {
  const double radius = place.half_m.norm();
  return std::abs(place.center.x()) + radius <= kArena_m && std::abs(place.center.y()) + radius <= kArena_m;
}

// One box beside the path: `side` > 0 inside the lap. Nothing when all tries fail.
bool add_beside(std::vector<Object>& objects, const LapPath& path, const std::vector<Eigen::Vector2d>& samples,
                double s_m, double side_m, Random& random) {
  for (int attempt = 0; attempt < 80; ++attempt) {
    const LapPath::Pose2 pose = path.at(s_m + random.uniform(-0.35, 0.35));
    const SinCos heading = sin_cos(pose.yaw);
    const double away = side_m + random.uniform(-0.25, 0.25);
    const Eigen::Vector2d place(pose.x - heading.sin * away, pose.y + heading.cos * away);
    const Eigen::Vector3d size(random.uniform(0.6, 1.2), random.uniform(0.6, 1.2), random.uniform(0.65, 1.2));
    Object box = make_box(size, Paint::carton, ClassId::box, place, random.uniform(-kPi, kPi));
    const Footprint ground = footprint(box, box.before);
    if (!inside_arena(ground) || !is_free(ground, objects, nullptr, samples)) continue;
    objects.push_back(std::move(box));
    return true;
  }
  return false;
}

std::vector<Object> place_boxes(const LapPath& path, const std::vector<Eigen::Vector2d>& samples, Random& random) {
  std::vector<Object> objects;
  const double phase = random.uniform(), inner_phase = random.uniform();
  for (int i = 0; i < kOuterBoxes; ++i) {
    add_beside(objects, path, samples, path.length_m() * (i + phase) / kOuterBoxes, -1.25, random);
  }
  for (int i = 0; i < kInnerBoxes; ++i) {
    add_beside(objects, path, samples, path.length_m() * (i + inner_phase) / kInnerBoxes, 1.35, random);
  }
  number_objects(objects);
  return objects;
}

Placement shifted(const Placement& from, const Eigen::Vector2d& by, double yaw) {
  return {true, from.position + Eigen::Vector3d(by.x(), by.y(), 0.0), from.yaw + yaw};
}

bool try_move(std::vector<Object>& objects, Object& box, const Eigen::Vector2d& by, double yaw,
              const std::vector<Eigen::Vector2d>& samples) {
  const Placement to = shifted(box.before, by, yaw);
  const Footprint ground = footprint(box, to);
  if (!inside_arena(ground) || !is_free(ground, objects, &box, samples)) return false;
  box.after = to;
  return true;
}

Eigen::Vector2d random_shift(Random& random) {
  const SinCos direction = sin_cos(random.uniform(-kPi, kPi));
  return random.uniform(0.5, 1.5) * Eigen::Vector2d(direction.cos, direction.sin);
}

int moved_count(const std::vector<Object>& objects) {
  return static_cast<int>(std::count_if(objects.begin(), objects.end(),
                                        [](const Object& object) { return object.change() == Change::moved; }));
}

bool move_boxes(std::vector<Object>& objects, const std::string& scene, const std::vector<Eigen::Vector2d>& samples,
                Random& random) {
  const int wanted = boxes_to_move(scene);
  const bool together = scene == "adversarial";
  const Eigen::Vector2d common = random_shift(random);
  for (int attempt = 0; attempt < 60 * wanted && moved_count(objects) < wanted; ++attempt) {
    Object& box = objects[static_cast<std::size_t>(random.below(static_cast<int>(objects.size())))];
    if (box.change() != Change::unchanged) continue;
    const double yaw = together ? 0.0 : random.uniform(-0.8, 0.8);
    try_move(objects, box, together ? common : random_shift(random), yaw, samples);
  }
  return moved_count(objects) == wanted;
}

}  // namespace

std::vector<Object> lay_out_boxes(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch) {
  const std::vector<Eigen::Vector2d> samples = sample_path(motion.path());
  std::vector<Object> best;
  double best_score = -1.0;
  for (int attempt = 0; attempt < kAttempts && best_score < 1.0; ++attempt) {
    Random random(mix(options.seed, 1000 + static_cast<std::uint64_t>(attempt)));
    std::vector<Object> objects = place_boxes(motion.path(), samples, random);
    if (objects.size() != kOuterBoxes + kInnerBoxes) continue;
    if (!move_boxes(objects, options.scene, samples, random)) continue;
    const Watch::Coverage before = watch.coverage(objects, false, kReach_m),
                          after = watch.coverage(objects, true, kReach_m);
    const double share = std::min(before.least_share, after.least_share) / kLeastShare;
    const double count = std::min(before.least_objects, after.least_objects) / static_cast<double>(kLeastBoxes);
    const double score = std::min({share, count, 1.0});
    if (score <= best_score || !time_changes(objects, motion, watch)) continue;
    best_score = score;
    best = std::move(objects);
  }
  return best;
}

}  // namespace povslam::synthetic
