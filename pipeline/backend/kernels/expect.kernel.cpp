// The E-step's elementwise half: responsibilities and the max-mixture gate.
#include "pipeline/backend/kernels/lanes.hpp"

namespace povslam::POVSLAM_ISA {

namespace {

// exp(x) for x <= 0 to about an ulp; 0 below -700. x = n ln 2 + r, |r| <= ln 2 / 2, and Taylor to r^12 (the next term
// is below 2e-16), summed in a tree.
POVSLAM_INLINE Lanes exp_negative(Lanes x) {
  const Bits counts = x > -700.0;
  x = select(counts, x, fill(0.0));
  const Lanes shifted = x * 1.4426950408889634 + 6755399441055744.0;  // 1.5 * 2^52: the low bits are the whole number
  const Lanes n = shifted - 6755399441055744.0;
  const Lanes r = (x - n * 0.693147180369123816490) - n * 1.90821492927058770002e-10;
  const Lanes r2 = r * r, r4 = r2 * r2, r8 = r4 * r4;
  const Lanes p01 = 1.0 + r, p23 = 0.5 + r * (1.0 / 6.0);
  const Lanes p45 = 1.0 / 24.0 + r * (1.0 / 120.0), p67 = 1.0 / 720.0 + r * (1.0 / 5040.0);
  const Lanes p89 = 1.0 / 40320.0 + r * (1.0 / 362880.0), p1011 = 1.0 / 3628800.0 + r * (1.0 / 39916800.0);
  const Lanes high = p89 + r2 * p1011 + r4 * (1.0 / 479001600.0);
  const Lanes power = ((p45 + r2 * p67) * r4 + high * r8) + (p01 + r2 * p23);
  const Bits scale = (reinterpret_cast<Bits>(shifted) + 1023) << 52;
  return select(counts, power * reinterpret_cast<Lanes>(scale), fill(0.0));
}

struct Weighed {
  Lanes inverse, logit;
};
POVSLAM_INLINE Weighed weigh(const VemNoise& noise, int i, double odds, Lanes error2) {
  const Lanes own = lanes(noise.inverse_variance[i]);
  const Bits raised = own > noise.most_inverse;
  const Lanes inverse = select(raised, fill(noise.most_inverse), own);
  const Lanes bias = select(raised, fill(noise.its_bias), lanes(noise.bias[i]));
  return {inverse, odds + bias - 0.5 * error2 * inverse};
}

POVSLAM_INLINE double sum_of_logs(Lanes a) {
  double out = 0.0;
  for (int lane = 0; lane < kVemLanes; ++lane) out += __builtin_log(a[lane]);
  return out;
}

}  // namespace

void expect(const VemNoise* noise, const Quad* error2, VemExpect* sums, Quad* pi) {
  Lanes sum_pi = fill(0.0), excess = fill(0.0), product = fill(1.0);
  double sum_log = 0.0;
  for (int i = 0; i < noise->count; ++i) {
    const Weighed match = weigh(*noise, i, sums->odds, lanes(error2[i]));
    const Bits matched = match.inverse > 0.0;
    const Lanes logit = match.logit;
    const Bits positive = logit > 0.0;
    const Lanes t = exp_negative(select(positive, -logit, logit));
    const Lanes p = select(matched, select(positive, fill(1.0), t) / (1.0 + t), fill(0.0));
    lanes(pi[i]) = p;
    sum_pi += p;
    excess += select(matched & positive, logit, fill(0.0));
    product *= select(matched, 1.0 + t, fill(1.0));
    if (i % 512 == 511) {  // each factor is at most 2
      sum_log += sum_of_logs(product);
      product = fill(1.0);
    }
  }
  sums->sum_pi = sum(sum_pi);
  sums->sum_excess = sum(excess) + sum_log + sum_of_logs(product);
}

VemDecision gate(const VemNoise* noise, double odds, const Quad* error2, const Quad* pi, Quad* information) {
  Lanes accepted = fill(0.0), flipped = fill(0.0);
  for (int i = 0; i < noise->count; ++i) {
    const Weighed match = weigh(*noise, i, odds, lanes(error2[i]));
    const Bits passed = match.logit >= 0.0;
    const Bits before = lanes(information[i]) > 0.0;
    const Lanes now = select(passed, lanes(pi[i]) * match.inverse, fill(0.0));
    lanes(information[i]) = now;
    accepted += select(now > 0.0, fill(1.0), fill(0.0));
    flipped += select((now > 0.0) ^ before, fill(1.0), fill(0.0));
  }
  return {static_cast<int>(sum(accepted)), static_cast<int>(sum(flipped))};
}

}  // namespace povslam::POVSLAM_ISA
