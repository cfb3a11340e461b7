// The reference: the same factors in a general solver. Ceres' door.
#include <ceres/ceres.h>

#include <algorithm>
#include <deque>

#include "pipeline/backend/factors/landmark_prior_factor.hpp"
#include "pipeline/backend/factors/object_point_factor.hpp"
#include "pipeline/backend/factors/pose_manifold.hpp"
#include "pipeline/backend/factors/pose_prior_factor.hpp"
#include "pipeline/backend/factors/rigidity_factor.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"
#include "pipeline/backend/maximise.hpp"
#include "pipeline/backend/silence_ceres.hpp"

namespace povslam {

namespace {

constexpr double kTrustRegionRadius = 1e12;  // as good as undamped, unless a step fails

// A pose that moves in the plane: its x, y and turn about z.
class PlanarPoseManifold final : public ceres::Manifold {
 public:
  int AmbientSize() const override { return 7; }
  int TangentSize() const override { return 3; }
  bool Plus(const double* pose, const double* xi, double* moved) const override {
    const double all[6] = {xi[0], xi[1], 0.0, 0.0, 0.0, xi[2]};
    return whole_.Plus(pose, all, moved);
  }
  bool PlusJacobian(const double* pose, double* jacobian) const override {
    Eigen::Matrix<double, 7, 6, Eigen::RowMajor> all;
    whole_.PlusJacobian(pose, all.data());
    Eigen::Map<Eigen::Matrix<double, 7, 3, Eigen::RowMajor>> out(jacobian);
    out << all.col(0), all.col(1), all.col(5);
    return true;
  }
  bool Minus(const double* other, const double* pose, double* xi) const override {
    double all[6];
    whole_.Minus(other, pose, all);
    xi[0] = all[0];
    xi[1] = all[1];
    xi[2] = all[5];
    return true;
  }
  bool MinusJacobian(const double* pose, double* jacobian) const override {
    Eigen::Matrix<double, 6, 7, Eigen::RowMajor> all;
    whole_.MinusJacobian(pose, all.data());
    Eigen::Map<Eigen::Matrix<double, 3, 7, Eigen::RowMajor>> out(jacobian);
    out << all.row(0), all.row(1), all.row(5);
    return true;
  }

 private:
  PoseManifold whole_;
};

ceres::Problem::Options problem_options() {
  ceres::Problem::Options options;
  options.cost_function_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.manifold_ownership = ceres::DO_NOT_TAKE_OWNERSHIP;
  options.disable_all_safety_checks = true;  // fault_of() has looked
  return options;
}

class CeresMaximiser final : public Maximiser {
 public:
  void start(const VemWindow& window, const WindowSheet& sheet) override;
  MaximiseReport maximise(const std::vector<Quad>& information, int max_steps, double tolerance,
                          VemEstimate& estimate) override;

 private:
  void add_motion();
  void add_landmarks();
  void add_matches();
  void put(const VemEstimate& estimate);
  void take(VemEstimate& estimate) const;

  const VemWindow* window_ = nullptr;
  const WindowSheet* sheet_ = nullptr;
  std::unique_ptr<ceres::Problem> problem_;
  std::vector<PoseBlock> poses_;
  std::vector<std::array<double, 4>> objects_;
  std::vector<Eigen::Vector3d> landmarks_;
  std::vector<Quad> information_;
  std::deque<VoTransitionFactor> transitions_;
  std::deque<PosePriorFactor> pose_prior_;
  std::deque<RigidityFactor> rigidity_;
  std::deque<LandmarkPriorFactor> priors_;
  std::deque<ObjectPointFactor> points_;
  PoseManifold pose_manifold_;
  PlanarPoseManifold planar_manifold_;
  ceres::SubsetManifold without_z_{4, {2}}, without_yaw_{4, {3}}, without_both_{4, {2, 3}};
};

void CeresMaximiser::start(const VemWindow& window, const WindowSheet& sheet) {
  silence_ceres();
  window_ = &window;
  sheet_ = &sheet;
  problem_ = std::make_unique<ceres::Problem>(problem_options());
  poses_.assign(window.poses.size(), PoseBlock{});
  objects_.assign(window.objects.size(), {});
  landmarks_.assign(window.landmarks.size(), Eigen::Vector3d::Zero());
  information_.assign(sheet.num_slots(), Quad{});
  transitions_.clear();
  pose_prior_.clear();
  rigidity_.clear();
  priors_.clear();
  points_.clear();
  add_motion();
  add_landmarks();
  add_matches();
}

void CeresMaximiser::add_motion() {
  const bool plane = window_->dimension == 2;
  for (PoseBlock& pose : poses_) {
    problem_->AddParameterBlock(pose.data(), 7,
                                plane ? static_cast<ceres::Manifold*>(&planar_manifold_) : &pose_manifold_);
  }
  pose_prior_.emplace_back(window_->prior);
  problem_->AddResidualBlock(&pose_prior_.back(), nullptr, poses_.front().data());
  for (std::size_t t = 0; t < window_->transitions.size(); ++t) {
    transitions_.emplace_back(window_->transitions[t]);
    problem_->AddResidualBlock(&transitions_.back(), nullptr, poses_[t].data(), poses_[t + 1].data());
  }
}

void CeresMaximiser::add_landmarks() {
  std::size_t next = 0;
  for (std::size_t object = 0; object < objects_.size(); ++object) {
    const WindowSheet::Object& is = sheet_->objects()[object];
    for (int i = 0; i < window_->objects[object].num_landmarks; ++i, ++next) {
      const VemLandmark& landmark = window_->landmarks[next];
      priors_.emplace_back(landmark.p_prev, sheet_->sigma_prior_m());
      problem_->AddResidualBlock(&priors_.back(), nullptr, landmarks_[next].data());
      if (!is.rigid) continue;
      rigidity_.emplace_back(landmark.p_object, sheet_->sigma_rigid_m());
      problem_->AddResidualBlock(&rigidity_.back(), nullptr, objects_[object].data(), landmarks_[next].data());
    }
    if (!is.rigid) continue;
    const bool plane = window_->dimension == 2;
    if (plane || !is.free_yaw) {
      problem_->SetManifold(objects_[object].data(), is.free_yaw ? &without_z_
                                                     : plane     ? &without_both_
                                                                 : &without_yaw_);
    }
  }
}

void CeresMaximiser::add_matches() {
  for (const VemMatch& match : window_->matches) {
    const std::size_t at = sheet_->lane_of_match(match);
    points_.emplace_back(match.p_camera, &information_[at / kVemLanes].lane[at % kVemLanes]);
    problem_->AddResidualBlock(&points_.back(), nullptr, poses_[static_cast<std::size_t>(match.frame)].data(),
                               landmarks_[static_cast<std::size_t>(match.landmark)].data());
  }
}

void CeresMaximiser::put(const VemEstimate& estimate) {
  for (std::size_t t = 0; t < poses_.size(); ++t) poses_[t] = to_block(estimate.poses[t]);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    const auto& object = estimate.objects[i];
    objects_[i] = {object.position.x(), object.position.y(), object.position.z(), object.yaw};
  }
  for (std::size_t i = 0; i < landmarks_.size(); ++i) landmarks_[i] = sheet_->landmark(estimate.landmarks, i);
}

void CeresMaximiser::take(VemEstimate& estimate) const {
  for (std::size_t t = 0; t < poses_.size(); ++t) estimate.poses[t] = from_block(poses_[t]);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    estimate.objects[i] = {{objects_[i][0], objects_[i][1], objects_[i][2]}, objects_[i][3]};
  }
}

ceres::Solver::Options solver_options(int max_steps, double tolerance) {
  ceres::Solver::Options solver;
  solver.linear_solver_type = ceres::DENSE_SCHUR;
  solver.initial_trust_region_radius = kTrustRegionRadius;
  solver.max_trust_region_radius = 1e20;
  solver.max_num_iterations = max_steps;
  solver.function_tolerance = solver.gradient_tolerance = 0.0;
  solver.parameter_tolerance = tolerance;
  solver.num_threads = 1;
  solver.logging_type = ceres::SILENT;
  return solver;
}

MaximiseReport CeresMaximiser::maximise(const std::vector<Quad>& information, int max_steps, double tolerance,
                                        VemEstimate& estimate) {
  MaximiseReport report;
  const VemCost cost_before = settle_landmarks(*sheet_, information, estimate);
  report.cost_before = cost_before.matched + cost_before.other + motion_cost(*window_, estimate.poses);
  std::ranges::copy(information, information_.begin());
  put(estimate);
  ceres::Solver::Options solver = solver_options(max_steps, tolerance);
  solver.linear_solver_ordering = std::make_shared<ceres::ParameterBlockOrdering>();
  for (Eigen::Vector3d& landmark : landmarks_) solver.linear_solver_ordering->AddElementToGroup(landmark.data(), 0);
  for (PoseBlock& pose : poses_) solver.linear_solver_ordering->AddElementToGroup(pose.data(), 1);
  for (std::size_t i = 0; i < objects_.size(); ++i) {
    if (sheet_->objects()[i].rigid) solver.linear_solver_ordering->AddElementToGroup(objects_[i].data(), 1);
  }
  ceres::Solver::Summary summary;
  ceres::Solve(solver, problem_.get(), &summary);
  report.steps = summary.num_successful_steps;
  report.preparation_s = summary.preprocessor_time_in_seconds + summary.postprocessor_time_in_seconds;
  report.failed = !summary.IsSolutionUsable();
  const std::vector<Rigid3> before = estimate.poses;
  if (!report.failed) take(estimate);
  for (std::size_t t = 0; t < before.size(); ++t) {
    const Vector6d moved = local(before[t], estimate.poses[t]);
    report.moved_m = std::max(report.moved_m, moved.head<3>().norm());
    report.moved_rad = std::max(report.moved_rad, moved.tail<3>().norm());
  }
  const VemCost cost_after = settle_landmarks(*sheet_, information, estimate);
  report.matched_after = cost_after.matched;
  report.cost_after = cost_after.matched + cost_after.other + motion_cost(*window_, estimate.poses);
  return report;
}

}  // namespace

std::unique_ptr<Maximiser> make_ceres_maximiser() {
  return std::make_unique<CeresMaximiser>();
}

}  // namespace povslam
