#include "pipeline/frontend/orb_pattern.hpp"

#include <cmath>

#include "pipeline/frontend/orb_pairs.hpp"

namespace povslam {
namespace {

constexpr double kPi = 3.14159265358979323846;

struct Point {
  int x, y;
};
// Rotation by power series: library sines may differ in the last bit between machines.
struct Rotation {
  double cosine = 0.0, sine = 0.0;
  explicit Rotation(double angle) {
    double term = 1.0;
    for (int k = 0; k < 40; ++k) {
      if (k % 2 == 0) cosine += k % 4 == 0 ? term : -term;
      if (k % 2 == 1) sine += k % 4 == 1 ? term : -term;
      term *= angle / (k + 1);
    }
  }
  std::int32_t offset(Point p, std::int64_t stride) const {
    const double x = cosine * p.x - sine * p.y, y = sine * p.x + cosine * p.y;
    return static_cast<std::int32_t>(std::lround(y) * stride + std::lround(x));
  }
};

}  // namespace

PatchMask round_patch() {
  PatchMask mask{};
  for (int v = -kPatchRadius; v <= kPatchRadius; ++v) {
    for (int u = -kPatchRadius; u <= kPatchRadius; ++u) {
      if (u * u + v * v > kPatchRadius * (kPatchRadius + 1)) continue;
      mask.column[v + kPatchRadius][u + kPatchRadius] = static_cast<std::int8_t>(u);
      mask.inside[v + kPatchRadius][u + kPatchRadius] = 255;
    }
  }
  return mask;
}

float steady_atan2(float y, float x) {
  const float ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const float larger = ax > ay ? ax : ay, smaller = ax > ay ? ay : ax;
  if (larger == 0.0F) return 0.0F;
  // Half-angle once: |t| <= tan(pi / 8), where the odd series converges fast.
  const double ratio = static_cast<double>(smaller) / larger;
  const double t = ratio / (1.0 + std::sqrt(1.0 + ratio * ratio));
  const double t2 = t * t;
  double series = 0.0;
  for (int k = 15; k >= 1; k -= 2) series = (k % 4 == 1 ? 1.0 : -1.0) / k + t2 * series;
  double angle = 2.0 * t * series;
  if (ay > ax) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return static_cast<float>(y < 0 ? -angle : angle);
}

BriefPattern::BriefPattern(std::int64_t stride) : offsets_(static_cast<std::size_t>(kAngles) * 2 * kBriefBits) {
  for (int bit = 0; bit < kBriefBits; ++bit) {
    const BriefPair& pair = kBriefPairs[bit];
    for (int k = 0; k < kAngles; ++k) {
      const Rotation rotation(2.0 * kPi * k / kAngles);
      std::int32_t* const turned = offsets_.data() + static_cast<std::size_t>(k) * 2 * kBriefBits;
      turned[bit] = rotation.offset({pair.x0, pair.y0}, stride);
      turned[kBriefBits + bit] = rotation.offset({pair.x1, pair.y1}, stride);
    }
  }
}

BriefPattern::Offsets BriefPattern::at_angle(float angle_rad) const {
  const float turns = angle_rad * static_cast<float>(kAngles / (2.0 * kPi)) + static_cast<float>(kAngles) + 0.5F;
  const int bin = static_cast<int>(turns) % kAngles;
  const std::int32_t* const first = offsets_.data() + static_cast<std::size_t>(bin) * 2 * kBriefBits;
  return {first, first + kBriefBits};
}

}  // namespace povslam
