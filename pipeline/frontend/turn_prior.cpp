#include "pipeline/frontend/turn_prior.hpp"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "pipeline/geometry/rigid.hpp"

namespace povslam {

namespace {

constexpr int kCoarseWidth = 40, kFineWidth = 80;  // px
constexpr int kIterations = 12;

float bilinear(const std::vector<float>& image, int width, double x, double y) {
  const int ix = static_cast<int>(x), iy = static_cast<int>(y);
  const float fx = static_cast<float>(x - ix), fy = static_cast<float>(y - iy);
  const float* p = image.data() + iy * width + ix;
  const float top = p[0] + fx * (p[1] - p[0]), low = p[width] + fx * (p[width + 1] - p[width]);
  return top + fy * (low - top);
}

// Block means of a pyramid level.
void shrink(const PyramidLevel& level, int width, int height, std::vector<float>& out) {
  for (int y = 0; y < height; ++y) {
    const int y0 = y * level.height / height, y1 = (y + 1) * level.height / height;
    for (int x = 0; x < width; ++x) {
      const int x0 = x * level.width / width, x1 = (x + 1) * level.width / width;
      int sum = 0;
      for (int v = y0; v < y1; ++v) {
        const std::uint8_t* row = level.pixels + v * level.stride;
        for (int u = x0; u < x1; ++u) sum += row[u];
      }
      out[static_cast<std::size_t>(y * width + x)] =
          static_cast<float>(sum) / static_cast<float>((y1 - y0) * (x1 - x0));
    }
  }
}

}  // namespace

TurnPrior::TurnPrior(const PinholeCamera& camera) {
  for (const int width : {kCoarseWidth, kFineWidth}) {
    Thumbnail t;
    t.width = width;
    t.height = std::max(8, width * camera.height / camera.width);
    const double sx = static_cast<double>(t.width) / camera.width, sy = static_cast<double>(t.height) / camera.height;
    t.fx = camera.fx * sx;
    t.fy = camera.fy * sy;
    t.cx = (camera.cx + 0.5) * sx - 0.5;
    t.cy = (camera.cy + 0.5) * sy - 0.5;
    t.now.resize(static_cast<std::size_t>(t.width * t.height));
    t.before.resize(t.now.size());
    thumbnails_.push_back(std::move(t));
  }
}

void TurnPrior::look(const OrbExtractor& image) {
  for (Thumbnail& t : thumbnails_) {
    int chosen = 0;  // the smallest level that still has two pixels a thumbnail pixel
    while (chosen + 1 < image.num_levels() && image.level(chosen + 1).width >= 2 * t.width) ++chosen;
    std::swap(t.now, t.before);
    shrink(image.level(chosen), t.width, t.height, t.now);
  }
}

TurnPrior::Turn TurnPrior::estimate(const Eigen::Quaterniond& start) const {
  Turn turn{start, 0.0};
  for (const Thumbnail& t : thumbnails_) align(t, kIterations, turn);
  return turn;
}

void TurnPrior::align(const Thumbnail& t, int iterations, Turn& turn) {
  for (int i = 0; i < iterations; ++i) {
    const Eigen::Matrix3d R = turn.R_now_before.toRotationMatrix();
    Eigen::Matrix4d H = Eigen::Matrix4d::Zero();  // turn and brightness offset
    Eigen::Vector4d g = Eigen::Vector4d::Zero();
    double sum_a = 0.0, sum_b = 0.0, sum_aa = 0.0, sum_bb = 0.0, sum_ab = 0.0, count = 0.0;
    for (int y = 1; y + 1 < t.height; ++y) {
      for (int x = 1; x + 1 < t.width; ++x) {
        const Eigen::Vector3d ray((x - t.cx) / t.fx, (y - t.cy) / t.fy, 1.0);
        const Eigen::Vector3d seen = R * ray;
        if (seen.z() < 0.1) continue;
        const double u = t.fx * seen.x() / seen.z() + t.cx, v = t.fy * seen.y() / seen.z() + t.cy;
        if (!(u >= 0.0 && v >= 0.0 && u < t.width - 1.0 && v < t.height - 1.0)) continue;
        const float* p = t.before.data() + y * t.width + x;
        const double gx = 0.5 * t.fx * static_cast<double>(p[1] - p[-1]);
        const double gy = 0.5 * t.fy * static_cast<double>(p[t.width] - p[-t.width]);
        // d brightness / d phi for ray <- Exp(phi) ray in the previous image.
        const double rx = ray.x(), ry = ray.y();
        const Eigen::Vector4d J(-gx * rx * ry - gy * (1.0 + ry * ry), gx * (1.0 + rx * rx) + gy * rx * ry,
                                -gx * ry + gy * rx, 1.0);
        const double now = bilinear(t.now, t.width, u, v), before = p[0];
        const double error = now - before;
        const double weight = std::abs(error) < 20.0 ? 1.0 : 20.0 / std::abs(error);
        H.noalias() += weight * J * J.transpose();
        g.noalias() += weight * error * J;
        sum_a += now, sum_b += before, sum_aa += now * now, sum_bb += before * before, sum_ab += now * before;
        count += 1.0;
      }
    }
    if (count < 0.25 * t.width * t.height) {
      turn.agreement = 0.0;
      return;
    }
    const double spread = (sum_aa - sum_a * sum_a / count) * (sum_bb - sum_b * sum_b / count);
    turn.agreement = spread > 0.0 ? (sum_ab - sum_a * sum_b / count) / std::sqrt(spread) : 0.0;
    const Eigen::Vector3d phi = H.ldlt().solve(g).head<3>();
    if (!phi.allFinite()) return;
    turn.R_now_before = (turn.R_now_before * so3_exp(-phi)).normalized();
    if (phi.norm() < 1e-4) return;
  }
}

}  // namespace povslam
