#include "pipeline/frontend/solve_pose.hpp"

#include <Eigen/Cholesky>
#include <cmath>

namespace povslam {

namespace {

constexpr double kMinDepth = 0.05;  // m: nearer points say nothing

struct Normal {
  Matrix6d H = Matrix6d::Zero();
  Vector6d g = Vector6d::Zero();
  double cost = 0.0;
};

// Huber's weight for a squared whitened residual.
double huber_weight(double chi2, double limit) {
  return chi2 <= limit ? 1.0 : std::sqrt(limit / chi2);
}

struct Residual {
  double ru = 0.0, rv = 0.0, rd = 0.0;
  double chi2_px = 0.0, chi2_d = 0.0;
  bool in_front = false;
};

class Problem {
 public:
  Problem(const PinholeCamera& camera, std::span<PoseObservation> observations, const PoseSolverOptions& options)
      : camera_(camera), observations_(observations), options_(options) {}

  Normal linearise(const Rigid3& T) const {
    Normal n;
    const Eigen::Matrix3d R = T.matrix3();
    for (const PoseObservation& o : observations_) {
      if (!o.fits) continue;
      const Eigen::Vector3d p = R * o.p_world + T.translation;
      const Residual r = residual(o, p);
      if (!r.in_front) continue;
      const double iz = 1.0 / p.z(), iz2 = iz * iz;
      // d(u, v, 1/z) / d p_camera, then d p_camera / d xi = [I | -[p]x].
      Eigen::Matrix<double, 3, 6> J;
      const double x = p.x(), y = p.y(), fx = camera_.fx, fy = camera_.fy;
      J.row(0) << fx * iz, 0.0, -fx * x * iz2, -fx * x * y * iz2, fx * (1.0 + x * x * iz2), -fx * y * iz;
      J.row(1) << 0.0, fy * iz, -fy * y * iz2, -fy * (1.0 + y * y * iz2), fy * x * y * iz2, fy * x * iz;
      J.row(2) << 0.0, 0.0, -iz2, -y * iz2, x * iz2, 0.0;
      const double w_px = o.trust * o.weight_px * huber_weight(r.chi2_px, options_.chi2_pixel);
      const double w_d =
          o.depth_fits ? o.trust * o.weight_inverse_depth * huber_weight(r.chi2_d, options_.chi2_depth) : 0.0;
      n.H.noalias() += w_px * (J.row(0).transpose() * J.row(0) + J.row(1).transpose() * J.row(1));
      n.g.noalias() += w_px * (r.ru * J.row(0) + r.rv * J.row(1)).transpose();
      if (w_d > 0.0) {
        n.H.noalias() += w_d * J.row(2).transpose() * J.row(2);
        n.g.noalias() += w_d * r.rd * J.row(2).transpose();
      }
      n.cost += w_px * (r.ru * r.ru + r.rv * r.rv) + w_d * r.rd * r.rd;
    }
    return n;
  }

  void classify(const Rigid3& T, double gate, PoseSolution& solution) const {
    solution.num_inliers = solution.num_depth_inliers = 0;
    double chi2 = 0.0, dof = 0.0;
    const Eigen::Matrix3d R = T.matrix3();
    for (PoseObservation& o : observations_) {
      const Residual r = residual(o, R * o.p_world + T.translation);
      o.fits = r.in_front && r.chi2_px <= gate * options_.chi2_pixel;
      o.depth_fits = o.fits && o.weight_inverse_depth > 0.0 && r.chi2_d <= gate * options_.chi2_depth;
      if (o.fits) ++solution.num_inliers, chi2 += r.chi2_px, dof += 2.0;
      if (o.depth_fits) ++solution.num_depth_inliers, chi2 += r.chi2_d, dof += 1.0;
    }
    solution.chi2_per_dof = dof > 6.0 ? chi2 / (dof - 6.0) : 0.0;
  }

 private:
  Residual residual(const PoseObservation& o, const Eigen::Vector3d& p) const {
    Residual r;
    r.in_front = p.z() > kMinDepth;
    if (!r.in_front) return r;
    const double iz = 1.0 / p.z();
    r.ru = camera_.fx * p.x() * iz + camera_.cx - o.u_px;
    r.rv = camera_.fy * p.y() * iz + camera_.cy - o.v_px;
    r.chi2_px = o.weight_px * (r.ru * r.ru + r.rv * r.rv);
    if (o.weight_inverse_depth > 0.0) {
      r.rd = iz - o.inverse_depth_per_m;
      r.chi2_d = o.weight_inverse_depth * r.rd * r.rd;
    }
    return r;
  }

  const PinholeCamera& camera_;
  std::span<PoseObservation> observations_;
  const PoseSolverOptions& options_;
};

}  // namespace

PoseSolution solve_pose(const PinholeCamera& camera, const Rigid3& T_camera_world_start,
                        std::span<PoseObservation> observations, const PoseSolverOptions& options) {
  PoseSolution solution;
  solution.T_camera_world = T_camera_world_start;
  for (PoseObservation& o : observations) o.fits = true, o.depth_fits = o.weight_inverse_depth > 0.0;
  const Problem problem(camera, observations, options);
  for (int round = 0; round < options.rounds; ++round) {
    solution.converged = false;
    for (int i = 0; i < options.iterations; ++i) {
      const Normal normal = problem.linearise(solution.T_camera_world);
      const Eigen::LDLT<Matrix6d> ldlt(normal.H);
      if (ldlt.info() != Eigen::Success || ldlt.vectorD().minCoeff() < 1e-6) return solution;
      const Vector6d step = ldlt.solve(-normal.g);
      if (!step.allFinite()) return solution;
      solution.T_camera_world = se3_exp(step) * solution.T_camera_world;
      solution.information = normal.H;
      if (step.head<3>().norm() < 1e-6 && step.tail<3>().norm() < 1e-6) {
        solution.converged = true;
        break;
      }
    }
    problem.classify(solution.T_camera_world, round == 0 ? options.first_gate : 1.0, solution);
    if (solution.num_inliers < 4) {
      solution.converged = false;
      return solution;
    }
  }
  solution.information = problem.linearise(solution.T_camera_world).H;
  solution.converged = true;
  return solution;
}

}  // namespace povslam
