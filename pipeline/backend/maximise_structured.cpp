// Gauss-Newton on what is left when landmarks and objects are eliminated.
//
// With isotropic noise each residual of a landmark is "target minus landmark", so its block is a scalar W = sum w, its
// best place l* = sum w z / W is exact for any poses, and eliminating it leaves, of two targets a and b,
//   H_ab = [a = b] w_a J_a^T J_a - w_a w_b / W J_a^T J_b,   g_a = J_a^T w_a (z_a - l*)
// where J = [I, -[a]x] of a pose (a = R d) and [I, S R l] of an object depend on constant points only through their
// rotation: sums of 4x4 moments of the constant points come first (moments.kernel.cpp), rotations after.
// Objects couple to poses alone: each 4x4 goes next, and 6 unknowns for each frame remain.
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pipeline/backend/factors/pose_prior_factor.hpp"
#include "pipeline/backend/factors/vo_transition_factor.hpp"
#include "pipeline/backend/maximise.hpp"
#include "pipeline/backend/moment_blocks.hpp"
#include "pipeline/backend/places.hpp"

namespace povslam {

namespace {

constexpr int kMaxTries = 8;
constexpr double kFirstDamping = 1e-4;
constexpr double kRounding = 1e-12;  // of the cost

class StructuredMaximiser final : public Maximiser {
 public:
  void start(const VemWindow& window, const WindowSheet& sheet) override;
  MaximiseReport maximise(const std::vector<Quad>& information, int max_steps, double tolerance,
                          VemEstimate& estimate) override;

 private:
  void linearise(const std::vector<Quad>& information, const VemEstimate& estimate);
  void add_object(std::size_t object, const std::vector<Quad>& information, const VemEstimate& estimate,
                  Places& places);
  void add_pairs(const VemEstimate& estimate);
  void add_motion(const VemEstimate& estimate);
  void hold();
  bool solve(double damping);
  bool try_step(const std::vector<Quad>& information, const VemEstimate& estimate);
  double furthest(Eigen::Index first) const;  // of a pose; first: 0 translation, 3 rotation
  void move(const VemEstimate& from, VemEstimate& to) const;
  VemCost cost(const std::vector<Quad>& information, VemEstimate& estimate) const;  // other: with motion
  auto H_block(std::size_t t, std::size_t s) {
    return H_.block<6, 6>(static_cast<Eigen::Index>(6 * t), static_cast<Eigen::Index>(6 * s));
  }

  const VemWindow* window_ = nullptr;
  const WindowSheet* sheet_ = nullptr;
  Eigen::MatrixXd H_, reduced_, coupling_, half_;  // poses; with objects gone; pose-object; its solved half
  Eigen::VectorXd g_, reduced_g_, step_;           // poses
  std::vector<Eigen::Matrix4d> object_H_;
  std::vector<Eigen::LLT<Eigen::Matrix4d>> object_factor_;
  std::vector<Eigen::Vector4d> object_g_, object_step_;
  std::vector<Quad> pairs_, frame_gradient_, scratch_;
  std::vector<double> frame_object_;
  double cost_ = 0.0;  // where it was linearised
  VemEstimate trial_;  // empty: not of this problem yet
  VemCost trial_cost_{};
  Eigen::LLT<Eigen::MatrixXd> factor_;
};

void StructuredMaximiser::start(const VemWindow& window, const WindowSheet& sheet) {
  window_ = &window;
  sheet_ = &sheet;
  trial_ = {};
  const std::size_t frames = window.poses.size(), objects = window.objects.size();
  const auto unknowns = static_cast<Eigen::Index>(6 * frames), columns = static_cast<Eigen::Index>(4 * objects);
  H_.resize(unknowns, unknowns);
  reduced_.resize(unknowns, unknowns);
  coupling_.resize(unknowns, columns);
  half_.resize(unknowns, columns);
  for (auto* vector : {&g_, &reduced_g_, &step_}) vector->resize(unknowns);
  object_H_.resize(objects);
  object_factor_.resize(objects);
  object_g_.resize(objects);
  object_step_.resize(objects);
  pairs_.resize(16 * frames * frames);
  frame_gradient_.resize(6 * frames);
  frame_object_.resize(12 * frames);
  scratch_.resize(4 * kVemChunk * (frames + 1));
}

void StructuredMaximiser::linearise(const std::vector<Quad>& information, const VemEstimate& estimate) {
  std::ranges::fill(pairs_, Quad{});
  std::ranges::fill(frame_gradient_, Quad{});
  cost_ = motion_cost(*window_, estimate.poses);
  coupling_.setZero();
  Places places(estimate);
  for (std::size_t object = 0; object < object_H_.size(); ++object) add_object(object, information, estimate, places);
  add_pairs(estimate);
  add_motion(estimate);
  hold();
}

void StructuredMaximiser::add_object(std::size_t object, const std::vector<Quad>& information,
                                     const VemEstimate& estimate, Places& places) {
  const VemBlocks blocks = sheet_->blocks(object, information.data());
  VemMoments moments{pairs_.data(), frame_gradient_.data(), frame_object_.data(), scratch_.data(), {}, {}, 0.0};
  vem_kernels().moments(&blocks, &places.of(object), &moments);
  cost_ += moments.cost;
  const Eigen::Rotation2Dd R_o(estimate.objects[object].yaw);
  object_H_[object] = object_object(moments.object, R_o);
  object_g_[object] = Eigen::Map<const Eigen::Vector4d>(moments.object_gradient);
  if (!sheet_->objects()[object].rigid) return;
  for (std::size_t t = 0; t < estimate.poses.size(); ++t) {
    const Eigen::Map<const Moments43> m(&frame_object_[12 * t]);
    if (m(0, 0) == 0.0) continue;
    coupling_.block<6, 4>(static_cast<Eigen::Index>(6 * t), static_cast<Eigen::Index>(4 * object)) =
        -pose_object(m, estimate.poses[t].matrix3(), R_o);
  }
}

void StructuredMaximiser::add_pairs(const VemEstimate& estimate) {
  const std::size_t frames = estimate.poses.size();
  for (std::size_t i = 0; i < frame_gradient_.size(); ++i) {
    g_[static_cast<Eigen::Index>(i)] = total(frame_gradient_[i]);
  }
  for (std::size_t t = 0; t < frames; ++t) {
    const Eigen::Matrix3d R_t = estimate.poses[t].matrix3();
    for (std::size_t s = 0; s < t; ++s) {
      H_block(t, s) = -pose_pose(total4(&pairs_[16 * (t * frames + s)]), R_t, estimate.poses[s].matrix3());
    }
    const Moments4 lower = total4(&pairs_[16 * (t * frames + t)]);
    H_block(t, t) = pose_pose(lower.selfadjointView<Eigen::Lower>(), R_t, R_t);
  }
}

void StructuredMaximiser::add_motion(const VemEstimate& estimate) {
  const PosePriorError prior = pose_prior_error(window_->prior, estimate.poses.front());
  const Vector6d held = inverse_sigmas(window_->prior.sigma_m, window_->prior.sigma_rad).cwiseAbs2();
  H_block(0, 0) += prior.by_pose.transpose() * held.asDiagonal() * prior.by_pose;
  g_.head<6>() += prior.by_pose.transpose() * held.cwiseProduct(prior.e);
  for (std::size_t t = 0; t < window_->transitions.size(); ++t) {
    const VemTransition& Z = window_->transitions[t];
    const VoTransitionError error = vo_transition_error(Z, estimate.poses[t], estimate.poses[t + 1]);
    const Vector6d weight = inverse_sigmas(Z.sigma_m, Z.sigma_rad).cwiseAbs2();
    H_block(t, t) += error.by_before.transpose() * weight.asDiagonal() * error.by_before;
    H_block(t + 1, t) += error.by_after.transpose() * weight.asDiagonal() * error.by_before;
    H_block(t + 1, t + 1) += error.by_after.transpose() * weight.asDiagonal() * error.by_after;
    g_.segment<6>(static_cast<Eigen::Index>(6 * t)) += error.by_before.transpose() * weight.cwiseProduct(error.e);
    g_.segment<6>(static_cast<Eigen::Index>(6 * t + 6)) += error.by_after.transpose() * weight.cwiseProduct(error.e);
  }
}

// Unknowns that stay where they are: a row of the identity, no gradient.
void StructuredMaximiser::hold() {
  const bool plane = sheet_->dimension() == 2;
  for (std::size_t object = 0; object < object_H_.size(); ++object) {
    const WindowSheet::Object& is = sheet_->objects()[object];
    for (Eigen::Index k = 0; k < 4; ++k) {
      if (is.rigid && !(k == 2 && plane) && !(k == 3 && !is.free_yaw)) continue;
      object_H_[object].row(k).setZero();
      object_H_[object].col(k).setZero();
      object_H_[object](k, k) = 1.0;
      object_g_[object][k] = 0.0;
      coupling_.col(static_cast<Eigen::Index>(4 * object) + k).setZero();
    }
  }
  for (Eigen::Index i = 0; plane && i < g_.size(); ++i) {
    if (i % 6 < 2 || i % 6 == 5) continue;
    H_.row(i).setZero();
    H_.col(i).setZero();
    H_(i, i) = 1.0;
    g_[i] = 0.0;
    coupling_.row(i).setZero();
  }
}

bool StructuredMaximiser::solve(double damping) {
  reduced_ = H_;
  reduced_.diagonal() *= 1.0 + damping;
  reduced_g_ = g_;
  for (std::size_t object = 0; object < object_H_.size(); ++object) {
    const auto column = static_cast<Eigen::Index>(4 * object);
    Eigen::Matrix4d H = object_H_[object];
    H.diagonal() *= 1.0 + damping;
    object_factor_[object].compute(H);
    if (object_factor_[object].info() != Eigen::Success) return false;
    auto half = half_.middleCols<4>(column);
    half = coupling_.middleCols<4>(column);
    object_factor_[object].matrixU().solveInPlace<Eigen::OnTheRight>(half);
    reduced_g_ -= half * object_factor_[object].matrixL().solve(object_g_[object]);
  }
  reduced_.selfadjointView<Eigen::Lower>().rankUpdate(half_, -1.0);
  factor_.compute(reduced_);
  if (factor_.info() != Eigen::Success) return false;
  step_ = -factor_.solve(reduced_g_);
  for (std::size_t object = 0; object < object_H_.size(); ++object) {
    const auto column = static_cast<Eigen::Index>(4 * object);
    object_step_[object] =
        -object_factor_[object].solve(object_g_[object] + coupling_.middleCols<4>(column).transpose() * step_);
  }
  return step_.allFinite();
}

void StructuredMaximiser::move(const VemEstimate& from, VemEstimate& to) const {
  for (std::size_t t = 0; t < from.poses.size(); ++t) {
    to.poses[t] = retract(from.poses[t], step_.segment<6>(static_cast<Eigen::Index>(6 * t)));
  }
  for (std::size_t object = 0; object < from.objects.size(); ++object) {
    to.objects[object].position = from.objects[object].position + object_step_[object].head<3>();
    to.objects[object].yaw = from.objects[object].yaw + object_step_[object][3];
  }
}

VemCost StructuredMaximiser::cost(const std::vector<Quad>& information, VemEstimate& estimate) const {
  const VemCost landmarks = settle_landmarks(*sheet_, information, estimate);
  return {landmarks.matched, landmarks.other + motion_cost(*window_, estimate.poses)};
}

// One step that does not raise the cost, into trial_: undamped first, then damped more and more.
bool StructuredMaximiser::try_step(const std::vector<Quad>& information, const VemEstimate& estimate) {
  double damping = 0.0;
  for (int i = 0; i < kMaxTries; ++i, damping = std::max(kFirstDamping, 10.0 * damping)) {
    if (!solve(damping)) continue;
    move(estimate, trial_);
    trial_cost_ = cost(information, trial_);
    if (trial_cost_.matched + trial_cost_.other <= cost_ * (1.0 + kRounding)) return true;
  }
  return false;
}

double StructuredMaximiser::furthest(Eigen::Index first) const {
  double most = 0.0;
  for (Eigen::Index t = first; t < step_.size(); t += 6) most = std::max(most, step_.segment<3>(t).norm());
  return most;
}

MaximiseReport StructuredMaximiser::maximise(const std::vector<Quad>& information, int max_steps, double tolerance,
                                             VemEstimate& estimate) {
  MaximiseReport report;
  if (trial_.poses.empty()) trial_ = estimate;
  while (report.steps < max_steps) {
    linearise(information, estimate);
    if (report.steps == 0) report.cost_before = cost_;
    if (!try_step(information, estimate)) {
      trial_cost_ = cost(information, estimate);
      report.failed = true;
    } else {
      std::swap(estimate, trial_);
      ++report.steps;
      report.moved_m = furthest(0);
      report.moved_rad = furthest(3);
    }
    report.matched_after = trial_cost_.matched;
    report.cost_after = trial_cost_.matched + trial_cost_.other;
    double objects = 0.0;
    for (const Eigen::Vector4d& step : object_step_) objects = std::max(objects, step.norm());
    if (report.failed || std::max({report.moved_m, report.moved_rad, objects}) <= tolerance) break;
  }
  return report;
}

}  // namespace

std::unique_ptr<Maximiser> make_structured_maximiser() {
  return std::make_unique<StructuredMaximiser>();
}

}  // namespace povslam
