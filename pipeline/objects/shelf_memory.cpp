#include "pipeline/objects/shelf_memory.hpp"

#include <cmath>

namespace povslam {

namespace {

constexpr float kPlan_m = 0.1F, kHeight_m = 0.02F;
constexpr std::int64_t kPlanBits = 24, kLevels = 1024, kLowest = -256;
constexpr std::size_t kMostPlaces = 500'000;  // some 30 MB
constexpr std::uint32_t kLeastBoards = 3, kMostOthersABoard = 4;

std::int64_t level_of(float z) {
  return static_cast<std::int64_t>(std::floor(z / kHeight_m)) - kLowest;
}

std::int64_t plan_of(float v) {
  return static_cast<std::int64_t>(std::floor(v / kPlan_m));
}

std::int64_t key_of(std::int64_t x, std::int64_t y, std::int64_t level) {
  constexpr std::int64_t kMask = (std::int64_t{1} << kPlanBits) - 1;
  return (((x & kMask) << kPlanBits) | (y & kMask)) * kLevels + level;
}

}  // namespace

// Also beside it: depth is noisier than height.
void ShelfMemory::vote(const Eigen::Vector3f& board) {
  const std::int64_t level = level_of(board.z());
  if (level < 0 || level >= kLevels || places_.size() > kMostPlaces) return;
  levels_[static_cast<std::size_t>(level)] = 1;
  const std::int64_t x = plan_of(camera_.x() + board.x()), y = plan_of(camera_.y() + board.y());
  for (const std::int64_t dx : {-1, 0, 1}) {
    for (const std::int64_t dy : {-1, 0, 1}) {
      Place& place = places_[key_of(x + dx, y + dy, level)];
      if (place.last_board == view_) continue;
      place.last_board = view_;
      ++place.boards;
    }
  }
}

bool ShelfMemory::learn_and_mark(std::span<const Eigen::Vector3f> boards, const Eigen::Vector2d& camera_world,
                                 SegmentGrid& grid) {
  ++view_;
  camera_ = camera_world.cast<float>();
  levels_.resize(static_cast<std::size_t>(kLevels), 0);
  for (const Eigen::Vector3f& board : boards) vote(board);
  bool marked = false;
  for (std::size_t i = 0; i < grid.label.size(); ++i) {
    if (!(grid.w[i] > 0.0F) || grid.label[i] == kStructurePart) continue;
    const std::int64_t level = level_of(grid.z[i]);
    if (level < 0 || level >= kLevels || levels_[static_cast<std::size_t>(level)] == 0) continue;
    const auto found = places_.find(key_of(plan_of(camera_.x() + grid.x[i]), plan_of(camera_.y() + grid.y[i]), level));
    if (found == places_.end()) continue;
    Place& place = found->second;
    if (place.last_other != view_) {
      place.last_other = view_;
      ++place.others;
    }
    if (place.boards < kLeastBoards || kMostOthersABoard * place.boards < place.others) continue;
    grid.label[i] = kStructurePart;
    marked = true;
  }
  return marked;
}

}  // namespace povslam
