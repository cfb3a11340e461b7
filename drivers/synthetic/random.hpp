// The simulator's own random numbers and sine: the same seed gives the same bytes on every machine.
// The standard library promises that neither for its distributions nor for its sine.
#pragma once

#include <cmath>
#include <cstdint>

namespace povslam::synthetic {

// One well-mixed 64-bit word from two (splitmix64's finaliser; Steele, Lea and Flood, OOPSLA 2014).
constexpr std::uint64_t mix(std::uint64_t a, std::uint64_t b) {
  std::uint64_t z = a + 0x9E3779B97F4A7C15ULL * (b + 1);
  z = (z ^ (z >> 30)) * 0xBF58476D1CE4E5B9ULL;
  z = (z ^ (z >> 27)) * 0x94D049BB133111EBULL;
  return z ^ (z >> 31);
}

class Random {
 public:
  explicit Random(std::uint64_t seed) : state_(seed) {}

  std::uint64_t next() { return mix(state_++, 0); }
  double uniform() { return static_cast<double>(next() >> 11) * 0x1.0p-53; }  // [0, 1)
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  int below(int count) { return static_cast<int>(uniform() * count); }  // 0 … count - 1
  bool chance(double probability) { return uniform() < probability; }
  double gaussian() {  // unit variance: twelve uniforms (Irwin-Hall), needs no logarithm; |x| <= 6
    double sum = -6.0;
    for (int i = 0; i < 12; ++i) sum += uniform();
    return sum;
  }

 private:
  std::uint64_t state_;
};

inline constexpr double kPi = 3.14159265358979323846;

struct SinCos {
  double sin = 0.0, cos = 1.0;
};

// Reduction to |r| <= pi/4 and Taylor polynomials; error below 1e-14 for the angles of a drive.
inline SinCos sin_cos(double angle_rad) {
  constexpr double kHalfPiLow = 6.123233995736766e-17;
  const double quarter = std::floor(angle_rad * (2.0 / kPi) + 0.5);
  const double r = (angle_rad - quarter * (0.5 * kPi)) - quarter * kHalfPiLow;
  const double q = r * r;
  double sine = 0.0, cosine = 0.0;
  for (int n = 8; n >= 1; --n) {
    sine = (1.0 + sine) * -q / (2.0 * n * (2.0 * n + 1.0));
    cosine = (1.0 + cosine) * -q / (2.0 * n * (2.0 * n - 1.0));
  }
  sine = r * (1.0 + sine);
  cosine = 1.0 + cosine;
  switch (static_cast<std::int64_t>(quarter) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace povslam::synthetic
