#include "pipeline/mapping/kernels/kernels.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <numeric>
#include <random>

#include "pipeline/mapping/kernels/dispatch.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {
namespace {

constexpr int kColumns = 97, kRows = 61;
constexpr float kUnit_m = 2.1F / kMostUnits, kUnitsPer_m = kFullUnits / 0.2F;

// Blocks with any content before a picture with any content: each branch is taken somewhere.
struct Case {
  std::vector<float> depth_m = std::vector<float>(kColumns * kRows);
  std::vector<std::uint16_t> owner = std::vector<std::uint16_t>(kColumns * kRows);
  std::vector<std::uint8_t> color = std::vector<std::uint8_t>(3 * kColumns * kRows);
  std::vector<VoxelBlock> blocks = std::vector<VoxelBlock>(20);
  std::vector<std::array<float, 3>> origins = std::vector<std::array<float, 3>>(20);

  Case() {
    std::mt19937 random(3);
    std::uniform_real_distribution<float> uniform(0.0F, 1.0F);
    for (int k = 0; k < kColumns * kRows; ++k) {
      const float base = k % kColumns < 40 ? 1.3F : 2.0F;
      depth_m[static_cast<std::size_t>(k)] = uniform(random) < 0.05F ? 0.0F : base + 0.1F * uniform(random);
      owner[static_cast<std::size_t>(k)] = static_cast<std::uint16_t>(k % kColumns < 30   ? 2
                                                                      : k % kColumns < 60 ? 1
                                                                      : k / kColumns < 30 ? 0
                                                                                          : 1);
    }
    for (std::uint8_t& c : color) c = static_cast<std::uint8_t>(random());
    for (std::size_t b = 0; b < blocks.size(); ++b) {
      for (std::size_t k = 0; k < kBlockVoxels; ++k) {
        if (uniform(random) < 0.2F) continue;
        blocks[b].distance[k] = static_cast<std::int16_t>(-32000 + static_cast<int>(random() % 64001));
        blocks[b].weight[k] = static_cast<std::uint16_t>(random() % 6400);
      }
      const float z = 0.9F + 0.06F * static_cast<float>(b);
      origins[b] = {kUnitsPer_m * (z * 110.0F * uniform(random) - 10.0F), kUnitsPer_m * (z * 60.0F * uniform(random)),
                    kUnitsPer_m * z};
    }
  }
  LookSource source(int x0, int y0, int columns, int rows) const {
    return {depth_m.data(), owner.data(), kColumns, kRows, kColumns, x0, y0, columns, rows, 0, 2, kUnit_m};
  }
  static BlockRays rays() {
    constexpr float kAlong[3][3] = {
        {4.1F, -0.1F, 1.0F}, {0.2F, 4.0F, 0.5F}, {0.01F, -0.02F, 0.05F}};  // x, y, z of each
    BlockRays rays{};
    for (int c = 0; c < 3; ++c) {
      for (int k = 0; k < 64; ++k) {
        rays.in_slice[c][k] =
            kUnitsPer_m * (kAlong[c][0] * static_cast<float>(k % 8) + kAlong[c][1] * static_cast<float>(k / 8));
      }
      rays.next_slice[c] = kUnitsPer_m * kAlong[c][2];
    }
    rays.columns = kColumns;
    rays.rows = kRows;
    return rays;
  }
};

struct Look {
  std::vector<LookPixel> pixels;
  std::vector<std::uint16_t> farthest;
};
Look make_look(const MappingKernels& kernels, const LookSource& source) {
  Look look{std::vector<LookPixel>(static_cast<std::size_t>(source.columns * source.rows)),
            std::vector<std::uint16_t>(static_cast<std::size_t>(look_tiles(source.columns) * look_tiles(source.rows)))};
  std::vector<std::uint16_t> scratch(static_cast<std::size_t>(kLookScratch * (source.columns + 2 * kClearRadius)));
  kernels.make_look(&source, look.pixels.data(), look.farthest.data(), scratch.data());
  return look;
}

std::vector<unsigned> integrate_all(const MappingKernels& kernels, Case& c, int channels) {
  std::vector<LookPixel> look = make_look(kernels, c.source(0, 0, kColumns, kRows)).pixels;
  look.push_back(0);
  IntegratePass pass{};
  pass.rays = Case::rays();
  pass.look = look.data();
  pass.look_unit = kUnit_m * kUnitsPer_m;
  pass.color = channels == 0 ? nullptr : c.color.data();
  pass.color_last = c.color.data() + channels * kColumns * kRows - 4;
  pass.color_stride = channels * kColumns;
  pass.channels = channels;
  pass.margin = 4000.0F;
  pass.quadratic = 1e-15F;
  pass.floor = 9e5F;
  pass.behind_per_unit = 1.0F / 24000.0F;
  pass.max_weight_units = 6400.0F;
  std::vector<unsigned> outcomes;
  for (std::size_t b = 0; b < c.blocks.size(); ++b) {
    VoxelBlock& block = c.blocks[b];
    const BlockPlace place{{c.origins[b][0], c.origins[b][1], c.origins[b][2]}, 7.3F * static_cast<float>(b)};
    outcomes.push_back(
        kernels.integrate_block(&pass, &place, block.distance.data(), block.weight.data(), block.color.data()));
  }
  return outcomes;
}

class MappingKernelsOf : public testing::TestWithParam<int> {};

TEST_P(MappingKernelsOf, TakeTheNearestDepthAroundAndSayWhoseItIs) {
  const Case c;
  const auto look = make_look(mapping_kernels(GetParam()), c.source(20, 3, 50, 40)).pixels;
  for (int y = 3; y < 43; ++y) {
    for (int x = 20; x < 70; ++x) {
      float nearest = 1e9F;
      bool others = true;
      for (int v = std::max(y - kClearRadius, 0); v <= std::min(y + kClearRadius, kRows - 1); ++v) {
        for (int u = std::max(x - kClearRadius, 0); u <= std::min(x + kClearRadius, kColumns - 1); ++u) {
          const auto k = static_cast<std::size_t>(v * kColumns + u);
          if (c.depth_m[k] > 0.0F) nearest = std::min(nearest, c.depth_m[k]);
          others = others && c.owner[k] != 2 && !(c.owner[k] == 0 && c.depth_m[k] > 0.0F);
        }
      }
      const auto k = static_cast<std::size_t>(y * kColumns + x);
      const LookPixel pixel = look[static_cast<std::size_t>((y - 3) * 50 + x - 20)];
      ASSERT_NEAR(static_cast<float>(pixel & 0xFFFF) * kUnit_m, c.owner[k] == 2 ? c.depth_m[k] : 0.0F, 0.51F * kUnit_m);
      ASSERT_NEAR(static_cast<float>(pixel >> 16 & 0x7FFF) * 2.0F * kUnit_m, nearest - kUnit_m, 1.51F * kUnit_m);
      ASSERT_EQ(pixel >> 31, others ? 1U : 0U);
    }
  }
}

TEST_P(MappingKernelsOf, TellTheFarthestDepthOfEachTile) {
  const Case c;
  const auto farthest = make_look(mapping_kernels(GetParam()), c.source(20, 3, 50, 40)).farthest;
  for (int row = 0; row < look_tiles(40); ++row) {
    for (int column = 0; column < look_tiles(50); ++column) {
      float most = 0.0F;
      for (int y = 3 + row * kLookTile; y < std::min(3 + (row + 1) * kLookTile, 43); ++y) {
        for (int x = 20 + column * kLookTile; x < std::min(20 + (column + 1) * kLookTile, 70); ++x) {
          most = std::max(most, c.depth_m[static_cast<std::size_t>(y * kColumns + x)]);
        }
      }
      const std::uint16_t units = farthest[static_cast<std::size_t>(row * look_tiles(50) + column)];
      EXPECT_NEAR(static_cast<float>(units) * kUnit_m, most, 0.51F * kUnit_m);
    }
  }
}

TEST_P(MappingKernelsOf, SayTheBlocksOfRaysWhereTheyChange) {
  const Case c;
  const RayBlocks rays{{512.3F, 512.9F, 512.5F}, {-0.8F, -0.4F, 2.0F}, {0.021F, 0.001F, 0.003F}, 0.1F};
  std::vector<float> column(kColumns);
  std::iota(column.begin(), column.end(), 0.0F);
  for (const int count : {0, 1, 7, 16, 17, kColumns}) {
    std::vector<std::uint32_t> expected, keys(static_cast<std::size_t>(count)), scratch(keys.size() + 17);
    for (int k = 0; k < count; ++k) {
      const float at = c.depth_m[static_cast<std::size_t>(k)] + 0.1F, x = static_cast<float>(k);
      const auto part = [&](int i) {
        return static_cast<std::uint32_t>(rays.start[i] + (rays.first[i] + rays.along[i] * x) * at);
      };
      const std::uint32_t key = part(0) | part(1) << kKeyBits | part(2) << 2 * kKeyBits;
      if (expected.empty() || expected.back() != key) expected.push_back(key);
    }
    const int different = mapping_kernels(GetParam())
                              .find_keys(&rays, c.depth_m.data(), column.data(), count, keys.data(), scratch.data());
    keys.resize(static_cast<std::size_t>(different));
    EXPECT_EQ(keys, expected) << count;
  }
}

TEST_P(MappingKernelsOf, GiveTheSameBitsAsTheNarrowest) {
  for (const int channels : {0, 1, 3}) {
    Case narrow, wide;
    EXPECT_EQ(integrate_all(mapping_kernels(0), narrow, channels),
              integrate_all(mapping_kernels(GetParam()), wide, channels));
    int touched = 0;
    const Case untouched;
    for (std::size_t b = 0; b < narrow.blocks.size(); ++b) {
      EXPECT_EQ(narrow.blocks[b].distance, wide.blocks[b].distance);
      EXPECT_EQ(narrow.blocks[b].weight, wide.blocks[b].weight);
      EXPECT_EQ(narrow.blocks[b].color, wide.blocks[b].color);
      touched += narrow.blocks[b].distance != untouched.blocks[b].distance;
    }
    EXPECT_GT(touched, 10);
  }
}

TEST_P(MappingKernelsOf, CompareWithTheSameSumAsTheNarrowest) {
  const Case c;
  const ComparePass pass{Case::rays(), c.depth_m.data(), kUnitsPer_m};
  std::int64_t voxels = 0;
  for (std::size_t b = 0; b < c.blocks.size(); ++b) {
    const VoxelBlock& block = c.blocks[b];
    const auto compare = [&](int isa) {
      return mapping_kernels(isa).compare_block(&pass, c.origins[b].data(), block.distance.data(), block.weight.data());
    };
    EXPECT_EQ(compare(0).voxels, compare(GetParam()).voxels);
    EXPECT_EQ(compare(0).difference_units, compare(GetParam()).difference_units);
    voxels += compare(0).voxels;
  }
  EXPECT_GT(voxels, 500);
}

INSTANTIATE_TEST_SUITE_P(Isa, MappingKernelsOf, testing::Range(0, widest_isa() + 1));

}  // namespace
}  // namespace povslam
