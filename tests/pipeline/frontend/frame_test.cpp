#include "pipeline/frontend/frame.hpp"

#include <gtest/gtest.h>

#include <random>

#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/pipeline/frontend/textured_image.hpp"

namespace povslam {
namespace {

constexpr int kWidth = 320, kHeight = 240;

// A textured image whose pixels have the depth told, with noise that is even in inverse depth.
template <class InverseDepth>
RgbdFrame image_of(const InverseDepth& inverse_depth, double sigma_per_m) {
  RgbdFrame image;
  image.color = textured_image(kWidth, kHeight);
  image.depth.resize(kWidth, kHeight);
  image.depth_scale = 5000.0F;
  std::mt19937 random(1);
  std::normal_distribution<double> noise(0.0, 1.0);
  for (int y = 0; y < kHeight; ++y) {
    for (int x = 0; x < kWidth; ++x) {
      const double inverse = std::max(0.1, inverse_depth(x) + sigma_per_m * noise(random));
      image.depth.at(x, y) = static_cast<std::uint16_t>(std::lround(5000.0 / inverse));
    }
  }
  return image;
}

struct Built {
  explicit Built(const RgbdFrame& image) : builder(made::half_camera(), options), frame(made::half_camera(), options) {
    builder.build(image, 1.0, frame);
  }
  FrontendOptions options;
  FrameBuilder builder;
  Frame frame;
};

}  // namespace

// A constant share would shrink the map, and no loop closure could tell.
TEST(DepthOfAFeature, HasNoBiasHoweverNoisyTheSensor) {
  constexpr double kInverse = 0.25;
  for (const double sigma : {0.0, 0.0025, 0.005, 0.01}) {
    const Built built(image_of([](int) { return kInverse; }, sigma));
    double sum = 0.0;
    int count = 0;
    for (int i = 0; i < built.frame.size(); ++i) {
      if (!built.frame.has_depth(i)) continue;
      sum += static_cast<double>(built.frame.inverse_depth[static_cast<std::size_t>(i)]);
      ++count;
    }
    ASSERT_GT(count, 200) << sigma;
    EXPECT_NEAR(sum / count, kInverse, 0.004 * kInverse) << sigma;
  }
}

TEST(DepthOfAFeature, IsThatOfWhatStandsInFront) {
  const double near = 0.5, far = 0.25;
  const auto half = [&](int x) { return x < kWidth / 2 ? near : far; };
  const Built built(image_of(half, 0.0025));
  int on_edge = 0;
  for (int i = 0; i < built.frame.size(); ++i) {
    const std::size_t k = static_cast<std::size_t>(i);
    const float beyond_px = built.frame.features.x[k] - 0.5F * kWidth;
    if (!built.frame.has_depth(i) || std::abs(beyond_px) < 0.5F) continue;
    if (beyond_px > 0.0F && beyond_px < 4.0F) continue;  // a corner there may be of either
    on_edge += beyond_px > -2.0F && beyond_px < 0.0F ? 1 : 0;
    EXPECT_NEAR(built.frame.inverse_depth[k], beyond_px < 0.0F ? near : far, 0.01) << beyond_px;
  }
  EXPECT_GT(on_edge, 0);
}

}  // namespace povslam
