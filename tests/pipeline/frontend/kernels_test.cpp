#include "pipeline/frontend/kernels/kernels.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <random>
#include <string>
#include <vector>

#include "pipeline/frontend/kernels/dispatch.hpp"
#include "pipeline/frontend/orb_pattern.hpp"
#include "tests/pipeline/frontend/textured_image.hpp"

namespace povslam {
namespace {

// Run for every instruction set this machine has.
class Kernels : public testing::TestWithParam<int> {
 protected:
  const FrontendKernels& kernels() const { return *available_kernels().kernels[GetParam()]; }
};

int count_kernels() {
  int count = 0;
  while (available_kernels().kernels[count] != nullptr) ++count;
  return count;
}

// FAST-9 by its definition: the largest threshold at which nine in a row are brighter, or darker; -1 if none is.
int fast_score(const ImageU8& image, int x, int y) {
  static constexpr int kX[16] = {0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3, -3, -3, -2, -1};
  static constexpr int kY[16] = {-3, -3, -2, -1, 0, 1, 2, 3, 3, 3, 2, 1, 0, -1, -2, -3};
  int best = 0;
  for (int sign : {-1, 1}) {
    for (int start = 0; start < 16; ++start) {
      int least = 255;
      for (int k = start; k < start + 9; ++k) {
        least = std::min(least, sign * (image.at(x + kX[k % 16], y + kY[k % 16]) - image.at(x, y)));
      }
      best = std::max(best, least);
    }
  }
  return best - 1;
}

std::vector<FastCorner> corners_by_definition(const ImageU8& image, PixelRect rect, int threshold) {
  const auto score = [&](int x, int y) {
    if (x < rect.x0 || x >= rect.x1 || y < rect.y0 || y >= rect.y1) return -1;
    const int s = fast_score(image, x, y);
    return s >= threshold ? s : -1;
  };
  std::vector<FastCorner> corners;
  for (int y = rect.y0; y < rect.y1; ++y) {
    for (int x = rect.x0; x < rect.x1; ++x) {
      const int here = score(x, y);
      bool peak = here >= 0;
      for (int k = 0; k < 9 && peak; ++k) {
        if (k == 4) continue;
        const int other = score(x + k % 3 - 1, y + k / 3 - 1);
        peak = k < 4 ? here > other : here >= other;
      }
      if (peak) corners.push_back({std::uint16_t(x), std::uint16_t(y), std::uint8_t(here), 0.0F, 0.0F});
    }
  }
  return corners;
}

}  // namespace

TEST_P(Kernels, FindTheCornersOfTheDefinition) {
  for (const int width : {40, 63, 64, 65, 131}) {
    // The kernel may read whole vectors past the image: rows are padded and the buffer is longer.
    const ImageU8 image = textured_image(width + 2 * kKernelSlack, 50, static_cast<unsigned>(width));
    const PixelRect rect{3, 3, width - 3, 41};
    std::vector<std::uint8_t> scratch(3 * (static_cast<std::size_t>(width) + 2 * kKernelSlack));
    std::vector<FastCorner> found(static_cast<std::size_t>(width) * 50);
    for (const int threshold : {1, 7, 40}) {
      const int count = kernels().find_corners({image.data(), static_cast<std::int64_t>(image.stride())}, rect,
                                               threshold, scratch.data(), found.data());
      const std::vector<FastCorner> expected = corners_by_definition(image, rect, threshold);
      ASSERT_EQ(count, static_cast<int>(expected.size())) << "width " << width << " threshold " << threshold;
      ASSERT_GT(count, 0);
      for (int k = 0; k < count; ++k) {
        EXPECT_EQ(found[k].x, expected[k].x);
        EXPECT_EQ(found[k].y, expected[k].y);
        EXPECT_EQ(found[k].score, expected[k].score);
      }
    }
  }
}

TEST_P(Kernels, TurnColourIntoGreyWithinHalfALevel) {
  std::mt19937 random(3);
  for (const int count : {0, 1, 15, 16, 17, 18, 19, 100, 1003}) {
    std::vector<std::uint8_t> rgb(3 * static_cast<std::size_t>(count)), grey(static_cast<std::size_t>(count));
    for (auto& value : rgb) value = static_cast<std::uint8_t>(random());
    kernels().rgb_to_grey(rgb.data(), grey.data(), count);
    for (int k = 0; k < count; ++k) {
      EXPECT_NEAR(grey[k], 0.299 * rgb[3 * k] + 0.587 * rgb[3 * k + 1] + 0.114 * rgb[3 * k + 2], 0.51);
    }
  }
}

TEST_P(Kernels, SumThePatchMoments) {
  const ImageU8 image = textured_image(128, 64);
  const PatchMask mask = round_patch();
  const PatchMoments moments = kernels().patch_moments(&image.at(40, 30), image.stride(), &mask);
  std::int32_t x = 0, y = 0;
  for (int v = -15; v <= 15; ++v) {
    for (int u = -15; u <= 15; ++u) {
      if (u * u + v * v > 15 * 16) continue;
      x += u * image.at(40 + u, 30 + v);
      y += v * image.at(40 + u, 30 + v);
    }
  }
  EXPECT_EQ(moments.x, x);
  EXPECT_EQ(moments.y, y);
}

TEST_P(Kernels, CompareThePairsOfBrief) {
  const ImageU8 image = textured_image(128, 64);
  const BriefPattern pattern(image.stride());
  const BriefPattern::Offsets tests = pattern.at_angle(1.0F);
  std::uint64_t bits[4];
  kernels().brief(&image.at(40, 30), tests.first, tests.second, bits);
  for (int k = 0; k < kBriefBits; ++k) {
    const bool darker = (&image.at(40, 30))[tests.first[k]] < (&image.at(40, 30))[tests.second[k]];
    EXPECT_EQ(bits[k / 64] >> (k % 64) & 1U, darker ? 1U : 0U) << "bit " << k;
  }
}

TEST_P(Kernels, SmoothWithUnitWeights) {
  ImageU8 image = textured_image(256, 40);
  std::vector<std::uint8_t> scratch(256 + 2 * kKernelSlack), out(256 + kKernelSlack);
  kernels().smooth_row(&image.at(16, 20), image.stride(), 100, scratch.data(), out.data());
  static constexpr int kWeights[7] = {9, 17, 24, 28, 24, 17, 9};
  for (int x = 0; x < 100; ++x) {
    double sum = 0.0;
    for (int k = 0; k < 49; ++k) sum += kWeights[k % 7] * kWeights[k / 7] * image.at(16 + x + k % 7 - 3, 17 + k / 7);
    EXPECT_NEAR(out[x], sum / (128.0 * 128.0), 1.01);
  }
  image.fill(201);
  kernels().smooth_row(&image.at(16, 20), image.stride(), 100, scratch.data(), out.data());
  EXPECT_EQ(out[50], 201);
}

TEST_P(Kernels, FindACornerWhereItIs) {
  // A light quadrant whose tip is at a known sub-pixel place, seen through pixels of unit area and a soft lens.
  ImageU8 image(96, 48);
  std::vector<double> offsets;
  for (const double tip : {23.6, 24.0, 24.3}) {
    for (int y = 0; y < 48; ++y) {
      for (int x = 0; x < 96; ++x) {
        const auto edge = [&](int at) { return 0.5 * std::erfc((tip - at) / 1.4); };
        image.at(x, y) = static_cast<std::uint8_t>(std::lround(40 + 160 * edge(x) * edge(y)));
      }
    }
    CornerPeak peak;
    ASSERT_TRUE(kernels().refine_corner(&image.at(24, 24), image.stride(), &peak));
    // The peak lies inside of the corner, on its diagonal, and moves with it.
    const double x = 24.0 + peak.column + static_cast<double>(peak.x);
    const double y = 24.0 + peak.row + static_cast<double>(peak.y);
    EXPECT_NEAR(x, y, 0.02);
    offsets.push_back(x - tip);
  }
  EXPECT_LT(std::abs(offsets[0]), 2.0);
  EXPECT_NEAR(offsets[1], offsets[0], 0.05);
  EXPECT_NEAR(offsets[2], offsets[0], 0.05);
  image.fill(77);
  CornerPeak peak;
  EXPECT_FALSE(kernels().refine_corner(&image.at(24, 24), image.stride(), &peak));
}

INSTANTIATE_TEST_SUITE_P(EachInstructionSet, Kernels, testing::Range(0, count_kernels()),
                         [](const auto& isa) { return available_kernels().kernels[isa.param]->isa; });

TEST(KernelDispatch, TakesTheWidestUnlessLowered) {
  const char* wanted = std::getenv("POVSLAM_ISA");
  const std::string widest = available_kernels().kernels[count_kernels() - 1]->isa;
  const std::string chosen = frontend_kernels().isa;
  EXPECT_EQ(chosen, wanted != nullptr && wanted < widest ? wanted : widest);
}

TEST(SteadyAtan2, AgreesWithTheLibrary) {
  for (int degree = -180; degree <= 180; ++degree) {
    const double angle = degree * M_PI / 180.0 + 1e-4;
    const float x = static_cast<float>(1e5 * std::cos(angle)), y = static_cast<float>(1e5 * std::sin(angle));
    EXPECT_NEAR(steady_atan2(y, x), std::atan2(y, x), 1e-6F);
  }
  EXPECT_EQ(steady_atan2(0.0F, 0.0F), 0.0F);
}

}  // namespace povslam
