#include "pipeline/backend/maximise.hpp"

#include <gtest/gtest.h>

#include <Eigen/Cholesky>
#include <cstring>

#include "pipeline/backend/expect.hpp"
#include "pipeline/backend/factors/pose_prior_factor.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"
#include "pipeline/backend/places.hpp"
#include "tests/support/simulated_objects.hpp"
#include "tests/support/simulated_rectangles.hpp"

namespace povslam {

namespace {

using simulated::make_objects;
using simulated::ObjectsOptions;

// A problem with the weights and decisions of one E-step, held.
struct Held {
  VemWindow window;
  VemOptions options;
  WindowSheet sheet;
  VemEstimate estimate;
  std::vector<Quad> information;

  explicit Held(const VemWindow& asked) : window(asked) {
    sheet.assign(window, options);
    estimate = sheet.initial(window);
    measure_errors(sheet, estimate);
    Expectation expectation;
    expectation.start(window, sheet, options);
    sheet.set_least_sigma(0.3);  // as in the first iterations, else nothing would be accepted
    expectation.run(sheet, estimate.error2, false);
    information.assign(sheet.num_slots(), Quad{});
    expectation.decide(sheet, estimate.error2, true, information);
  }

  MaximiseReport solve(VemSolver solver, int steps, VemEstimate& answer) const {
    const auto maximiser = make_maximiser(solver);
    maximiser->start(window, sheet);
    answer = estimate;
    return maximiser->maximise(information, steps, 1e-14, answer);
  }
};

struct Difference {
  double pose = 0.0, object = 0.0, landmark = 0.0;
};

Difference difference(const Held& held, const VemEstimate& a, const VemEstimate& b) {
  Difference most;
  for (std::size_t t = 0; t < a.poses.size(); ++t) {
    most.pose = std::max(most.pose, local(a.poses[t], b.poses[t]).norm());
  }
  for (std::size_t i = 0; i < a.objects.size(); ++i) {
    most.object = std::max(most.object, (a.objects[i].position - b.objects[i].position).norm());
    most.object = std::max(most.object, std::abs(a.objects[i].yaw - b.objects[i].yaw));
  }
  for (std::size_t i = 0; i < held.window.landmarks.size(); ++i) {
    const Eigen::Vector3d apart = held.sheet.landmark(a.landmarks, i) - held.sheet.landmark(b.landmarks, i);
    most.landmark = std::max(most.landmark, apart.norm());
  }
  return most;
}

void expect_same_optimum(const VemWindow& window) {
  const Held held(window);
  VemEstimate structured, ceres;
  const MaximiseReport first = held.solve(VemSolver::structured, 50, structured);
  const MaximiseReport second = held.solve(VemSolver::ceres, 50, ceres);
  EXPECT_LT(first.cost_after, first.cost_before);
  EXPECT_NEAR(first.cost_before, second.cost_before, 1e-9 * first.cost_before);
  EXPECT_NEAR(first.cost_after, second.cost_after, 1e-9 * first.cost_after);
  const Difference off = difference(held, structured, ceres);
  EXPECT_LT(off.pose, 1e-9);
  EXPECT_LT(off.object, 1e-9);
  EXPECT_LT(off.landmark, 1e-9);
  EXPECT_GT(local(structured.poses.back(), window.poses.back()).norm(), 1e-3);  // else there was nothing to solve
}

// One Gauss-Newton step of all unknowns at once: 6 for a pose, 4 for an object, 3 for a landmark.
class DenseStep {
 public:
  explicit DenseStep(const Held& held) : held_(held) {
    poses_ = static_cast<Eigen::Index>(6 * held.window.poses.size());
    objects_ = static_cast<Eigen::Index>(4 * held.window.objects.size());
    const auto all = poses_ + objects_ + static_cast<Eigen::Index>(3 * held.window.landmarks.size());
    H_ = Eigen::MatrixXd::Zero(all, all);
    g_ = Eigen::VectorXd::Zero(all);
  }

  Eigen::VectorXd solve() {
    add_motion();
    add_landmarks();
    add_matches();
    return -H_.ldlt().solve(g_);
  }

 private:
  void add(const Eigen::MatrixXd& J, const Eigen::VectorXd& e, const Eigen::VectorXd& weight) {
    H_ += J.transpose() * weight.asDiagonal() * J;
    g_ += J.transpose() * weight.cwiseProduct(e);
  }
  Eigen::MatrixXd zeros(Eigen::Index rows) const { return Eigen::MatrixXd::Zero(rows, g_.size()); }
  Eigen::Index at_landmark(std::size_t i) const { return poses_ + objects_ + static_cast<Eigen::Index>(3 * i); }

  void add_motion() {
    const VemWindow& window = held_.window;
    const PosePriorError prior = pose_prior_error(window.prior, window.poses[0]);
    Eigen::MatrixXd J = zeros(6);
    J.leftCols<6>() = prior.by_pose;
    add(J, prior.e, inverse_sigmas(window.prior.sigma_m, window.prior.sigma_rad).cwiseAbs2());
    for (std::size_t t = 0; t < window.transitions.size(); ++t) {
      const VemTransition& Z = window.transitions[t];
      const VoTransitionError error = vo_transition_error(Z, window.poses[t], window.poses[t + 1]);
      J = zeros(6);
      J.middleCols<6>(static_cast<Eigen::Index>(6 * t)) = error.by_before;
      J.middleCols<6>(static_cast<Eigen::Index>(6 * t + 6)) = error.by_after;
      add(J, error.e, inverse_sigmas(Z.sigma_m, Z.sigma_rad).cwiseAbs2());
    }
  }

  void add_landmarks() {
    std::size_t next = 0;
    for (std::size_t i = 0; i < held_.window.objects.size(); ++i) {
      const VemObject& object = held_.window.objects[i];
      const Eigen::Matrix3d R = so3_exp({0.0, 0.0, object.yaw}).toRotationMatrix();
      for (int k = 0; k < object.num_landmarks; ++k, ++next) {
        const VemLandmark& landmark = held_.window.landmarks[next];
        Eigen::MatrixXd J = zeros(3);
        J.middleCols<3>(at_landmark(next)).setIdentity();
        add(J, landmark.p_world - landmark.p_prev, weight(held_.options.sigma_prior_m));
        const Eigen::Vector3d arm = R * landmark.p_object;
        const auto column = poses_ + static_cast<Eigen::Index>(4 * i);
        J = zeros(3);
        J.middleCols<3>(column).setIdentity();
        J.col(column + 3) << -arm.y(), arm.x(), 0.0;
        J.middleCols<3>(at_landmark(next)) = -Eigen::Matrix3d::Identity();
        add(J, object.position + arm - landmark.p_world, weight(held_.options.sigma_rigid_m));
      }
    }
  }

  void add_matches() {
    for (const VemMatch& match : held_.window.matches) {
      const std::size_t lane = held_.sheet.lane_of_match(match);
      const double information = held_.information[lane / kVemLanes].lane[lane % kVemLanes];
      const Rigid3& pose = held_.window.poses[static_cast<std::size_t>(match.frame)];
      const auto landmark = static_cast<std::size_t>(match.landmark);
      Eigen::MatrixXd J = zeros(3);
      J.middleCols<3>(6 * match.frame).setIdentity();
      J.middleCols<3>(6 * match.frame + 3) = -skew(pose.rotation * match.p_camera);
      J.middleCols<3>(at_landmark(landmark)) = -Eigen::Matrix3d::Identity();
      add(J, pose * match.p_camera - held_.window.landmarks[landmark].p_world, Eigen::Vector3d::Constant(information));
    }
  }

  static Eigen::VectorXd weight(double sigma) { return Eigen::Vector3d::Constant(1.0 / (sigma * sigma)); }

  const Held& held_;
  Eigen::Index poses_ = 0, objects_ = 0;
  Eigen::MatrixXd H_;
  Eigen::VectorXd g_;
};

}  // namespace

TEST(Maximise, ItsStepIsThatOfTheWholeSystem) {
  ObjectsOptions options;
  options.num_objects = 3;
  options.num_moved = 1;
  options.num_landmarks = 45;
  options.num_frames = 3;
  options.start_m = 0.05;
  const Held held(make_objects(options).window);
  const Eigen::VectorXd whole = DenseStep(held).solve();
  VemEstimate answer;
  ASSERT_EQ(held.solve(VemSolver::structured, 1, answer).steps, 1);
  for (std::size_t t = 0; t < answer.poses.size(); ++t) {
    const Vector6d step = local(held.window.poses[t], answer.poses[t]);
    EXPECT_LT((step - whole.segment<6>(static_cast<Eigen::Index>(6 * t))).norm(), 1e-9);
  }
  for (std::size_t i = 0; i < answer.objects.size(); ++i) {
    const auto at = static_cast<Eigen::Index>(6 * answer.poses.size() + 4 * i);
    const VemObject& before = held.window.objects[i];
    EXPECT_LT((answer.objects[i].position - before.position - whole.segment<3>(at)).norm(), 1e-9);
    EXPECT_NEAR(answer.objects[i].yaw - before.yaw, whole[at + 3], 1e-9);
  }
}

TEST(Maximise, LandmarksAreTheWeightedMeanThatBackSubstitutionGives) {
  ObjectsOptions options;
  options.num_landmarks = 60;
  options.num_frames = 4;
  const Held held(make_objects(options).window);
  VemEstimate settled = held.estimate;
  settle_landmarks(held.sheet, held.information, settled);
  // With poses and objects held, all residuals are linear in the landmark with Jacobian -I: H l = b is the mean.
  const VemWindow& window = held.window;
  const double prior = 1.0 / std::pow(held.options.sigma_prior_m, 2),
               rigid = 1.0 / std::pow(held.options.sigma_rigid_m, 2);
  for (std::size_t i = 0; i < window.landmarks.size(); ++i) {
    const VemObject& object = window.objects[i / 6];
    const Rigid3 T_world_object{so3_exp({0.0, 0.0, object.yaw}), object.position};
    double h = prior + rigid;
    Eigen::Vector3d b = prior * window.landmarks[i].p_prev + rigid * (T_world_object * window.landmarks[i].p_object);
    for (const VemMatch& match : window.matches) {
      if (static_cast<std::size_t>(match.landmark) != i) continue;
      const std::size_t lane = held.sheet.lane_of_match(match);
      const double w = held.information[lane / kVemLanes].lane[lane % kVemLanes];
      h += w;
      b += w * (window.poses[static_cast<std::size_t>(match.frame)] * match.p_camera);
    }
    EXPECT_LT((held.sheet.landmark(settled.landmarks, i) - b / h).norm(), 1e-12);
  }
}

TEST(Maximise, BothSolversFindTheSameOptimum) {
  ObjectsOptions options;
  options.start_m = 0.1;
  options.start_rad = 0.03;
  expect_same_optimum(make_objects(options).window);
}

TEST(Maximise, BothSolversFindTheSameOptimumWithStructure) {
  ObjectsOptions options;
  options.num_structure = 101;
  options.start_m = 0.1;
  options.num_frames = 3;
  options.share_seen = 0.5;
  expect_same_optimum(make_objects(options).window);
}

TEST(Maximise, BothSolversFindTheSameOptimumInThePlane) {
  simulated::RectanglesOptions options;
  options.num_moved = 3;
  expect_same_optimum(simulated::first_frame(simulated::RectanglesMaker(options).make(), options));
}

// One landmark alone does not say how its object is turned, two above one another neither; one object has none.
TEST(Maximise, BothSolversAgreeOnObjectsThatSayLittle) {
  ObjectsOptions options;
  options.num_objects = 6;
  options.num_moved = 0;
  options.num_landmarks = 60;
  options.start_m = 0.05;
  options.prior_sigma_m = 0.05;
  options.prior_sigma_rad = 0.02;
  VemWindow window = make_objects(options).window;
  const VemWindow whole = window;
  const int kept[] = {10, 1, 2, 0, 10, 10};
  std::vector<std::int32_t> now(60, -1);
  window.landmarks.clear();
  for (int i = 0; i < 60; ++i) {
    if (i % 10 >= kept[i / 10]) continue;
    now[static_cast<std::size_t>(i)] = static_cast<std::int32_t>(window.landmarks.size());
    window.landmarks.push_back(whole.landmarks[static_cast<std::size_t>(i)]);
  }
  for (std::size_t i = 0; i < 6; ++i) window.objects[i].num_landmarks = kept[i];
  std::erase_if(window.matches, [&now](VemMatch& match) {
    match.landmark = now[static_cast<std::size_t>(match.landmark)];
    return match.landmark < 0;
  });
  const Eigen::Vector3d above(0.0, 0.0, 0.4);
  const VemLandmark& low = window.landmarks[11];
  window.landmarks[12] = {low.p_world + above, low.p_object + above, low.p_prev + above};
  expect_same_optimum(window);
}

TEST(Maximise, StaysWhereItIsWhenThatIsBest) {
  ObjectsOptions options;
  options.num_moved = 0;
  const Held held(make_objects(options).window);
  VemEstimate best, again;
  held.solve(VemSolver::structured, 50, best);
  Held from_best = held;
  from_best.estimate = best;
  const MaximiseReport report = from_best.solve(VemSolver::structured, 5, again);
  EXPECT_LE(report.cost_after, report.cost_before * (1.0 + 1e-12));
  EXPECT_LT(local(best.poses.back(), again.poses.back()).norm(), 1e-10);
}

TEST(Maximise, LowersTheCostFromAnywhere) {
  for (unsigned seed = 1; seed <= 10; ++seed) {
    ObjectsOptions options;
    options.seed = seed;
    options.num_landmarks = 100;
    Held held(make_objects(options).window);
    for (std::size_t t = 0; t < held.estimate.poses.size(); ++t) {
      const double wild = static_cast<double>(seed + t);
      held.estimate.poses[t] = {so3_exp({0.9 * std::sin(wild), std::cos(wild), 2.0 * std::sin(2.0 * wild)}),
                                {5.0 * std::cos(3.0 * wild), wild, -wild}};
    }
    VemEstimate answer;
    double before = std::numeric_limits<double>::infinity();
    for (const int steps : {1, 2, 4, 8}) {
      const MaximiseReport report = held.solve(VemSolver::structured, steps, answer);
      EXPECT_LE(report.cost_after, report.cost_before);
      EXPECT_LE(report.cost_after, before);
      before = report.cost_after;
    }
  }
}

TEST(VemKernels, GiveTheSameBitsOnEachMachine) {
  ObjectsOptions options;
  options.num_landmarks = 330;
  const Held held(make_objects(options).window);
  const std::size_t frames = held.window.poses.size();
  VemEstimate first = held.estimate;
  std::vector<double> first_sums;
  for (int isa = 0; isa <= widest_isa(); ++isa) {
    VemEstimate estimate = held.estimate;
    Places places(estimate);
    std::vector<Quad> pairs(16 * frames * frames), gradient(6 * frames), scratch(4 * kVemChunk * (frames + 1));
    std::vector<double> frame_object(12 * frames), sums;
    for (std::size_t object = 0; object < held.window.objects.size(); ++object) {
      const VemBlocks blocks = held.sheet.blocks(object, held.information.data());
      VemMoments moments{pairs.data(), gradient.data(), frame_object.data(), scratch.data(), {}, {}, 0.0};
      vem_kernels(isa).moments(&blocks, &places.of(object), &moments);
      const VemCost cost =
          vem_kernels(isa).settle(&blocks, &places.of(object), Places::landmarks(held.sheet, object, estimate),
                                  estimate.error2.data() + held.sheet.first_slot(object));
      sums.insert(sums.end(), {cost.matched, cost.other, moments.cost, moments.object[3], moments.object_gradient[3]});
      sums.insert(sums.end(), frame_object.begin(), frame_object.end());
      EXPECT_NEAR(moments.cost, cost.matched + cost.other, 1e-9 * moments.cost);
    }
    for (const Quad& quad : pairs) sums.insert(sums.end(), quad.lane, quad.lane + kVemLanes);
    if (isa == 0) {
      first = estimate;
      first_sums = sums;
    }
    EXPECT_EQ(std::memcmp(first.landmarks.data(), estimate.landmarks.data(), first.landmarks.size() * sizeof(Quad)), 0);
    EXPECT_EQ(first_sums, sums);
  }
}

}  // namespace povslam
