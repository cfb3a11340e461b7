#include "pipeline/objects/row.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

// At y of a row whose fronts face -x at 3 m, 0.5 m wide and 0.6 m high; its bottom is 1 m high.
MapObject thing(std::int64_t id, double y, double depth_m, int end_points) {
  MapObject object(id, VolumeOptions{0.05, 0.2, 10});
  object.class_binds = false;
  object.T_world_volume = upright({3.0 + 0.5 * depth_m, y, 1.3}, 0.0);
  object.seen.box = {Eigen::Vector3d::Zero(), {depth_m, 0.5, 0.6}, 0.0};
  object.seen.sides[1] = 100;
  object.seen.sides[2] = end_points;
  object.box = object.seen.box;
  return object;
}

std::vector<RowMember> row_of(int members, double depth_m, int end_points, std::int64_t first_id = 10) {
  std::vector<RowMember> row;
  for (int i = 0; i < members; ++i) row.push_back(*row_member(thing(first_id + i, 0.7 * i, depth_m, end_points)));
  return row;
}

TEST(RowHabits, SayHowDeepWideAndHighThingsOfTheRowAre) {
  const RowHabits habits = row_habits(thing(1, -0.7, 0.1, 0), row_of(6, 0.3, 20));
  EXPECT_NEAR(habits.depth_m, 0.3, 1e-9);
  EXPECT_NEAR(habits.width_m, 0.5, 1e-9);
  EXPECT_NEAR(habits.height_m, 0.6, 1e-9);
  ASSERT_EQ(habits.bottoms_m.size(), 6U);
  EXPECT_NEAR(habits.bottoms_m.front(), 1.0, 1e-9);
}

TEST(RowHabits, TakeTheDepthFromThoseThatShowIt) {
  std::vector<RowMember> row = row_of(20, 0.08, 1);
  for (const RowMember& member : row_of(5, 0.3, 20, 40)) row.push_back(member);
  EXPECT_NEAR(row_habits(thing(1, -0.7, 0.1, 0), row).depth_m, 0.3, 1e-9);
}

TEST(RowHabits, LetNoSingleMemberSayHowDeepAllAre) {
  std::vector<RowMember> row = row_of(6, 0.3, 20);
  row.push_back(*row_member(thing(30, 5.0, 0.45, 1000)));
  EXPECT_NEAR(row_habits(thing(1, -0.7, 0.1, 0), row).depth_m, 0.3, 1e-9);
}

TEST(RowHabits, AreNotThoseOfWhatStandsBeforeTheRow) {
  std::vector<RowMember> before = row_of(6, 0.8, 20);
  for (RowMember& member : before) member.at.x() -= 1.0;
  EXPECT_EQ(row_habits(thing(1, -0.7, 0.1, 0), before).depth_m, 0.0);
}

TEST(RowHabits, AreNotThoseOfWhatStandsAskew) {
  std::vector<RowMember> askew = row_of(6, 0.3, 20);
  for (RowMember& member : askew) member.yaw = 0.6;
  EXPECT_EQ(row_habits(thing(1, -0.7, 0.1, 0), askew).width_m, 0.0);
}

TEST(RowMember, IsNoPost) {
  MapObject post = thing(1, 0.0, 0.1, 5);
  post.seen.box.size_m = {0.1, 0.1, 0.7};
  EXPECT_TRUE(is_post(post));
  EXPECT_FALSE(row_member(post));
  post.class_binds = true;
  EXPECT_FALSE(is_post(post)) << "what has a sure class is what that says";
}

TEST(BoardUnder, LiesWhereTheRowsBottomsAgree) {
  const std::vector<double> bottoms = {1.0, 1.01, 1.02, 1.03, 0.1, 0.1, 0.1, 0.1, 0.1};
  const auto held_the_board = board_under(bottoms, 0.9, 0.0), lost_its_foot = board_under(bottoms, 1.06, 0.0);
  ASSERT_TRUE(held_the_board && lost_its_foot);
  EXPECT_NEAR(*held_the_board, 1.0, 1e-9);
  EXPECT_NEAR(*lost_its_foot, 1.0, 1e-9);
}

TEST(BoardUnder, IsLookedForAsFarDownAsSomethingHidIt) {
  const std::vector<double> bottoms = {1.0, 1.0, 1.0, 1.0};
  EXPECT_FALSE(board_under(bottoms, 1.4, 0.0)) << "it stands on another thing";
  EXPECT_TRUE(board_under(bottoms, 1.4, 0.4));
}

TEST(BoardUnder, IsNotKnownFromThree) {
  EXPECT_FALSE(board_under(std::vector<double>{1.0, 1.0, 1.0}, 1.0, 0.0));
}

}  // namespace
}  // namespace povslam
