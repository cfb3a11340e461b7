#include "pipeline/objects/fence.hpp"

#include <gtest/gtest.h>

#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

MapObject thing_at(double x, double yaw) {
  MapObject object(1, VolumeOptions{0.05, 0.2, 10});
  object.T_world_volume = upright({x, 0.0, 0.0}, yaw);
  object.box = {Eigen::Vector3d::Zero(), {0.6, 0.4, 0.5}, 0.0};
  return object;
}

// A row of points along world x.
Observation row(double from, double to, std::vector<Fence> fences = {}) {
  Observation seen;
  for (double x = from; x < to; x += 0.02) seen.points_world.emplace_back(static_cast<float>(x), -0.2F, 0.1F);
  seen.fences = std::move(fences);
  return seen;
}

void show(MapObject& object, const Observation& observation, TimeNs stamp) {
  const Observation* one = &observation;
  note_fences(object, {&one, 1}, stamp);
}

const Fence kRight{{0.3, -0.2}, {0.9, 0.4}};

TEST(Fence, IsKnownWhenTwoViewsAgree) {
  MapObject object = thing_at(0.0, 0.0);
  show(object, row(-0.3, 0.3, {kRight}), 1);
  EXPECT_TRUE(known_fences(object).empty());
  show(object, row(-0.3, 0.3, {{{0.33, -0.2}, {1.0, 0.0}}}), 2);
  const auto planes = known_fences(object);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_GT(planes[0].distance_m({0.4, 0.1, 0.0}), 0.05);
  EXPECT_LT(planes[0].distance_m({0.2, 0.1, 0.0}), -0.05);
}

TEST(Fence, FacesAlongTheObjectsOwnAxes) {
  MapObject object = thing_at(0.0, 0.5);
  const Eigen::Vector2d along(std::cos(0.5), std::sin(0.5));
  for (TimeNs stamp = 1; stamp <= 2; ++stamp) {
    show(object, row(-0.3, 0.3, {{0.3 * along, Eigen::Rotation2Dd(0.4) * along}}), stamp);
  }
  const auto planes = known_fences(object);
  ASSERT_EQ(planes.size(), 1U);
  EXPECT_LT((planes[0].outward - Eigen::Vector2d::UnitX()).norm(), 1e-9);
}

TEST(Fence, IsForgottenWhenViewsTakeBothSidesForOneThing) {
  MapObject object = thing_at(0.0, 0.0);
  for (TimeNs stamp = 1; stamp <= 2; ++stamp) show(object, row(-0.3, 0.3, {kRight}), stamp);
  show(object, row(-0.3, 0.9), 3);
  EXPECT_TRUE(known_fences(object).empty()) << "as many views speak against it";
  for (TimeNs stamp = 4; stamp <= 6; ++stamp) show(object, row(-0.3, 0.9), stamp);
  EXPECT_TRUE(object.fences.empty());
}

TEST(Fence, ThatManyViewsFoundIsNotForgottenForOne) {
  MapObject object = thing_at(0.0, 0.0);
  add_firm_fence(object, {0.0, -0.2}, Eigen::Vector2d::UnitX());
  for (int i = 1; i < 40; ++i) show(object, row(-0.3, 0.3), i);
  EXPECT_EQ(known_fences(object).size(), 1U);
}

TEST(Fence, KeepsOffWhatLiesBeyondIt) {
  MapObject object = thing_at(0.0, 0.0), other = thing_at(0.65, 0.0), opposite = thing_at(-0.65, 0.0);
  for (TimeNs stamp = 1; stamp <= 2; ++stamp) show(object, row(-0.3, 0.3, {kRight}), stamp);
  EXPECT_TRUE(fenced_off(object, row(0.35, 0.9)));
  EXPECT_FALSE(fenced_off(object, row(-0.9, -0.3)));
  EXPECT_TRUE(fenced_apart(object, other));
  EXPECT_TRUE(fenced_apart(other, object));
  EXPECT_FALSE(fenced_apart(object, opposite));
}

}  // namespace
}  // namespace povslam
