// The E-step's elementwise half: responsibilities and the max-mixture gate.
#include "pipeline/backend/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

namespace {

// exp(x) for x <= 0 within 1 ulp or so; 0 below -700. x = n ln 2 + r, |r| <= ln 2 / 2; Taylor to r^13.
POVSLAM_INLINE Lanes exp_negative(Lanes x) {
  const Bits counts = x > -700.0;
  x = select(counts, x, fill(0.0));
  const Lanes shifted =
      x * 1.4426950408889634 + 6755399441055744.0;  // 1.5 * 2^52: the low bits hold the rounded number
  const Lanes n = shifted - 6755399441055744.0;
  const Lanes r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10;
  constexpr double kInverseFactorial[] = {1.0 / 6227020800.0,
                                          1.0 / 479001600.0,
                                          1.0 / 39916800.0,
                                          1.0 / 3628800.0,
                                          1.0 / 362880.0,
                                          1.0 / 40320.0,
                                          1.0 / 5040.0,
                                          1.0 / 720.0,
                                          1.0 / 120.0,
                                          1.0 / 24.0,
                                          1.0 / 6.0,
                                          0.5,
                                          1.0,
                                          1.0};
  Lanes power = fill(kInverseFactorial[0]);
  for (int i = 1; i < 14; ++i) power = power * r + kInverseFactorial[i];
  const Bits scale = (reinterpret_cast<Bits>(shifted) + 1023) << 52;
  return select(counts, power * reinterpret_cast<Lanes>(scale), fill(0.0));
}

}  // namespace

void expect(int count, const Quad* error2, const Quad* inverse_variance, const Quad* bias, VemExpect* sums, Quad* pi) {
  Lanes sum_pi = fill(0.0), excess = fill(0.0), product = fill(1.0);
  double sum_log = 0.0;
  for (int i = 0; i < count; ++i) {
    const Lanes iv = lanes(inverse_variance[i]);
    const Bits matched = iv > 0.0;
    const Lanes logit = sums->odds + lanes(bias[i]) - 0.5 * lanes(error2[i]) * iv;
    const Bits positive = logit > 0.0;
    const Lanes t = exp_negative(select(positive, -logit, logit));
    const Lanes p = select(positive, fill(1.0), t) / (1.0 + t);
    lanes(pi[i]) = select(matched, p, fill(0.0));
    sum_pi += lanes(pi[i]);
    excess += select(matched & positive, logit, fill(0.0));
    product *= select(matched, 1.0 + t, fill(1.0));
    if (i % 512 == 511) {  // each factor is at most 2
      for (int lane = 0; lane < kVemLanes; ++lane) sum_log += __builtin_log(product[lane]);
      product = fill(1.0);
    }
  }
  for (int lane = 0; lane < kVemLanes; ++lane) sum_log += __builtin_log(product[lane]);
  sums->sum_pi = sum(sum_pi);
  sums->sum_excess = sum(excess) + sum_log;
}

void gate(int count, double odds, const Quad* error2, const Quad* inverse_variance, const Quad* bias, const Quad* pi,
          Quad* information) {
  for (int i = 0; i < count; ++i) {
    const Lanes iv = lanes(inverse_variance[i]);
    const Bits accepted = odds + lanes(bias[i]) - 0.5 * lanes(error2[i]) * iv >= 0.0;
    lanes(information[i]) = select(accepted, lanes(pi[i]) * iv, fill(0.0));
  }
}

}  // namespace povslam::POVSLAM_ISA
