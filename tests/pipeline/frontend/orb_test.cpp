#include "pipeline/frontend/orb.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <opencv2/imgproc.hpp>
#include <string>

#include "pipeline/frontend/kernels/dispatch.hpp"
#include "tests/pipeline/frontend/textured_image.hpp"
#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

OrbFeatures extract(const ImageU8& image, const OrbOptions& options = {},
                    const FrontendKernels& kernels = frontend_kernels()) {
  OrbExtractor extractor(image.width(), image.height(), options, kernels);
  OrbFeatures features(options.num_features);
  extractor.extract(image.data(), image.stride(), features);
  return features;
}

std::uint64_t checksum(const OrbFeatures& features) {
  std::uint64_t sum = 14695981039346656037ULL;  // FNV-1a
  const auto add = [&](const void* data, std::size_t bytes) {
    for (std::size_t k = 0; k < bytes; ++k) sum = (sum ^ static_cast<const std::uint8_t*>(data)[k]) * 1099511628211ULL;
  };
  const auto n = static_cast<std::size_t>(features.size);
  for (const auto* values : {&features.x, &features.y, &features.angle, &features.response}) {
    add(values->data(), n * sizeof(float));
  }
  add(features.level.data(), n);
  add(features.descriptor.data(), n * sizeof(Descriptor));
  return sum;
}

// Position of a feature on its level, px.
float on_level(float at_level0, float scale) {
  return (at_level0 + 0.5F) / scale - 0.5F;
}

}  // namespace

TEST(Orb, GivesTheSameFeaturesOnEveryInstructionSet) {
  const ImageU8 image = textured_image(641, 479);
  const OrbFeatures first = extract(image, {}, *available_kernels().kernels[0]);
  EXPECT_EQ(first.size, 1000);
  for (int k = 1; available_kernels().kernels[k] != nullptr; ++k) {
    EXPECT_EQ(checksum(extract(image, {}, *available_kernels().kernels[k])), checksum(first))
        << available_kernels().kernels[k]->isa;
  }
}

TEST(Orb, ShowsItsChecksum) {
  std::printf("checksum %016lx\n", checksum(extract(textured_image(320, 240))));
}

TEST(Orb, GivesTheSameFeaturesOnAMachineWithoutAvx) {
  if (std::system("command -v qemu-x86_64 > /dev/null 2>&1") != 0) GTEST_SKIP() << "install qemu-user to run this";
  if (!counting_works()) GTEST_SKIP() << "sanitizers do not run under qemu-user";
  FILE* const pipe =
      popen("qemu-x86_64 -cpu Nehalem $(readlink /proc/$PPID/exe) --gtest_filter=Orb.ShowsItsChecksum", "r");
  ASSERT_NE(pipe, nullptr);
  std::string output;
  for (char line[256]; std::fgets(line, sizeof(line), pipe) != nullptr;) output += line;
  EXPECT_EQ(pclose(pipe), 0) << output;
  char expected[64];
  std::snprintf(expected, sizeof(expected), "checksum %016lx\n", checksum(extract(textured_image(320, 240))));
  EXPECT_NE(output.find(expected), std::string::npos) << output;
}

TEST(Orb, AllocatesNothingAfterConstruction) {
  if (!counting_works()) GTEST_SKIP() << "the sanitizer owns malloc";
  OrbExtractor extractor(640, 480, {.num_features = 4000});
  OrbFeatures features(4000);
  const ImageU8 images[2] = {textured_image(640, 480, 1), textured_image(640, 480, 2)};
  start_counting();
  for (const ImageU8& image : images) extractor.extract(image.data(), image.stride(), features);
  const CallCounts calls = stop_counting();
  EXPECT_EQ(calls.allocations + calls.maps + calls.locks, 0U);
  EXPECT_EQ(features.size, 4000);
}

TEST(Orb, SpreadsFeaturesOverAllPartsOfTheImage) {
  ImageU8 image = textured_image(640, 480);
  // One quarter is poor in contrast: it gets its share all the same.
  for (int y = 0; y < 240; ++y) {
    for (int x = 0; x < 320; ++x) image.at(x, y) = static_cast<std::uint8_t>(120 + (image.at(x, y) - 120) / 6);
  }
  const OrbFeatures features = extract(image);
  ASSERT_EQ(features.size, 1000);
  int per_part[6][8] = {};
  for (int k = 0; k < features.size; ++k) {
    ++per_part[static_cast<int>(features.y[k]) / 80][static_cast<int>(features.x[k]) / 80];
  }
  for (int row = 0; row < 6; ++row) {
    for (int column = 0; column < 8; ++column) EXPECT_GE(per_part[row][column], 4) << row << " " << column;
  }
}

TEST(Orb, DeliversLevelsInOrderInsideTheImage) {
  const OrbFeatures features = extract(textured_image(640, 480));
  OrbExtractor extractor(640, 480, {});
  int per_level[kMaxPyramidLevels] = {};
  for (int k = 0; k < features.size; ++k) {
    ++per_level[features.level[k]];
    EXPECT_GE(features.level[k], features.level[std::max(k - 1, 0)]);
    const PyramidLevel& level = extractor.level(features.level[k]);
    const float x = on_level(features.x[k], level.scale), y = on_level(features.y[k], level.scale);
    EXPECT_TRUE(x > 14.0F && x < static_cast<float>(level.width) - 15.0F) << x;
    EXPECT_TRUE(y > 14.0F && y < static_cast<float>(level.height) - 15.0F) << y;
  }
  for (int l = 1; l < extractor.num_levels(); ++l) {
    EXPECT_GT(per_level[l], 0);
    EXPECT_LT(per_level[l], per_level[l - 1]);
    EXPECT_FLOAT_EQ(extractor.level(l).scale, extractor.scale(l));
  }
}

TEST(Orb, AlignsTheLevelsOfThePyramidAtPixelCentres) {
  // On a ramp bilinear interpolation is exact: every level must show the ramp's value at its pixels' centres.
  ImageU8 image(300, 200);
  for (int y = 0; y < 200; ++y) {
    for (int x = 0; x < 300; ++x) image.at(x, y) = static_cast<std::uint8_t>(std::lround(0.5 * x + 0.45 * y));
  }
  OrbExtractor extractor(300, 200, {});
  OrbFeatures features(1000);
  extractor.extract(image.data(), image.stride(), features);
  for (int l = 0; l < extractor.num_levels(); ++l) {
    const PyramidLevel& level = extractor.level(l);
    double sum = 0.0;
    int count = 0;
    for (int y = 4; y < level.height - 4; ++y) {
      for (int x = 4; x < level.width - 4; ++x, ++count) {
        const double expected = 0.5 * ((x + 0.5) * level.scale - 0.5) + 0.45 * ((y + 0.5) * level.scale - 0.5);
        EXPECT_NEAR(level.pixels[y * level.stride + x], expected, 1.6);
        sum += level.pixels[y * level.stride + x] - expected;
      }
    }
    EXPECT_NEAR(sum / count, 0.0, 0.1) << "level " << l;
  }
}

TEST(Orb, FindsAMovedImagesFeaturesToAFractionOfAPixel) {
  // A smooth image, sampled twice with a known shift in between.
  const ImageU8 texture = textured_image(640, 480);
  const cv::Mat source(480, 640, CV_8U, const_cast<std::uint8_t*>(texture.data()));
  cv::Mat soft, moved;
  cv::GaussianBlur(source, soft, {}, 1.0);
  const cv::Mat shift = (cv::Mat_<double>(2, 3) << 1, 0, 3.37, 0, 1, -2.21);
  cv::warpAffine(soft, moved, shift, soft.size(), cv::INTER_LANCZOS4, cv::BORDER_REPLICATE);
  OrbExtractor extractor(640, 480, {});
  OrbFeatures before(1000), after(1000);
  extractor.extract(soft.data, static_cast<std::int64_t>(soft.step), before);
  extractor.extract(moved.data, static_cast<std::int64_t>(moved.step), after);
  double squared = 0.0;
  int matched = 0;
  for (int k = 0; k < before.size; ++k) {
    const NearestDescriptor nearest = nearest_descriptor(before.descriptor[k], after.descriptor.data(), after.size);
    const float scale = extractor.scale(before.level[k]);
    const float dx = after.x[nearest.index] - before.x[k] - 3.37F, dy = after.y[nearest.index] - before.y[k] + 2.21F;
    if (nearest.distance > 40 || std::hypot(dx, dy) > 2.0F * scale) continue;
    ++matched;
    squared += (dx * dx + dy * dy) / (scale * scale);
  }
  EXPECT_GT(matched, 700);
  EXPECT_LT(std::sqrt(squared / matched), 0.35);  // px of the level, between two images
}

TEST(Orb, TurnsItsAngleAndKeepsItsDescriptorWhenTheImageTurns) {
  const ImageU8 texture = textured_image(400, 400);
  const cv::Mat source(400, 400, CV_8U, const_cast<std::uint8_t*>(texture.data()));
  cv::Mat soft, turned;
  cv::GaussianBlur(source, soft, {}, 1.0);
  cv::rotate(soft, turned, cv::ROTATE_90_CLOCKWISE);  // (x, y) -> (399 - y, x)
  OrbExtractor extractor(400, 400, {});
  OrbFeatures before(1000), after(1000);
  extractor.extract(soft.data, static_cast<std::int64_t>(soft.step), before);
  extractor.extract(turned.data, static_cast<std::int64_t>(turned.step), after);
  int right = 0;
  for (int k = 0; k < before.size; ++k) {
    const NearestDescriptor nearest = nearest_descriptor(before.descriptor[k], after.descriptor.data(), after.size);
    const float off = std::hypot(after.x[nearest.index] - (399.0F - before.y[k]), after.y[nearest.index] - before.x[k]);
    if (off > 1.0F * extractor.scale(before.level[k])) continue;
    const double turn = after.angle[nearest.index] - before.angle[k] - M_PI / 2.0;
    if (std::abs(std::remainder(turn, 2.0 * M_PI)) < 0.1) ++right;
  }
  EXPECT_GT(right, 850);
}

TEST(Orb, TakesImagesOfAnySizeAndStride) {
  for (const auto& [width, height] : {std::pair{64, 64}, {65, 300}, {301, 67}, {127, 129}, {1025, 64}, {752, 480}}) {
    const int stride = width + 13;
    const ImageU8 wide = textured_image(stride, height);
    ImageU8 narrow(width, height);
    for (int y = 0; y < height; ++y) std::memcpy(narrow.row(y), wide.row(y), static_cast<std::size_t>(width));
    OrbExtractor extractor(width, height, {.num_levels = kMaxPyramidLevels});
    OrbFeatures of_wide(1000), of_narrow(1000);
    extractor.extract(wide.data(), stride, of_wide);
    extractor.extract(narrow.data(), width, of_narrow);
    EXPECT_GT(of_wide.size, 0) << width << " x " << height;
    EXPECT_EQ(checksum(of_wide), checksum(of_narrow));
  }
}

TEST(Orb, FindsNothingOnAnEmptyWall) {
  ImageU8 image(320, 240);
  image.fill(128);
  EXPECT_EQ(extract(image).size, 0);
}

TEST(Orb, NeverExceedsTheWantedNumber) {
  for (const int wanted : {1, 7, 500, 3000}) {
    EXPECT_EQ(extract(textured_image(640, 480), {.num_features = wanted}).size, wanted);
  }
}

TEST(NearestDescriptor, FindsTheNearestAndTheRunnerUp) {
  Descriptor candidates[3] = {};
  candidates[0] = {0xFFU, 0, 0, 0};
  candidates[1] = {0x7U, 0, 0, 0};
  candidates[2] = {0, 0, 0, ~0ULL};
  const NearestDescriptor nearest = nearest_descriptor({0x3U, 0, 0, 0}, candidates, 3);
  EXPECT_EQ(nearest.index, 1);
  EXPECT_EQ(nearest.distance, 1);
  EXPECT_EQ(nearest.second_distance, 6);
  EXPECT_EQ(nearest_descriptor({}, candidates, 0).index, -1);
  EXPECT_EQ(hamming_distance(candidates[1], candidates[2]), 67);
}

TEST(Orb, GivesMoreFeaturesWhereTheyAreWished) {
  const ImageU8 image = textured_image(640, 480);
  const FeatureWish wish{200.0F, 150.0F, 260.0F, 230.0F};
  const auto inside = [&](const OrbFeatures& features) {
    int count = 0;
    for (std::size_t k = 0; k < static_cast<std::size_t>(features.size); ++k) {
      const bool across = features.x[k] >= wish.x0 && features.x[k] < wish.x1;
      count += across && features.y[k] >= wish.y0 && features.y[k] < wish.y1 ? 1 : 0;
    }
    return count;
  };
  OrbExtractor extractor(640, 480, {});
  OrbFeatures even(1000), wished(1000), again(1000);
  extractor.extract(image.data(), image.stride(), even);
  extractor.extract(image.data(), image.stride(), wished, {&wish, 1});
  extractor.extract(image.data(), image.stride(), again);
  EXPECT_EQ(wished.size, even.size) << "the others give what it gets";
  EXPECT_GT(10 * inside(wished), 12 * inside(even));
  std::vector<FeatureWish> many;
  for (int k = 0; k < 30; ++k) {
    const auto x = static_cast<float>(20 + 100 * (k % 6)), y = static_cast<float>(20 + 90 * (k / 6));
    many.push_back({x, y, x + 60.0F, y + 60.0F});
  }
  OrbFeatures everywhere(1000);
  extractor.extract(image.data(), image.stride(), everywhere, many);
  EXPECT_EQ(everywhere.size, even.size);
  const auto of_level = [](const OrbFeatures& features, int level) {
    return std::count(features.level.begin(), features.level.begin() + features.size, level);
  };
  for (const int level : {0, 3}) EXPECT_EQ(of_level(everywhere, level), of_level(even, level)) << level;
  EXPECT_EQ(checksum(again), checksum(even)) << "a wish holds for one image";
}

}  // namespace povslam
