#include "pipeline/mapping/kernels/kernels.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <random>

#include "pipeline/mapping/kernels/dispatch.hpp"
#include "pipeline/mapping/volume.hpp"

namespace povslam {
namespace {

constexpr int kColumns = 97, kRows = 61;

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
      origins[b] = {z * 110.0F * uniform(random) - 10.0F, z * 60.0F * uniform(random), z};
    }
  }
  LookSource source(int x0, int y0, int columns, int rows) const {
    return {depth_m.data(), owner.data(), kColumns, kRows, kColumns, x0, y0, columns, rows, 0, 2};
  }
  static BlockRays rays() {
    return {{{4.1F, 0.2F, 0.01F}, {-0.1F, 4.0F, -0.02F}, {1.0F, 0.5F, 0.05F}}, kColumns, kRows};
  }
};

struct Looked {
  std::vector<float> surface_m = std::vector<float>(kColumns * kRows), clear_m = surface_m;
};
Looked make_look(const MappingKernels& kernels, const Case& c) {
  Looked looked;
  std::vector<float> scratch(12 * (kColumns + 2 * kClearRadius));
  const LookSource source = c.source(0, 0, kColumns, kRows);
  kernels.make_look(&source, looked.surface_m.data(), looked.clear_m.data(), scratch.data());
  return looked;
}

std::vector<unsigned> integrate_all(const MappingKernels& kernels, Case& c, int channels) {
  const Looked looked = make_look(kernels, c);
  IntegratePass pass{};
  pass.rays = Case::rays();
  pass.surface_m = looked.surface_m.data();
  pass.clear_m = looked.clear_m.data();
  pass.color = channels == 0 ? nullptr : c.color.data();
  pass.color_stride = channels * kColumns;
  pass.channels = channels;
  pass.truncation_m = 0.2F;
  pass.units_per_m = kDistanceUnits / 0.2F;
  pass.margin_m = 0.025F;
  pass.behind_per_unit = 0.2F / 0.15F / kDistanceUnits;
  pass.color_units = 16000.0F;
  pass.good_sigma2 = 1e-4F;
  pass.quadratic2 = 6.25e-6F;
  pass.floor2 = 9e-6F;
  pass.units_per_look = kWeightUnits;
  pass.max_weight_units = 6400.0F;
  std::vector<unsigned> outcomes;
  for (std::size_t b = 0; b < c.blocks.size(); ++b) {
    VoxelBlock& block = c.blocks[b];
    outcomes.push_back(kernels.integrate_block(&pass, c.origins[b].data(), block.distance.data(), block.weight.data(),
                                               block.color.data()));
  }
  return outcomes;
}

class MappingKernelsOf : public testing::TestWithParam<int> {};

TEST_P(MappingKernelsOf, TakeTheNearestDepthAroundAndSayWhoseItIs) {
  const Case c;
  const LookSource part = c.source(20, 3, 50, 40);
  std::vector<float> surface(50 * 40), clear(50 * 40), scratch(12 * (50 + 2 * kClearRadius));
  mapping_kernels(GetParam()).make_look(&part, surface.data(), clear.data(), scratch.data());
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
      const auto k = static_cast<std::size_t>(y * kColumns + x), out = static_cast<std::size_t>((y - 3) * 50 + x - 20);
      ASSERT_EQ(surface[out], c.owner[k] == 2 ? c.depth_m[k] : 0.0F);
      ASSERT_EQ(clear[out], others ? -nearest : nearest);
    }
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
  const ComparePass pass{Case::rays(), c.depth_m.data(), 0.2F, kDistanceUnits / 0.2F};
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
