#include "drivers/synthetic/texture.hpp"

#include <gtest/gtest.h>

#include "drivers/synthetic/paint.hpp"
#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr std::int32_t kOne = 1 << kCoordinateBits;

Texture checkers(int size) {
  std::vector<Texel> texels;
  for (int i = 0; i < size * size; ++i)
    texels.push_back((i % size + i / size) % 2 == 0 ? make_texel(200, 100, 0) : make_texel(0, 100, 200));
  return {size, size, texels};
}

}  // namespace

TEST(Texture, ReadsTexelCentresExactlyAndBlendsBetween) {
  const Texture texture(2, 1, {make_texel(40, 80, 120), make_texel(240, 80, 20)});
  EXPECT_EQ(from_lanes(sample(texture, kOne / 4, kOne / 2, 0)).red, 40);
  EXPECT_EQ(from_lanes(sample(texture, 3 * kOne / 4, kOne / 2, 0)).red, 240);
  const Rgb middle = from_lanes(sample(texture, kOne / 2, kOne / 2, 0));
  EXPECT_NEAR(middle.red, 140, 1);
  EXPECT_EQ(middle.green, 80);
  EXPECT_NEAR(middle.blue, 70, 1);
}

TEST(Texture, FadesToItsMeanInTheDistance) {
  const Texture texture = checkers(64);
  for (const std::int32_t level_256 : {256, 700, 1536, 5000}) {
    const Rgb far = from_lanes(sample(texture, kOne / 3, kOne / 5, level_256));
    EXPECT_NEAR(far.red, 100, 2);
    EXPECT_NEAR(far.green, 100, 2);
    EXPECT_NEAR(far.blue, 100, 2);
  }
}

TEST(Texture, StaysInsideItsTexelsAtTheBorders) {  // the address sanitizer watches
  const Texture texture = checkers(33);
  for (const std::int32_t s : {0, 1, kOne - 1, kOne}) {
    for (const std::int32_t t : {0, 1, kOne - 1, kOne}) {
      for (std::int32_t level_256 = -300; level_256 < 3000; level_256 += 100) {
        const Rgb rgb = from_lanes(sample(texture, s, t, level_256));
        EXPECT_LE(rgb.red, 200);
      }
    }
  }
}

TEST(Paint, EveryFaceOfEveryBoxIsAnother) {
  const Texture a = paint_face(Paint::carton, 0.8, 0.9, 1), same = paint_face(Paint::carton, 0.8, 0.9, 1),
                b = paint_face(Paint::carton, 0.8, 0.9, 2);
  int equal = 0, different = 0;
  for (int i = 0; i < a.width() * a.height(); ++i) {
    equal += a.texels()[i] == same.texels()[i];
    different += a.texels()[i] != b.texels()[i];
  }
  EXPECT_EQ(equal, a.width() * a.height());
  EXPECT_GT(different, a.width() * a.height() / 2);
}

}  // namespace povslam::synthetic
