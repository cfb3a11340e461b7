#include <gtest/gtest.h>

#include "tools/bench/kidnap_score.hpp"

namespace povslam {

namespace {

PoseEstimate claim(TrackState state, double x_m, double sigma_m = 0.01) {
  PoseEstimate pose;
  pose.state = state;
  pose.T_world_camera.translation.x() = x_m;
  pose.covariance = sigma_m * sigma_m * Matrix6d::Identity();
  return pose;
}

synthetic::SyntheticOptions twins() {
  synthetic::SyntheticOptions options;
  options.scene = "twins";
  options.changes = false;
  return options;
}

synthetic::World world_of(const synthetic::SyntheticOptions& options) {
  Result<synthetic::World> world = synthetic::World::create(options);
  EXPECTS(world);
  return std::move(*world);
}

}  // namespace

TEST(TryScore, CountsAHeldPoseApartFromWhatIsClaimedAfterLost) {
  Try tried;
  TryScore score(tried, 3, true);
  score.add(claim(TrackState::degraded, 5.0), {});
  score.add(claim(TrackState::degraded, 5.0, 4.0), {});
  score.add(claim(TrackState::lost, 5.0), {});
  score.add(claim(TrackState::degraded, 0.1), {});
  score.add(claim(TrackState::ok, 0.4), {});
  EXPECT_EQ(tried.held_wrong, 2);
  EXPECT_EQ(tried.held_uncovered, 1);
  EXPECT_EQ(tried.claims, 2);
  EXPECT_EQ(tried.first_right, 3);
  EXPECT_EQ(tried.wrong, 1);
  EXPECT_DOUBLE_EQ(tried.worst.m, 0.4);
}

TEST(TryScore, TakesAPoseThatIsHeldForTooLongAsAClaim) {
  Try tried;
  TryScore score(tried, 3, true);
  for (int i = 0; i < 5; ++i) score.add(claim(TrackState::degraded, 5.0), {});
  EXPECT_EQ(tried.held_wrong, 3);
  EXPECT_EQ(tried.wrong, 2);
}

TEST(TryScore, TakesEveryPoseAsAClaimWhenNothingWasTrackedBefore) {
  Try tried;
  TryScore score(tried, 3, false);
  score.add(claim(TrackState::degraded, 5.0), {});
  EXPECT_EQ(tried.wrong, 1);
}

TEST(PoseError, IsWrongWhenTurnedTooFarOrNoNumber) {
  const Rigid3 turned{so3_exp({0.0, 0.0, 0.1}), Eigen::Vector3d::Zero()};
  EXPECT_NEAR(error_of(turned, {}).deg, 5.73, 0.01);
  EXPECT_TRUE(error_of(turned, {}).wrong());
  Rigid3 none;
  none.translation.x() = std::numeric_limits<double>::quiet_NaN();
  EXPECT_TRUE(error_of(none, {}).wrong());
  EXPECT_FALSE(error_of({}, {}).wrong());
}

TEST(SeenSurfaces, KnowsWhatTheDriveSawAndFromWhere) {
  const synthetic::World world = world_of(twins());
  SeenSurfaces seen(world);
  const Drift ahead{0.0, -2.0, 0.0}, back{4.0, -2.0, synthetic::kPi}, elsewhere{-7.0, 4.6, 0.5 * synthetic::kPi};
  EXPECT_EQ(seen.of(ahead.T_world_camera(0.0), 0.0).seen, 0.0);
  seen.add(ahead.T_world_camera(0.0), 0.0);
  const SeenSurfaces::Share same = seen.of(ahead.T_world_camera(0.0), 0.0);
  EXPECT_GT(same.surfaces, 0.2);
  EXPECT_DOUBLE_EQ(same.seen, same.surfaces);
  EXPECT_DOUBLE_EQ(same.alike, same.surfaces);
  EXPECT_LT(seen.of(back.T_world_camera(0.0), 0.0).alike, 0.05);
  EXPECT_LT(seen.of(elsewhere.T_world_camera(0.0), 0.0).seen, 0.01);
}

TEST(TwinCheck, TellsAViewOfABayFromOneThatSeesItsSurroundings) {
  const synthetic::World world = world_of(twins());
  Result<TwinCheck> check = TwinCheck::create(twins());
  ASSERT_TRUE(check);
  const KidnapTries tries(world, 0.0, 1);
  const Drift bay{1.25, -2.2, -0.5 * synthetic::kPi}, along{1.25, -2.2, 0.0};
  EXPECT_LT(check->least_difference(bay.T_world_camera(0.0), 0.0, tries), 0.01);
  EXPECT_GT(check->least_difference(along.T_world_camera(0.0), 0.0, tries), 0.1);
}

TEST(KidnapTries, StandWhereNothingElseStands) {
  synthetic::SyntheticOptions options = twins();
  options.scene = "rooms";
  const synthetic::World world = world_of(options);
  KidnapTries tries(world, 0.0, 1);
  for (const Place place : {Place::lap, Place::anywhere, Place::other_room}) {
    for (int i = 0; i < 20; ++i) {
      const std::optional<Drift> drift = tries.draw(place, 1.0);
      ASSERT_TRUE(drift);
      const Eigen::Vector3d end = drift->T_world_body(1.0).translation;
      EXPECT_TRUE(tries.is_free(drift->x, drift->y) && tries.is_free(end.x(), end.y()));
      EXPECT_LE((end - drift->T_world_body(0.0).translation).norm(), 0.3 + 1e-9);
      EXPECT_EQ(drift->y > 6.0, place == Place::other_room);
    }
  }
  EXPECT_FALSE(tries.draw(Place::bay, 1.0));
}

}  // namespace povslam
