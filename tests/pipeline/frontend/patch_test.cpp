#include "pipeline/frontend/patch.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "pipeline/frames/image.hpp"

namespace povslam {
namespace {

// A smooth pattern that is known everywhere, not on pixels only.
class Pattern {
 public:
  explicit Pattern(unsigned seed) {
    std::mt19937 random(seed);
    std::uniform_real_distribution<double> frequency(0.15, 0.55), phase(0.0, 6.28), direction(0.0, 3.14);
    for (Wave& wave : waves_) {
      const double f = frequency(random), d = direction(random);
      wave = {f * std::cos(d), f * std::sin(d), phase(random)};
    }
  }
  double at(double x, double y) const {
    double sum = 128.0;
    for (const Wave& wave : waves_) sum += 11.0 * std::sin(wave.fx * x + wave.fy * y + wave.phase);
    return sum;
  }

 private:
  struct Wave {
    double fx, fy, phase;
  };
  std::array<Wave, 8> waves_{};
};

// The pattern seen through A: image pixel p shows the pattern at A (p - centre) + place.
struct Look {
  float a[4] = {1.0F, 0.0F, 0.0F, 1.0F};
  double centre_x = 40.0, centre_y = 40.0, place_x = 0.0, place_y = 0.0, gain = 1.0, offset = 0.0;
};

ImageU8 draw(const Pattern& pattern, const Look& look) {
  ImageU8 image(80, 80);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) {
      const double dx = x - look.centre_x, dy = y - look.centre_y;
      const double value =
          pattern.at(look.a[0] * dx + look.a[1] * dy + look.place_x, look.a[2] * dx + look.a[3] * dy + look.place_y);
      image.at(x, y) = static_cast<std::uint8_t>(std::lround(std::clamp(look.gain * value + look.offset, 0.0, 255.0)));
    }
  }
  return image;
}

PyramidLevel level_of(const ImageU8& image) {
  return {image.width(), image.height(), static_cast<std::int64_t>(image.stride()), image.data(), 1.0F};
}

Patch cut(const ImageU8& image, float x = 40.0F, float y = 40.0F) {
  Patch patch;
  EXPECT_TRUE(cut_patch(level_of(image), x, y, patch));
  return patch;
}

double error_squared(const PatchPlace& place, const Look& truth, unsigned seed) {
  const double dx = place.x - truth.centre_x, dy = place.y - truth.centre_y;
  EXPECT_LT(std::hypot(dx, dy), 0.08) << seed;
  return dx * dx + dy * dy;
}

constexpr float kAsItIs[4] = {1.0F, 0.0F, 0.0F, 1.0F};

}  // namespace

TEST(Patch, FindsAShiftToAFewHundredthsOfAPixel) {
  std::mt19937 random(1);
  std::uniform_real_distribution<double> shift(-1.0, 1.0);
  int converged = 0;
  double squared = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Pattern pattern(seed);
    const Patch patch = cut(draw(pattern, {}));
    Look moved;
    moved.centre_x += shift(random);
    moved.centre_y += shift(random);
    const ImageU8 image = draw(pattern, moved);
    const PatchPlace place = find_patch(patch, kAsItIs, level_of(image), 40.0F, 40.0F, 2.5F);
    if (!place.converged) continue;
    ++converged;
    squared += error_squared(place, moved, seed);
    EXPECT_GT(place.correlation, 0.99F) << seed;
  }
  EXPECT_GE(converged, 36);
  EXPECT_LT(std::sqrt(squared / converged), 0.03);
}

TEST(Patch, FindsAShiftUnderAKnownWarpAndAnotherExposure) {
  std::mt19937 random(2);
  std::uniform_real_distribution<double> shift(-1.0, 1.0);
  std::uniform_real_distribution<float> skew(-0.25F, 0.25F), size(0.8F, 1.25F);
  int converged = 0;
  double squared = 0.0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Pattern pattern(seed);
    const Patch patch = cut(draw(pattern, {}));
    Look warped{{size(random), skew(random), skew(random), size(random)}};
    warped.centre_x += shift(random);
    warped.centre_y += shift(random);
    warped.gain = 0.6;
    warped.offset = 20.0;
    const ImageU8 image = draw(pattern, warped);
    const PatchPlace place = find_patch(patch, warped.a, level_of(image), 40.0F, 40.0F, 2.5F);
    if (!place.converged) continue;
    ++converged;
    squared += error_squared(place, warped, seed);
    EXPECT_GT(place.correlation, 0.97F) << seed;
  }
  EXPECT_GE(converged, 36);
  EXPECT_LT(std::sqrt(squared / converged), 0.03);
}

TEST(Patch, KeepsTheFractionItIsCutAt) {
  const Pattern pattern(3);
  const ImageU8 image = draw(pattern, {});
  const Patch patch = cut(image, 37.3F, 41.8F);
  const PatchPlace place = find_patch(patch, kAsItIs, level_of(image), 38.0F, 41.0F, 2.5F);
  ASSERT_TRUE(place.converged);
  EXPECT_NEAR(place.x, 37.3F, 0.05F);
  EXPECT_NEAR(place.y, 41.8F, 0.05F);
}

TEST(Patch, RefusesWhatShowsNoCorner) {
  ImageU8 flat(80, 80), edge(80, 80);
  flat.fill(100);
  for (int y = 0; y < 80; ++y) {
    for (int x = 0; x < 80; ++x) edge.at(x, y) = static_cast<std::uint8_t>(std::clamp(128 + 20 * (x - 40), 20, 230));
  }
  for (const ImageU8* image : {&flat, &edge}) {
    EXPECT_FALSE(find_patch(cut(*image), kAsItIs, level_of(*image), 40.0F, 40.0F, 2.5F).converged);
  }
  const ImageU8 corners = draw(Pattern(1), {});
  EXPECT_FALSE(find_patch(cut(corners), kAsItIs, level_of(flat), 40.0F, 40.0F, 2.5F).converged);
}

TEST(Patch, RefusesAShiftBeyondItsReach) {
  const Pattern pattern(5);
  const Patch patch = cut(draw(pattern, {}));
  Look moved;
  moved.centre_x += 2.0;
  const ImageU8 image = draw(pattern, moved);
  EXPECT_TRUE(find_patch(patch, kAsItIs, level_of(image), 40.0F, 40.0F, 2.5F).converged);
  EXPECT_FALSE(find_patch(patch, kAsItIs, level_of(image), 40.0F, 40.0F, 1.5F).converged);
}

TEST(Patch, FitsAnotherPatternBadly) {
  int fooled = 0;
  for (unsigned seed = 1; seed <= 40; ++seed) {
    const Patch patch = cut(draw(Pattern(seed), {}));
    const ImageU8 other = draw(Pattern(seed + 100), {});
    const PatchPlace place = find_patch(patch, kAsItIs, level_of(other), 40.0F, 40.0F, 2.5F);
    if (place.converged && place.correlation > 0.8F) ++fooled;
  }
  EXPECT_LE(fooled, 1);
}

TEST(Patch, StaysInsideTheImage) {
  // Exactly as large as the level says: a sanitizer sees any pixel read beyond.
  const ImageU8 image = draw(Pattern(6), {});
  const PyramidLevel level = level_of(image);
  Patch patch;
  for (float x = -30.0F; x < 110.0F; x += 0.37F) {
    for (const float y : {-1e6F, -3.0F, 5.9F, 11.5F, 40.2F, 67.4F, 73.9F, 81.0F, 1e6F}) {
      const bool whole = x >= 12.0F && y >= 12.0F && x < 68.0F && y < 68.0F;
      EXPECT_EQ(cut_patch(level, x, y, patch), whole) << x << ' ' << y;
      const PatchPlace place = find_patch(cut(image), kAsItIs, level, x, y, 2.5F);
      const bool inside = x >= 6.0F && y >= 6.0F && x < 73.0F && y < 73.0F;
      if (!inside) {
        EXPECT_FALSE(place.converged) << x << ' ' << y;
      }
    }
  }
  const float too_wide[4] = {2.0F, 0.0F, 0.0F, 2.0F};
  EXPECT_FALSE(find_patch(cut(image), too_wide, level, 40.0F, 40.0F, 2.5F).converged);
}

}  // namespace povslam
