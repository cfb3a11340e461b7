#include "pipeline/pipeline.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <deque>
#include <vector>

#include "tests/pipeline/frontend/simulated_view.hpp"
#include "tests/pipeline/smoothing_beside.hpp"

namespace povslam {
namespace {

PipelineOptions small_pipeline() {
  PipelineOptions options;
  options.frontend = small_frontend();
  return options;
}

// A pipeline on a simulated drive.
struct Ride {
  explicit Ride(std::uint64_t seed, const PipelineOptions& options = small_pipeline())
      : view(small_drive(seed)),
        pipeline(options, view.calibration(), view.T_world_body(0.0)),
        smoothing(pipeline, options.backend.delay_frames) {}

  const PoseEstimate& next() {
    const RgbdFrame& image = view.drive(time_s);
    T_world_body = view.T_world_body(time_s);
    time_s += view.period_s();
    const PoseEstimate& estimate = pipeline.localise(image);
    error = local(T_world_body, estimate.T_world_body);
    answer_enters = answer_given;
    answer_given = smoothing.frame_done();
    return estimate;
  }

  SimulatedView view;
  Pipeline pipeline;
  SmoothingBeside<Pipeline> smoothing;
  double time_s = 0.0;
  Rigid3 T_world_body;                               // truth…
  Vector6d error = Vector6d::Zero();                 // …and the newest estimate's error
  bool answer_enters = false, answer_given = false;  // with the newest frame, with the next
};

std::vector<double> numbers(const PoseEstimate& e) {
  std::vector<double> all{static_cast<double>(e.stamp),
                          static_cast<double>(e.seq),
                          static_cast<double>(e.state),
                          static_cast<double>(e.num_features),
                          static_cast<double>(e.num_landmarks),
                          static_cast<double>(e.keyframe),
                          static_cast<double>(e.reference_keyframe)};
  for (const Rigid3* T : {&e.T_world_camera, &e.T_world_body, &e.T_odom_body, &e.T_reference_camera}) {
    all.insert(all.end(), T->rotation.coeffs().data(), T->rotation.coeffs().data() + 4);
    all.insert(all.end(), T->translation.data(), T->translation.data() + 3);
  }
  all.insert(all.end(), e.covariance.data(), e.covariance.data() + 36);
  return all;
}

}  // namespace

TEST(Pipeline, IsNeverLostOnAWholeLap) {
  Ride ride(1);
  double squared = 0.0;
  int frames = 0;
  while (ride.time_s < ride.view.lap_s()) {
    const PoseEstimate& estimate = ride.next();
    ASSERT_EQ(estimate.state, TrackState::ok) << ride.time_s;
    ASSERT_LT(ride.error.head<3>().norm(), 0.08) << ride.time_s;
    ASSERT_LT(ride.error.tail<3>().norm(), 0.03) << ride.time_s;
    squared += ride.error.head<3>().squaredNorm();
    ++frames;
  }
  EXPECT_GT(frames, 300);
  EXPECT_GT(ride.smoothing.answers(), 10);
  EXPECT_LT(std::sqrt(squared / frames), 0.04);
}

TEST(Pipeline, KnowsHowFarItMayBeOff) {
  constexpr int kSeeds = 10;
  double mean = 0.0;
  for (std::uint64_t seed = 1; seed <= kSeeds; ++seed) {
    Ride ride(seed);
    Matrix6d covariance;
    for (int i = 0; i < 80; ++i) covariance = ride.next().covariance;
    mean += ride.error.dot(covariance.ldlt().solve(ride.error)) / kSeeds;
  }
  // The mean of ten squared errors, 6 dof each: 95 % of chi2 with 60 dof.
  EXPECT_GT(mean, 40.48 / kSeeds);
  EXPECT_LT(mean, 83.30 / kSeeds);
}

TEST(Pipeline, KeepsOdometryContinuousWhenAnswersEnter) {
  Ride ride(2);
  int corrected = 0;
  Rigid3 odom_before, truth_before;
  for (int i = 0; i < 120; ++i) {
    const PoseEstimate& estimate = ride.next();
    if (i > 0) {
      const Rigid3 moved = truth_before.inverse() * ride.T_world_body;
      EXPECT_LT(local(moved, odom_before.inverse() * estimate.T_odom_body).norm(), 0.02) << i;
      corrected += ride.answer_enters ? 1 : 0;
    }
    odom_before = estimate.T_odom_body;
    truth_before = ride.T_world_body;
  }
  EXPECT_GT(corrected, 5);
}

TEST(Pipeline, MovesTheWorldAndNotOdometryWhenTheMapIsCorrected) {
  SimulatedView view(small_drive(2));
  PipelineOptions options = small_pipeline();
  options.backend.delay_frames = 1;
  Pipeline pipeline(options, view.calibration(), view.T_world_body(0.0));
  const Eigen::Vector3d correction(0.06, -0.08, 0.0);
  double time_s = 0.0;
  SmoothProblem* problem = nullptr;
  const auto take_window = [&pipeline]() -> SmoothProblem* {
    const auto job = pipeline.take_job();
    return job ? std::get<SmoothProblem*>(*job) : nullptr;
  };
  Rigid3 truth, world, odom;
  const auto next = [&] {
    const PoseEstimate& estimate = pipeline.localise(view.drive(time_s));
    truth = view.T_world_body(time_s);
    world = estimate.T_world_body;
    odom = estimate.T_odom_body;
    time_s += view.period_s();
    EXPECT_EQ(estimate.state, TrackState::ok) << time_s;
  };
  for (int i = 0; i < 50; ++i) {
    next();
    if (problem != nullptr) pipeline.give_back(problem);  // as it was
    problem = take_window();
  }
  while (problem == nullptr) next(), problem = take_window();
  // An answer that moves all there is, the ground the window stands on as well.
  for (SmoothProblem::Pose& pose : problem->poses) {
    pose.T_world_camera.translation += correction;
    pose.fixed = false;
  }
  for (SmoothProblem::Point& point : problem->points) point.p_world += correction;
  problem->converged = true;
  pipeline.give_back(problem);
  const Rigid3 truth_before = truth, world_before = world, odom_before = odom;
  next();
  const Rigid3 moved = truth_before.inverse() * truth;
  EXPECT_LT(local(moved, odom_before.inverse() * odom).norm(), 0.01);
  EXPECT_LT((world.translation - (world_before * moved).translation - correction).norm(), 0.01);
}

TEST(Pipeline, TakesAnAnswerInAtItsFrameHoweverEarlyItCame) {
  // One is solved at once, one just before it is due.
  SimulatedView view(small_drive(2));
  const PipelineOptions options = small_pipeline();
  Pipeline early(options, view.calibration(), view.T_world_body(0.0));
  Pipeline late(options, view.calibration(), view.T_world_body(0.0));
  std::deque<std::pair<int, BackendJob>> waiting;
  int answers = 0;
  for (int i = 0; i < 60; ++i) {
    const RgbdFrame frame = view.drive(i * view.period_s());
    for (; !waiting.empty() && waiting.front().first == i; waiting.pop_front()) late.give_back(waiting.front().second);
    const Rigid3 a = early.localise(frame).T_world_camera, b = late.localise(frame).T_world_camera;
    ASSERT_EQ(a.translation, b.translation) << i;
    ASSERT_EQ(a.rotation.coeffs(), b.rotation.coeffs()) << i;
    while (const auto job = early.take_job()) {
      solve(*job, options.backend);
      early.give_back(*job);
      ++answers;
    }
    while (const auto job = late.take_job()) {
      solve(*job, options.backend);
      waiting.emplace_back(i + options.backend.delay_frames, *job);
    }
  }
  EXPECT_GT(answers, 3);
}

TEST(Pipeline, NamesAKeyframeThePoseHangsOn) {
  Ride ride(3);
  for (int i = 0; i < 60; ++i) {
    const PoseEstimate& estimate = ride.next();
    const auto T_world_reference = ride.pipeline.keyframe_pose(estimate.reference_keyframe);
    ASSERT_TRUE(T_world_reference);
    EXPECT_LT(local(estimate.T_world_camera, *T_world_reference * estimate.T_reference_camera).norm(), 1e-9) << i;
    const Rigid3 T_body_camera = ride.view.calibration().T_body_sensor;
    EXPECT_LT(local(estimate.T_world_camera, estimate.T_world_body * T_body_camera).norm(), 1e-9) << i;
  }
}

TEST(Pipeline, BeginsWhereItIsTold) {
  Ride ride(1);
  const PoseEstimate& estimate = ride.next();
  EXPECT_EQ(estimate.state, TrackState::ok);
  EXPECT_TRUE(estimate.keyframe);
  EXPECT_LT(ride.error.norm(), 1e-12);
  EXPECT_LT(local(estimate.T_world_body, estimate.T_odom_body).norm(), 1e-12);
  EXPECT_EQ(estimate.covariance.norm(), 0.0);
}

TEST(Pipeline, GivesTheSameBitsForTheSameFrames) {
  Ride one(4), two(4);
  for (int i = 0; i < 100; ++i) ASSERT_EQ(numbers(one.next()), numbers(two.next())) << i;
  EXPECT_GT(one.smoothing.answers(), 3);
  EXPECT_EQ(one.pipeline.map_size().landmarks, two.pipeline.map_size().landmarks);
}

TEST(Pipeline, StaysWithinItsBoundsOnALongDrive) {
  PipelineOptions options = small_pipeline();
  options.frontend.map.max_keyframes = 20;
  options.frontend.map.max_landmarks = 2000;
  Ride ride(5, options);
  int most_keyframes = 0, most_landmarks = 0, not_ok = 0;
  while (ride.time_s < ride.view.lap_s()) {
    if (ride.next().state != TrackState::ok) ++not_ok;
    most_keyframes = std::max(most_keyframes, ride.pipeline.map_size().keyframes);
    most_landmarks = std::max(most_landmarks, ride.pipeline.map_size().landmarks);
  }
  EXPECT_EQ(most_keyframes, 20);
  EXPECT_LE(most_landmarks, 2000);
  EXPECT_GT(most_landmarks, 1000);
  EXPECT_EQ(not_ok, 0);
  EXPECT_LT(ride.error.head<3>().norm(), 0.25);  // forgets, hence drifts
}

// Half of the landmarks a frame saw belonged to something that went.
std::vector<LandmarkOwner> half_gone(Ride& ride) {
  View view;
  ride.pipeline.fill_view(ride.view.drive(ride.time_s - ride.view.period_s()), view);
  std::vector<LandmarkOwner> owners;
  for (std::size_t i = 0; i < view.landmarks.size(); i += 2) {
    owners.push_back({view.landmarks[i].landmark, view.landmarks[i].slot, LandmarkOwner::kGone});
  }
  return owners;
}

TEST(Pipeline, ForgetsLandmarksOfWhatIsGoneAndGoesOn) {
  Ride ride(1);
  for (int i = 0; i < 20; ++i) ride.next();
  const std::vector<LandmarkOwner> owners = half_gone(ride);
  ASSERT_GT(owners.size(), 40u);
  const int before = ride.pipeline.map_size().landmarks;
  ride.pipeline.take_owners(owners);
  EXPECT_EQ(ride.pipeline.map_size().landmarks, before - std::ssize(owners));
  for (int i = 0; i < 10; ++i) {
    EXPECT_EQ(ride.next().state, TrackState::ok);
    EXPECT_LT(ride.error.head<3>().norm(), 0.05);
  }
}

TEST(Pipeline, KnowsNothingOfObjectsInStaticMode) {
  PipelineOptions options = small_pipeline();
  options.mode = "static";
  Ride ride(1, options), same(1, options);
  for (int i = 0; i < 20; ++i) ride.next(), same.next();
  ride.pipeline.take_owners(half_gone(ride));
  for (int i = 0; i < 10; ++i) EXPECT_EQ(numbers(ride.next()), numbers(same.next()));
}

// Every landmark is one object's, which is not believed any more: there is nothing left to hang on but the points of
// the last frame.
TEST(Pipeline, DoesNotHangOnWhatIsNotBelieved) {
  Ride ride(1);
  for (int i = 0; i < 20; ++i) ride.next();
  View view;
  ride.pipeline.fill_view(ride.view.drive(ride.time_s - ride.view.period_s()), view);
  std::vector<LandmarkOwner> owners;
  for (const SeenLandmark& seen : view.landmarks) owners.push_back({seen.landmark, seen.slot, 1});
  ride.pipeline.take_owners(owners);
  ObjectBelief belief;
  belief.object = 1;
  belief.belief.alpha = 1e-9;
  ride.pipeline.take_beliefs(std::vector{belief});
  const int before = ride.next().num_landmarks;
  belief.gone = true;
  Ride other(1);
  for (int i = 0; i < 21; ++i) other.next();
  EXPECT_LT(before, other.next().num_landmarks);
}

}  // namespace povslam
