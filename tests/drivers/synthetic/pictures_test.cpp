#include "drivers/synthetic/pictures.hpp"

#include <gtest/gtest.h>

#include "drivers/synthetic/faces.hpp"
#include "tests/drivers/synthetic/support.hpp"

namespace povslam::synthetic {

namespace {

bool same_texels(const Texture& a, const Texture& b) {
  const std::size_t count = Texture::num_texels(a.width(), a.height());
  return a.width() == b.width() && a.height() == b.height() && std::equal(a.texels(), a.texels() + count, b.texels());
}

}  // namespace

TEST(Pictures, AreForgottenWhenNobodyLooksAndPaintedTheSameAgain) {
  const World world = make_world(small_options("boxsim", 1));
  Pictures pictures(world);
  EXPECT_EQ(pictures.num_kept(), 0);
  const Texture before = pictures.look_at(0, 0);
  pictures.look_at(1, 0);
  EXPECT_EQ(pictures.num_kept(), 2);
  for (std::int64_t image = 0; image <= Pictures::kKeptImages; ++image) {
    pictures.begin_image();
    pictures.look_at(1, 0);
  }
  EXPECT_EQ(pictures.num_kept(), 1);
  EXPECT_TRUE(same_texels(pictures.look_at(0, 0), before));
}

TEST(Pictures, TheSamePrintOnSeveralFacesIsKeptOnce) {
  const World world = make_world(small_options("aisle", 1));
  Pictures pictures(world);
  int surfaces = 0;
  for (std::size_t i = 0; i < world.scene().objects.size(); ++i) {
    const int faces = kFacesPerPart * static_cast<int>(world.scene().objects[i].parts.size());
    for (int surface = 0; surface < faces; ++surface, ++surfaces) pictures.look_at(static_cast<int>(i), surface);
  }
  EXPECT_EQ(pictures.num_kept(), world.num_pictures());
  EXPECT_LT(world.num_pictures(), surfaces / 2);
}

TEST(Pictures, ThePyramidHasExactlyTheTexelsItTakes) {
  for (const auto& [width, height] : {std::pair{64, 64}, std::pair{1, 7}, std::pair{33, 5}}) {
    const Texture texture(width, height, std::vector<Texel>(static_cast<std::size_t>(width * height)));
    const MipLevel& last = texture.levels()[static_cast<std::size_t>(texture.num_levels() - 1)];
    EXPECT_EQ(Texture::num_texels(width, height), last.offset + static_cast<std::size_t>(last.width * last.height));
  }
}

}  // namespace povslam::synthetic
