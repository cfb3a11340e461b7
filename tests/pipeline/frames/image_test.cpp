#include "pipeline/frames/image.hpp"

#include <gtest/gtest.h>

#include <numeric>

namespace povslam {
namespace {

ImageU16 counting(int width, int height, int channels) {
  ImageU16 image(width, height, channels);
  std::iota(image.pixels().begin(), image.pixels().end(), std::uint16_t{0});
  return image;
}

}  // namespace

TEST(Image, KeepsItsBufferForSizesItHasSeen) {
  ImageU8 image(640, 480, 3);
  const std::uint8_t* const memory = image.data();
  image.resize(320, 240);
  image.resize(0, 0);
  image.resize(480, 640, 3);
  EXPECT_EQ(image.data(), memory);
}

TEST(Image, StartsOnACacheLine) {
  for (const int width : {1, 7, 641}) {
    EXPECT_EQ(reinterpret_cast<std::uintptr_t>(ImageU8(width, 3).data()) % 64, 0U);
  }
}

TEST(Image, AddressesChannelsRowByRow) {
  const ImageU16 image = counting(4, 3, 2);
  EXPECT_EQ(image.stride(), 8U);
  EXPECT_EQ(image.at(3, 2, 1), 2 * 8 + 3 * 2 + 1);
  EXPECT_EQ(image.row(1)[0], 8);
}

TEST(Image, CopiesPixelsIntoItsOwnBuffer) {
  const ImageU16 original = counting(5, 4, 1);
  ImageU16 copy(10, 10);
  const std::uint16_t* const memory = copy.data();
  copy = original;
  EXPECT_EQ(copy.data(), memory);
  EXPECT_EQ(copy.width(), 5);
  EXPECT_TRUE(std::equal(copy.pixels().begin(), copy.pixels().end(), original.pixels().begin()));
  copy.fill(0);
  EXPECT_EQ(original.at(4, 3), 19);
}

TEST(Image, CanBeUsedAgainAfterItWasMovedFrom) {
  ImageU8 source(8, 8);
  const std::uint8_t* const memory = source.data();
  ImageU8 target = std::move(source);
  EXPECT_EQ(target.data(), memory);
  EXPECT_TRUE(source.empty());  // NOLINT(bugprone-use-after-move): this is the promise
  source.resize(8, 8);
  ASSERT_NE(source.data(), nullptr);
  source.fill(3);
  target.fill(1);
  EXPECT_EQ(source.at(7, 7), 3);
}

TEST(Image, MayBeEmpty) {
  const ImageU8 nothing;
  const ImageU8 copy = nothing;
  EXPECT_TRUE(copy.empty());
  EXPECT_TRUE(copy.pixels().empty());
}

TEST(ImageDeathTest, RefusesNegativeSizes) {
  EXPECT_DEATH(ImageU8(-1, 4), "contract failed");
}

}  // namespace povslam
