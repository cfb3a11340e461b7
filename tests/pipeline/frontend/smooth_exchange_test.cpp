#include "pipeline/frontend/smooth_exchange.hpp"

#include <gtest/gtest.h>

#include <random>

#include "pipeline/backend/smooth.hpp"
#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

constexpr int kKeyframes = 6;
constexpr double kLookSigmaPx = 0.2;

FrontendOptions options() {
  FrontendOptions options;
  options.orb.num_features = 300;
  options.map.max_keyframes = 20;
  options.map.max_landmarks = 1000;
  return options;
}

// A drive past a cloud of points, mapped with errors that grow on the way.
struct Drive {
  explicit Drive(double error = 1.0)
      : map(300, options().map, made::level_scales()), exchange(camera, options()), landmark_of(points.size(), kNone) {
    exchange.reserve(problem);
    std::normal_distribution<double> normal(0.0, error);
    for (int k = 0; k < kKeyframes; ++k) {
      truth.push_back(made::looking_along_y({0.15 * k - 0.4, 0.02 * k, 0.0}));
      Vector6d xi;
      for (int i = 0; i < 6; ++i) xi[i] = normal(random) * k * (i < 3 ? 0.003 : 0.0015);
      keep(k, retract(truth.back(), xi), truth.back());
    }
  }
  void keep(int parent_plus_one, const Rigid3& believed, const Rigid3& seen_from) {
    const made::View view = made::view_of(camera, options(), seen_from, points, looks);
    const std::int32_t slot = map.insert_keyframe(view.frame, believed, Matrix6d::Zero(), parent_plus_one - 1);
    for (std::size_t f = 0; f < view.shown.size(); ++f) {
      std::int32_t& landmark = landmark_of[static_cast<std::size_t>(view.shown[f])];
      if (landmark != kNone) {
        map.add_sighting(landmark, slot, static_cast<int>(f));
      } else {
        landmark = map.create_landmark(slot, static_cast<int>(f),
                                       believed * view.frame.point_camera(static_cast<int>(f), camera));
      }
    }
    map.update_covisibility(slot);
  }
  double worst_pose_error() const {
    double worst = 0.0;
    for (int k = 0; k < kKeyframes; ++k) {
      const std::int32_t slot = map.find_keyframe(k);
      if (slot == kNone) continue;
      const Vector6d xi = local(truth[static_cast<std::size_t>(k)], map.keyframe(slot).T_world_camera);
      worst = std::max(worst, xi.norm());
    }
    return worst;
  }
  double worst_point_error() const {
    double worst = 0.0;
    for (std::size_t i = 0; i < points.size(); ++i) {
      if (landmark_of[i] == kNone || !map.landmark(landmark_of[i]).alive) continue;
      worst = std::max(worst, (map.landmark(landmark_of[i]).p_world - points[i]).norm());
    }
    return worst;
  }
  bool cut() { return exchange.cut(map, map.find_keyframe(kKeyframes - 1), 77, kLookSigmaPx, problem); }

  std::mt19937 random{1};
  PinholeCamera camera = made::half_camera();
  std::vector<Eigen::Vector3d> points = made::cloud(200, 1);
  std::vector<Descriptor> looks = made::looks(200, 2);
  std::vector<Rigid3> truth;
  Map map;
  SmoothExchange exchange;
  std::vector<std::int32_t> landmark_of;
  SmoothProblem problem;
};

}  // namespace

TEST(SmoothExchange, MovesKeyframesAndLandmarksWhereTheyBelong) {
  Drive drive;
  EXPECT_GT(drive.worst_pose_error(), 0.01);
  EXPECT_GT(drive.worst_point_error(), 0.01);
  const Rigid3 before = drive.map.keyframe(kKeyframes - 1).T_world_camera;
  ASSERT_TRUE(drive.cut());
  EXPECT_EQ(drive.problem.asked_at_frame, 77);
  EXPECT_EQ(drive.problem.poses.size(), static_cast<std::size_t>(kKeyframes));
  smooth(drive.problem, {});
  ASSERT_TRUE(drive.problem.converged);
  const Rigid3 T_new_old = drive.exchange.apply(drive.map, drive.problem, kKeyframes - 1);
  EXPECT_LT(drive.worst_pose_error(), 0.001);
  EXPECT_LT(drive.worst_point_error(), 0.003);
  EXPECT_LT(local(T_new_old * before, drive.map.keyframe(kKeyframes - 1).T_world_camera).norm(), 1e-12);
}

TEST(SmoothExchange, HoldsTheFirstKeyframeOfAll) {
  Drive drive;
  ASSERT_TRUE(drive.cut());
  for (const SmoothProblem::Pose& pose : drive.problem.poses) EXPECT_EQ(pose.fixed, pose.keyframe == 0);
}

TEST(SmoothExchange, HoldsTheOldestKeyframeWhenNothingElseHoldsTheWindow) {
  Drive drive;
  drive.map.remove_keyframe(drive.map.find_keyframe(0));
  ASSERT_TRUE(drive.cut());
  for (const SmoothProblem::Pose& pose : drive.problem.poses) EXPECT_EQ(pose.fixed, pose.keyframe == 1);
}

TEST(SmoothExchange, HasNothingToSmoothWithOneKeyframe) {
  Drive drive;
  for (std::int64_t id = 0; id + 1 < kKeyframes; ++id) drive.map.remove_keyframe(drive.map.find_keyframe(id));
  EXPECT_FALSE(drive.cut());
  EXPECT_TRUE(drive.problem.observations.empty());
}

// Half of the landmarks keep their first look: where it was taken they stand exactly, elsewhere as their feature does.
TEST(SmoothExchange, TheKeyframeOfAFirstLookSawItAsSharplyAsPatchesFit) {
  Drive drive;
  for (std::size_t i = 0; i < drive.points.size(); i += 2) {
    if (drive.landmark_of[i] != kNone) drive.map.landmark(drive.landmark_of[i]).has_patch = true;
  }
  ASSERT_TRUE(drive.cut());
  int sharp = 0;
  for (const SmoothProblem::Observation& o : drive.problem.observations) {
    const SmoothProblem::Point& p = drive.problem.points[static_cast<std::size_t>(o.point)];
    const Landmark& point = drive.map.landmark(p.landmark);
    const bool first = drive.problem.poses[static_cast<std::size_t>(o.pose)].keyframe == point.born_keyframe;
    EXPECT_EQ(o.sigma_px == static_cast<float>(kLookSigmaPx), point.has_patch && first);
    sharp += o.sigma_px == static_cast<float>(kLookSigmaPx) ? 1 : 0;
  }
  EXPECT_GT(sharp, 50);
}

TEST(SmoothExchange, ChangesNothingForAnAnswerThatDidNotConverge) {
  Drive drive;
  ASSERT_TRUE(drive.cut());
  for (SmoothProblem::Pose& pose : drive.problem.poses) pose.T_world_camera.translation.x() += 1.0;
  for (SmoothProblem::Point& point : drive.problem.points) point.p_world.x() += 1.0;
  for (SmoothProblem::Observation& o : drive.problem.observations) o.outlier = true;
  const double pose_error = drive.worst_pose_error(), point_error = drive.worst_point_error();
  const int landmarks = drive.map.num_landmarks();
  const Rigid3 T_new_old = drive.exchange.apply(drive.map, drive.problem, kKeyframes - 1);
  EXPECT_EQ(local(Rigid3{}, T_new_old).norm(), 0.0);
  EXPECT_EQ(drive.worst_pose_error(), pose_error);
  EXPECT_EQ(drive.worst_point_error(), point_error);
  EXPECT_EQ(drive.map.num_landmarks(), landmarks);
}

TEST(SmoothExchange, TakesAlongWhatWasAddedMeanwhile) {
  Drive drive;
  ASSERT_TRUE(drive.cut());
  // Tracked against keyframe 5 and hence wrong as it is; then one more against that. They see new points, too.
  const Rigid3 wrong = drive.map.keyframe(kKeyframes - 1).T_world_camera * drive.truth.back().inverse();
  const std::size_t old_points = drive.points.size();
  for (const Eigen::Vector3d& p : made::cloud(40, 9)) drive.points.push_back(p);
  drive.looks = made::looks(drive.points.size(), 2);
  drive.landmark_of.resize(drive.points.size(), kNone);
  std::vector<Rigid3> added;
  for (int k = 0; k < 2; ++k) {
    added.push_back(made::looking_along_y({0.15 * (kKeyframes + k) - 0.4, 0.1, 0.0}));
    drive.keep(kKeyframes + k, wrong * added.back(), added.back());
  }
  smooth(drive.problem, {});
  const Rigid3 T_new_old = drive.exchange.apply(drive.map, drive.problem, kKeyframes + 1);
  for (int k = 0; k < 2; ++k) {
    const std::int32_t slot = drive.map.find_keyframe(kKeyframes + k);
    EXPECT_LT(local(added[static_cast<std::size_t>(k)], drive.map.keyframe(slot).T_world_camera).norm(), 0.002) << k;
  }
  EXPECT_LT(local(wrong.inverse(), T_new_old).norm(), 0.002);
  int followed = 0;
  for (std::size_t i = old_points; i < drive.points.size(); ++i) {
    if (drive.landmark_of[i] == kNone) continue;
    ++followed;
    EXPECT_LT((drive.map.landmark(drive.landmark_of[i]).p_world - drive.points[i]).norm(), 0.003);
  }
  EXPECT_GT(followed, 10);
}

TEST(SmoothExchange, SkipsWhatWasRemovedMeanwhile) {
  Drive drive;
  ASSERT_TRUE(drive.cut());
  smooth(drive.problem, {});
  ASSERT_TRUE(drive.problem.converged);
  drive.map.remove_keyframe(drive.map.find_keyframe(3));
  // A landmark whose slot was given to another one.
  const std::int32_t reused = drive.problem.points[10].landmark;
  drive.map.remove_landmark(reused);
  const std::int32_t newest = drive.map.find_keyframe(kKeyframes - 1);
  const auto& seen = drive.map.keyframe(newest).landmark;
  const int feature = static_cast<int>(std::find(seen.begin(), seen.end(), kNone) - seen.begin());
  ASSERT_LT(feature, static_cast<int>(seen.size()));
  ASSERT_EQ(drive.map.create_landmark(newest, feature, {1.0, 2.0, 3.0}), reused);
  std::erase(drive.landmark_of, reused);  // no longer that point; the test's own list shrinks with its points
  for (SmoothProblem::Observation& o : drive.problem.observations) {
    if (o.point == 10) o.outlier = true;  // says nothing about the new landmark
  }
  const Rigid3 old = drive.map.keyframe(newest).T_world_camera;
  const Rigid3 T_new_old = drive.exchange.apply(drive.map, drive.problem, kKeyframes - 1);
  EXPECT_EQ(drive.map.find_keyframe(3), kNone);
  EXPECT_LT(drive.worst_pose_error(), 0.001);
  ASSERT_TRUE(drive.map.landmark(reused).alive);  // it moved with its keyframe, as any that was added
  EXPECT_LT((drive.map.landmark(reused).p_world - T_new_old * Eigen::Vector3d(1.0, 2.0, 3.0)).norm(), 1e-9);
  EXPECT_LT(local(T_new_old * old, drive.map.keyframe(newest).T_world_camera).norm(), 1e-12);
}

TEST(SmoothExchange, ForgetsSightingsThatDoNotFit) {
  Drive drive(0.0);
  const std::int32_t point = drive.map.keyframe(3).landmark[20];
  drive.map.keyframe(3).x[20] += 25.0F;  // a wrong match
  const int sightings = drive.map.landmark(point).num_sightings;
  ASSERT_GT(sightings, 3);
  ASSERT_TRUE(drive.cut());
  smooth(drive.problem, {});
  ASSERT_TRUE(drive.problem.converged);
  drive.exchange.apply(drive.map, drive.problem, kKeyframes - 1);
  EXPECT_FALSE(drive.map.sees(3, point));
  EXPECT_EQ(drive.map.keyframe(3).landmark[20], kNone);
  EXPECT_EQ(drive.map.landmark(point).num_sightings, sightings - 1);
}

TEST(SmoothExchange, StaysWithinItsCapacitiesAndAllocatesNothing) {
  if (!counting_works()) GTEST_SKIP() << "the sanitizer owns malloc";
  Drive drive;
  FrontendOptions tight = options();
  tight.map.smooth_max_poses = 3;
  tight.map.smooth_max_fixed_poses = 2;
  tight.map.smooth_max_points = 50;
  tight.map.smooth_max_observations = 120;
  SmoothExchange exchange(drive.camera, tight);
  SmoothProblem problem;
  exchange.reserve(problem);
  start_counting();
  EXPECT_TRUE(exchange.cut(drive.map, drive.map.find_keyframe(kKeyframes - 1), 1, kLookSigmaPx, problem));
  const CallCounts calls = stop_counting();
  EXPECT_EQ(calls.allocations, 0U);
  EXPECT_EQ(problem.poses.size(), 5U);
  EXPECT_EQ(std::ranges::count_if(problem.poses, [](const auto& pose) { return pose.fixed; }), 2);
  EXPECT_EQ(problem.points.size(), 50U);
  EXPECT_EQ(problem.observations.size(), 120U);
}

}  // namespace povslam
