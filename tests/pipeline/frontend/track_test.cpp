#include "pipeline/frontend/track.hpp"

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include "tests/pipeline/frontend/simulated_view.hpp"
#include "tests/pipeline/smoothing_beside.hpp"

namespace povslam {
namespace {

// A tracker on a simulated drive. Each look takes one frame's time, wherever the camera is.
class Follower {
 public:
  explicit Follower(std::uint64_t seed, const FrontendOptions& options = small_frontend())
      : view_(small_drive(seed)),
        tracker_(view_.calibration(), options, view_.T_world_camera(0.0)),
        smoothing_(tracker_) {}

  const TrackResult& drive() { return give(view_.drive(time_s_), view_.T_world_camera(time_s_)); }
  const TrackResult& stand(const Rigid3& place) { return give(view_.look(place, time_s_), place); }
  const TrackResult& blind() { return give(view_.black(time_s_), truth_); }
  const TrackResult& give(const RgbdFrame& image, const Rigid3& T_world_camera) {
    truth_ = T_world_camera;
    result_ = &tracker_.track(image);
    smoothing_.frame_done();
    time_s_ += view_.period_s();
    return *result_;
  }
  void drive_well_for(double seconds) {
    for (const double end = time_s_ + seconds; time_s_ < end;) {
      ASSERT_EQ(drive().state, TrackState::ok) << time_s_;
      ASSERT_LT(error_m(), 0.05) << time_s_;
    }
  }
  void skip_frame() { time_s_ += view_.period_s(); }

  double error_m() const { return (result_->T_world_camera.translation - truth_.translation).norm(); }
  double error_rad() const { return local(truth_, result_->T_world_camera).tail<3>().norm(); }
  const TrackResult& result() const { return *result_; }
  const Map& map() const { return tracker_.map(); }
  SimulatedView& view() { return view_; }
  double time_s() const { return time_s_; }
  const Rigid3& truth() const { return truth_; }

 private:
  SimulatedView view_;
  double time_s_ = 0.0;
  Tracker tracker_;
  SmoothingBeside<Tracker> smoothing_;
  Rigid3 truth_;
  const TrackResult* result_ = nullptr;
};

Rigid3 turned(double yaw_rad, const Eigen::Vector3d& step = Eigen::Vector3d::Zero()) {
  return {so3_exp({0.0, yaw_rad, 0.0}), step};
}

}  // namespace

TEST(Tracker, FollowsADrive) {
  Follower follower(1);
  follower.drive_well_for(20.0);
  EXPECT_LT(follower.error_rad(), 0.01);
  EXPECT_GT(follower.map().num_keyframes(), 10);
}

TEST(Tracker, FollowsWhenMostFramesAreLost) {
  for (const int lost : {1, 2}) {  // of two, of three
    Follower follower(2);
    for (int i = 0; i < 60; ++i) {
      EXPECT_EQ(follower.drive().state, TrackState::ok) << follower.time_s();
      EXPECT_LT(follower.error_m(), 0.05) << follower.time_s();
      for (int k = 0; k < lost; ++k) follower.skip_frame();
    }
  }
}

TEST(Tracker, BeginsNoMapInTheDark) {
  Follower follower(1);
  for (int i = 0; i < 5; ++i) {
    EXPECT_EQ(follower.blind().state, TrackState::initialising);
    EXPECT_EQ(follower.map().num_keyframes(), 0);
  }
  const Rigid3 start = follower.view().T_world_camera(0.0);
  EXPECT_EQ(follower.stand(start).state, TrackState::ok);
  EXPECT_LT(follower.error_m(), 1e-12);
}

TEST(Tracker, LearnsNothingMoreWhileItStands) {
  Follower follower(3);
  const Rigid3 place = follower.view().T_world_camera(0.0);
  int keyframes = 0, landmarks = 0;
  for (int i = 0; i < 300; ++i) {
    ASSERT_EQ(follower.stand(place).state, TrackState::ok);
    ASSERT_LT(follower.error_m(), 0.01);
    if (i == 9) keyframes = follower.map().num_keyframes(), landmarks = follower.map().num_landmarks();
  }
  EXPECT_EQ(follower.map().num_keyframes(), keyframes);
  EXPECT_LE(follower.map().num_landmarks(), landmarks);
}

TEST(Tracker, HoldsItsPoseInABlackoutAndComesBackByDegrees) {
  Follower follower(4);
  ASSERT_NO_FATAL_FAILURE(follower.drive_well_for(6.0));
  const Rigid3 held = follower.result().T_world_camera, held_odom = follower.result().T_odom_camera;
  const Rigid3 place = follower.truth();
  Matrix6d covariance = follower.result().covariance;
  for (int i = 0; i < 20; ++i) {  // 2 s
    const TrackResult& result = follower.blind();
    EXPECT_EQ(result.state, i < 2 ? TrackState::degraded : TrackState::lost) << i;
    // An answer of smoothing may still come in at first.
    EXPECT_LT(local(held, result.T_world_camera).norm(), 0.01) << i;
    EXPECT_LT(local(held_odom, result.T_odom_camera).norm(), 1e-9) << i;
    EXPECT_EQ(result.num_landmarks, 0);
    const Eigen::SelfAdjointEigenSolver<Matrix6d> growth(result.covariance - covariance);
    EXPECT_GT(growth.eigenvalues().minCoeff(), 1e-4) << i;  // in every direction
    covariance = result.covariance;
  }
  EXPECT_GT(std::sqrt(covariance(0, 0)), 0.3);
  std::vector<TrackState> states;
  for (int i = 0; i < 10; ++i) {  // 1 s
    states.push_back(follower.stand(place).state);
    if (states.back() != TrackState::lost) {
      EXPECT_LT(follower.error_m(), 0.03) << i;
    }
  }
  const auto first = std::find(states.begin(), states.end(), TrackState::degraded);
  const auto ok = std::find(states.begin(), states.end(), TrackState::ok);
  EXPECT_EQ(ok - first, 2);  // the third good frame in a row
  EXPECT_EQ(states.back(), TrackState::ok);
  EXPECT_LT(follower.result().covariance(0, 0), 0.01);
}

TEST(Tracker, FindsItselfAMetreAndTwentyDegreesFromWhereItWas) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Follower follower(seed);
    ASSERT_NO_FATAL_FAILURE(follower.drive_well_for(8.0));
    const Rigid3 place = follower.truth() * turned(0.35, {0.0, 0.0, -1.0});
    for (int i = 0; i < 5; ++i) follower.blind();
    for (int i = 0; i < 10; ++i) {
      const TrackState state = follower.stand(place).state;
      if (state == TrackState::ok) {
        EXPECT_LT(follower.error_m(), 0.03) << seed << ", " << i;
      }
    }
    EXPECT_EQ(follower.result().state, TrackState::ok) << seed;
  }
}

TEST(Tracker, FindsItselfWhenCarriedToAnotherMappedPlace) {
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    Follower follower(seed);
    ASSERT_NO_FATAL_FAILURE(follower.drive_well_for(20.0));
    const Rigid3 place = follower.view().T_world_camera(4.0);
    ASSERT_GT((place.translation - follower.truth().translation).norm(), 2.0);
    for (int i = 0; i < 60; ++i) {
      const TrackState state = follower.stand(place).state;
      if (i < 2) {
        EXPECT_NE(state, TrackState::ok) << seed;
      }
      if (state == TrackState::ok) {
        EXPECT_LT(follower.error_m(), 0.06) << seed << ", " << i;
      }
    }
    EXPECT_EQ(follower.result().state, TrackState::ok) << seed;
  }
}

TEST(Tracker, IsLostInARoomItDoesNotKnow) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Follower follower(seed);
    ASSERT_NO_FATAL_FAILURE(follower.drive_well_for(10.0));
    const Rigid3 held = follower.result().T_world_camera;
    SimulatedView elsewhere(small_drive(seed + 20));
    for (int i = 0; i < 60; ++i) {
      RgbdFrame image = elsewhere.drive(0.5 * i);
      image.stamp = image.depth_stamp = from_seconds(follower.time_s());
      const TrackResult& result = follower.give(image, held);
      EXPECT_NE(result.state, TrackState::ok) << seed << ", " << i;
      EXPECT_LT(follower.error_m(), 0.02) << seed << ", " << i;
    }
    EXPECT_EQ(follower.result().state, TrackState::lost) << seed;
  }
}

TEST(Tracker, BeginsAgainInDoubtWhenItsMapWasOfOneMoment) {
  Follower follower(1);
  ASSERT_EQ(follower.drive().state, TrackState::ok);
  const std::uint32_t version = follower.result().map_version;
  SimulatedView elsewhere(small_drive(21));
  bool lost = false;
  double past_lost_s = 0.0;
  Rigid3 T_here_there;
  for (int i = 0; past_lost_s < 1.0; ++i) {
    ASSERT_LT(i, 300) << "it looks for its first moment for ever";
    const double time_s = 0.5 + 1.0 * i / 30.0;
    RgbdFrame image = elsewhere.drive(time_s);
    image.stamp = image.depth_stamp = from_seconds(follower.time_s());
    const TrackResult& result = follower.give(image, Rigid3());
    lost = lost || result.state == TrackState::lost;
    if (!lost || result.state == TrackState::lost) continue;
    if (past_lost_s == 0.0) T_here_there = result.T_world_camera * elsewhere.T_world_camera(time_s).inverse();
    const Rigid3 followed = T_here_there * elsewhere.T_world_camera(time_s);
    EXPECT_LT((result.T_world_camera.translation - followed.translation).norm(), 0.05) << i;
    EXPECT_GT(std::sqrt(result.covariance.topLeftCorner<3, 3>().trace()), 1.0) << "where it stands is not known";
    past_lost_s += elsewhere.period_s();
  }
  EXPECT_TRUE(lost);
  EXPECT_EQ(follower.result().state, TrackState::ok);
  EXPECT_GT(follower.result().map_version, version);
}

TEST(Tracker, KeepsTheMapOfOneMomentThroughALongBlackout) {
  Follower follower(1);
  const Rigid3 place = follower.view().T_world_camera(0.0);
  for (int i = 0; i < 10; ++i) ASSERT_EQ(follower.stand(place).state, TrackState::ok);
  ASSERT_LE(follower.map().num_keyframes(), 3);
  const std::int64_t keyframes_made = follower.map().next_keyframe_id();
  for (int i = 0; i < 150; ++i) follower.blind();
  EXPECT_EQ(follower.result().state, TrackState::lost);
  for (int i = 0; i < 15; ++i) follower.stand(place);
  EXPECT_EQ(follower.result().state, TrackState::ok);
  EXPECT_LT(follower.error_m(), 0.02);
  EXPECT_EQ(follower.map().next_keyframe_id(), keyframes_made);
  EXPECT_LT(std::sqrt(follower.result().covariance.topLeftCorner<3, 3>().trace()), 0.1);
}

TEST(Tracker, SaysWhenItSeesLittle) {
  // Only a corner of the image shows anything.
  Follower follower(1);
  ASSERT_NO_FATAL_FAILURE(follower.drive_well_for(3.0));
  bool degraded = false;
  for (int height = 240; height > 20; height -= 5) {
    RgbdFrame image = follower.view().drive(3.0);
    image.stamp = image.depth_stamp = from_seconds(follower.time_s());
    for (int y = height; y < 240; ++y) std::fill_n(image.color.row(y), image.color.stride(), std::uint8_t{0});
    const TrackResult& result = follower.give(image, follower.view().T_world_camera(3.0));
    if (result.state == TrackState::ok) {
      EXPECT_GE(result.num_landmarks, 30);
    }
    if (result.state != TrackState::lost && result.num_landmarks > 0) {
      EXPECT_GE(result.num_landmarks, 12);
      EXPECT_LT(follower.error_m(), 0.1) << height;
    }
    degraded = degraded || result.state == TrackState::degraded;
  }
  EXPECT_TRUE(degraded);
}

TEST(TrackerDeathTest, RefusesImagesOfAnotherSize) {
  GTEST_FLAG_SET(death_test_style, "threadsafe");
  Follower follower(1);
  RgbdFrame image;
  image.color.resize(160, 120, 3);
  image.depth.resize(160, 120);
  image.color.fill(0);
  image.depth.fill(0);
  EXPECT_DEATH(follower.give(image, {}), "contract failed");
}

}  // namespace povslam
