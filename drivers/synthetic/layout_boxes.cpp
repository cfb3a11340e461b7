// The scenes of boxes only. The lap is two straights and two half turns. Boxes stand close around the half turns,
// where the camera sweeps past them, and three in a row between the straights: so some are always near and in view.
#include <algorithm>
#include <cmath>
#include <utility>

#include "drivers/synthetic/layout.hpp"

namespace povslam::synthetic {

namespace {

constexpr int kBoxes = 17, kBoxesATurn = 7;
constexpr double kArena_m = 6.0;     // half of the floor's side
constexpr double kLeastShare = 0.2;  // of the image filled by boxes within kReach_m, at every pose
constexpr double kReach_m = 7.0;
constexpr int kLeastBoxes = 3;       // of at least 1 % of the image each, at every pose
constexpr double kFarthest_m = 1.5;  // from the path, after a move
constexpr int kLayouts = 30, kTrials = 90, kMoveTrials = 60;

int boxes_to_move(const std::string& scene) {
  if (scene == "static") return 0;
  return scene == "majority" ? 11 : 6;
}

bool inside_arena(const Footprint& place) {
  const double radius = place.half_m.norm();
  return std::abs(place.center.x()) + radius <= kArena_m && std::abs(place.center.y()) + radius <= kArena_m;
}

Object random_box(const Eigen::Vector2d& place, Random& random) {
  const Eigen::Vector3d size(random.uniform(0.7, 1.2), random.uniform(0.7, 1.2), random.uniform(0.75, 1.2));
  return make_box(size, Paint::carton, ClassId::box, place, random.uniform(-kPi, kPi));
}

// Outside of the lap; nothing when all tries fail.
void add_beside(std::vector<Object>& objects, const LapPath& path, const std::vector<Eigen::Vector2d>& samples,
                double s_m, Random& random) {
  constexpr double kAway_m = 1.2;
  for (int attempt = 0; attempt < 80; ++attempt) {
    const LapPath::Pose2 pose = path.at(s_m + random.uniform(-0.3, 0.3));
    const SinCos heading = sin_cos(pose.yaw);
    const double away = kAway_m + random.uniform(-0.15, 0.25);
    Object box = random_box({pose.x + heading.sin * away, pose.y - heading.cos * away}, random);
    const Footprint ground = footprint(box, box.before);
    if (!inside_arena(ground) || !is_free(ground, objects, nullptr, samples)) continue;
    objects.push_back(std::move(box));
    return;
  }
}

void add_between(std::vector<Object>& objects, const std::vector<Eigen::Vector2d>& samples, double x, Random& random) {
  for (int attempt = 0; attempt < 80; ++attempt) {
    Object box = random_box({x + random.uniform(-0.4, 0.4), random.uniform(-0.7, 0.7)}, random);
    if (!is_free(footprint(box, box.before), objects, nullptr, samples)) continue;
    objects.push_back(std::move(box));
    return;
  }
}

void place_in_slot(std::vector<Object>& objects, const LapPath& path, const std::vector<Eigen::Vector2d>& samples,
                   int slot, Random& random) {
  const int turn = slot / kBoxesATurn, i = slot % kBoxesATurn;
  if (turn >= 2) return add_between(objects, samples, 1.8 * (i - 1), random);
  add_beside(objects, path, samples, 0.5 * path.length_m() * (turn + 0.09 + 0.82 * i / (kBoxesATurn - 1)), random);
}

std::vector<Object> place_boxes(const LapPath& path, const std::vector<Eigen::Vector2d>& samples, Random& random) {
  std::vector<Object> objects;
  for (int slot = 0; slot < kBoxes; ++slot) place_in_slot(objects, path, samples, slot, random);
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
  if (!inside_arena(ground) || clearance_m(ground, samples) > kFarthest_m) return false;
  if (!is_free(ground, objects, &box, samples)) return false;
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

// 1: enough is in view everywhere on the lap. The filled share counts most: without it tracking ends.
double score(const std::vector<Object>& objects, bool after, Watch& watch) {
  const Watch::Coverage coverage = watch.coverage(objects, after, kReach_m);
  const double share = std::min(1.0, coverage.least_share / kLeastShare);
  const double count = std::min(1.0, coverage.least_objects / static_cast<double>(kLeastBoxes));
  return 0.8 * share + 0.2 * count;
}

struct Trial {
  std::vector<Object> objects;
  double score = -1.0;
};

// The best of some random layouts, then improved by giving single boxes another place in their slot.
Trial place_well(const LapPath& path, const std::vector<Eigen::Vector2d>& samples, Watch& watch, Random& random) {
  Trial best;
  for (int i = 0; i < kLayouts && best.score < 1.0; ++i) {
    std::vector<Object> objects = place_boxes(path, samples, random);
    if (objects.size() != kBoxes) continue;
    const double reached = score(objects, false, watch);
    if (reached > best.score) best = {std::move(objects), reached};
  }
  for (int i = 0; i < kTrials && best.score < 1.0 && !best.objects.empty(); ++i) {
    std::vector<Object> objects = best.objects;
    const int slot = random.below(kBoxes);
    objects.erase(objects.begin() + slot);
    place_in_slot(objects, path, samples, slot, random);
    if (objects.size() != kBoxes) continue;
    std::rotate(objects.begin() + slot, objects.end() - 1, objects.end());
    number_objects(objects);
    const double reached = score(objects, false, watch);
    if (reached > best.score) best = {std::move(objects), reached};
  }
  return best;
}

}  // namespace

Layout lay_out_boxes(const SyntheticOptions& options, const RobotMotion& motion, Watch& watch) {
  const std::vector<Eigen::Vector2d> samples = sample_path(motion.path());
  Random random(mix(options.seed, 1000));
  const Trial start = place_well(motion.path(), samples, watch, random);
  Trial best;
  for (int i = 0; i < kMoveTrials && best.score < 1.0 && !start.objects.empty(); ++i) {
    std::vector<Object> objects = start.objects;
    if (!move_boxes(objects, options.scene, samples, random)) continue;
    const double reached = score(objects, true, watch);
    if (reached > best.score && time_changes(objects, motion, watch)) best = {std::move(objects), reached};
  }
  return {std::move(best.objects), {{Eigen::Vector2d(-kArena_m, -kArena_m), Eigen::Vector2d(kArena_m, kArena_m)}}};
}

}  // namespace povslam::synthetic
