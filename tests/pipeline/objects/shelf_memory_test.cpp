#include "pipeline/objects/shelf_memory.hpp"

#include <gtest/gtest.h>

namespace povslam {

namespace {

const Eigen::Vector2d kHere{0.0, 0.0};
const Eigen::Vector3f kBoard{3.05F, 0.45F, 0.95F};

// A view of one cell, in level axes from below the camera.
struct OneCell {
  explicit OneCell(const Eigen::Vector3f& at) {
    const auto i = static_cast<std::size_t>(cell);
    grid.w[i] = 0.3F;
    grid.x[i] = at.x(), grid.y[i] = at.y(), grid.z[i] = at.z();
    grid.label[i] = kFirstPart;
  }
  bool is_structure() const { return grid.label[static_cast<std::size_t>(cell)] == kStructurePart; }

  SegmentGrid grid{PinholeCamera{640, 480, 525.0, 525.0, 319.5, 239.5, {}}};
  int cell = grid.index(10, 10);
};

void show_board(ShelfMemory& memory, int views) {
  for (int k = 0; k < views; ++k) {
    OneCell seen(kBoard);
    seen.grid.label[static_cast<std::size_t>(seen.cell)] = kStructurePart;
    memory.learn_and_mark({&kBoard, 1}, kHere, seen.grid);
  }
}

bool taken_for_a_board(ShelfMemory& memory, const Eigen::Vector3f& at, const Eigen::Vector2d& camera = kHere) {
  OneCell seen(at);
  const bool told = memory.learn_and_mark({}, camera, seen.grid);
  EXPECT_EQ(told, seen.is_structure());
  return seen.is_structure();
}

}  // namespace

TEST(ShelfMemory, KnowsABoardThatOtherViewsShowed) {
  ShelfMemory memory;
  show_board(memory, 3);
  EXPECT_TRUE(taken_for_a_board(memory, kBoard));
}

TEST(ShelfMemory, DoesNotTrustTwoViews) {
  ShelfMemory memory;
  show_board(memory, 2);
  EXPECT_FALSE(taken_for_a_board(memory, kBoard));
}

TEST(ShelfMemory, FindsItFromWhereTheCameraWent) {
  ShelfMemory memory;
  show_board(memory, 3);
  const Eigen::Vector2d camera(1.5, -0.5);
  EXPECT_TRUE(taken_for_a_board(memory, kBoard - Eigen::Vector3f(1.5F, -0.5F, 0.0F), camera));
  EXPECT_FALSE(taken_for_a_board(memory, kBoard, camera));
}

TEST(ShelfMemory, LeavesWhatStandsOnTheBoardOrElsewhere) {
  ShelfMemory memory;
  show_board(memory, 3);
  EXPECT_FALSE(taken_for_a_board(memory, kBoard + Eigen::Vector3f(0.0F, 0.0F, 0.06F)));
  EXPECT_FALSE(taken_for_a_board(memory, kBoard + Eigen::Vector3f(0.0F, 0.5F, 0.0F)));
}

TEST(ShelfMemory, GivesUpABoardWhereViewsShowSomethingElse) {
  ShelfMemory memory;
  show_board(memory, 3);
  for (int k = 0; k < 12; ++k) EXPECT_TRUE(taken_for_a_board(memory, kBoard)) << k;
  EXPECT_FALSE(taken_for_a_board(memory, kBoard));
}

}  // namespace povslam
