#include "drivers/synthetic/renderer.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "drivers/synthetic/random.hpp"
#include "tests/drivers/synthetic/support.hpp"

namespace povslam::synthetic {

namespace {

bool same_bytes(const RgbdFrame& a, const RgbdFrame& b) {
  return std::ranges::equal(a.color.pixels(), b.color.pixels()) &&
         std::ranges::equal(a.depth.pixels(), b.depth.pixels());
}

int grey(const ImageU8& image, int x, int y) {
  return (image.at(x, y, 0) + image.at(x, y, 1) + image.at(x, y, 2)) / 3;
}

}  // namespace

TEST(Renderer, PerfectDepthIsWhereSlabTestsFindTheBoxes) {
  for (const char* name : {"boxsim", "aisle", "twins", "rooms", "hall"}) {
    SyntheticOptions options = small_options(name, 3);
    options.noise = 0.0;
    options.max_depth_m = 30.0;
    options.movers = 2;
    const World world = make_world(options);
    Renderer renderer(world);
    RgbdFrame frame;
    Random random(9);
    int wrong = 0, compared = 0;
    for (double t = 0.3; t < world.lap_end_s(2.0); t += 4.7) {
      renderer.render_at(t, frame);
      const Rigid3 T_world_camera = world.T_world_camera(t);
      for (int i = 0; i < 60; ++i) {
        const int x = random.below(160), y = random.below(120);
        const Eigen::Vector3d ray = T_world_camera.rotation * options.camera.unproject({x, y});
        const double z_m = brute_force_range_m(world.scene(), t, T_world_camera.translation, ray);
        ++compared;
        wrong += std::abs((z_m < 30.0 ? 1000.0 * z_m : 0.0) - frame.depth.at(x, y)) > 1.0;
      }
    }
    EXPECT_LE(wrong, compared / 500) << name;  // rays along an edge may go either way
  }
}

TEST(Renderer, AFrameIsTheSameWhateverWasRenderedBefore) {
  for (const bool blur : {false, true}) {
    SyntheticOptions options = small_options("boxsim", 3);
    options.blur = blur;
    const World world = make_world(options), again = make_world(options);
    Renderer a(world), b(again);
    RgbdFrame first, second;
    a.render_at(3.0, first);
    b.render_at(11.0, second);
    EXPECT_FALSE(same_bytes(first, second));
    b.render_at(3.0, second);
    EXPECT_TRUE(same_bytes(first, second));
  }
}

TEST(Renderer, AnotherNoiseSeedDisturbsTheSameWorldOtherwise) {
  SyntheticOptions options = small_options("static", 3);
  const World world = make_world(options);
  options.noise_seed = 5;
  const World again = make_world(options);
  Renderer a(world), b(again);
  RgbdFrame first, second;
  a.render_at(3.0, first);
  b.render_at(3.0, second);
  EXPECT_FALSE(same_bytes(first, second));
  EXPECT_TRUE(std::ranges::equal(a.raster().inverse_depth().pixels(), b.raster().inverse_depth().pixels()));
}

TEST(Renderer, TrackersAlwaysHaveSomethingToSee) {
  for (const char* name : {"boxsim", "static"}) {
    for (const std::uint64_t seed : {1U, 2U, 3U}) {
      const World world = make_world(small_options(name, seed));
      Renderer renderer(world);
      RgbdFrame frame;
      for (double t = 0.0; t < world.lap_end_s(2.0); t += 0.8) {
        renderer.render_at(t, frame);
        const auto hits = renderer.raster().hit().pixels();
        std::size_t textured = 0;
        for (std::size_t p = 0; p < hits.size(); ++p)
          textured += hits[p] >= Raster::kFirstFace && frame.depth.data()[p] > 0;
        ASSERT_GE(static_cast<double>(textured), 0.15 * static_cast<double>(hits.size()))
            << name << " seed " << seed << " at " << t << " s";
      }
    }
  }
}

// Before one bay and before the next the camera sees the same; what it sees differs where the bays end.
TEST(Renderer, TwinsLookTheSameFromWithinAndDifferAtTheirEnds) {
  SyntheticOptions options = small_options("twins", 2);
  options.noise = 0.0;
  const World world = make_world(options);
  Renderer renderer(world);
  const auto differing = [&](double x, double yaw_rad) {
    const Rigid3 turn{Eigen::Quaterniond(Eigen::AngleAxisd(yaw_rad, Eigen::Vector3d::UnitZ())), {x, -2.375, 0.0}};
    const Rigid3 next{turn.rotation, turn.translation + Eigen::Vector3d(world.scene().twin_pitch_m, 0.0, 0.0)};
    RgbdFrame a, b;
    renderer.render(turn * RobotMotion::T_body_camera(), 0.0, a);
    renderer.render(next * RobotMotion::T_body_camera(), 0.0, b);
    int pixels = 0;
    for (std::size_t p = 0; p < a.depth.size(); ++p) {
      const bool same_color = std::equal(a.color.data() + 3 * p, a.color.data() + 3 * p + 3, b.color.data() + 3 * p);
      pixels += !same_color || a.depth.data()[p] != b.depth.data()[p];
    }
    return pixels;
  };
  for (const double x : {-3.75, -3.5, -1.25, -1.0, 1.0, 1.25})
    EXPECT_LE(differing(x, -0.5 * kPi), 10) << x;  // rounding
  for (const double yaw_rad : {-0.6, -0.4}) EXPECT_GT(differing(-1.25, yaw_rad), 160 * 120 / 50) << yaw_rad;
}

// Colour, depth, pose and texture belong together: a point keeps its brightness from frame to frame.
TEST(Renderer, PointsKeepTheirBrightnessWhenTheCameraMoves) {
  SyntheticOptions options = small_options("static", 2);
  options.camera = SyntheticOptions{}.camera;
  options.noise = 0.0;
  const World world = make_world(options);
  Renderer renderer(world);
  RgbdFrame a, b;
  const double t = 4.0, later = 4.2;
  renderer.render_at(t, a);
  renderer.render_at(later, b);
  const Rigid3 T_b_a = world.T_world_camera(later).inverse() * world.T_world_camera(t);
  double difference = 0.0, unaligned = 0.0;
  int points = 0;
  for (int y = 4; y < 476; y += 3) {
    for (int x = 4; x < 636; x += 3) {
      const double z_m = a.depth.at(x, y) / 1000.0;
      if (z_m <= 0.0) continue;
      const Eigen::Vector3d p_b = T_b_a * (z_m * options.camera.unproject({x, y}));
      const auto pixel = options.camera.project(p_b);
      if (!pixel || !options.camera.contains(*pixel)) continue;
      const int u = static_cast<int>(pixel->x() + 0.5), v = static_cast<int>(pixel->y() + 0.5);
      if (std::abs(b.depth.at(u, v) / 1000.0 - p_b.z()) > 0.03) continue;
      difference += std::abs(grey(a.color, x, y) - grey(b.color, u, v));
      unaligned += std::abs(grey(a.color, x, y) - grey(b.color, x, y));
      ++points;
    }
  }
  ASSERT_GT(points, 3000);
  EXPECT_LT(difference / points, 4.0);
  EXPECT_GT(unaligned, 2.0 * difference);
}

TEST(Renderer, NoiseGrowsWithTheSquareOfDepthAndHolesAppear) {
  SyntheticOptions options = small_options("aisle", 2);
  const World noisy_world = make_world(options);
  options.noise = 0.0;
  const World clean_world = make_world(options);
  Renderer noisy(noisy_world), clean(clean_world);
  RgbdFrame a, b;
  double square = 0.0, grey_square = 0.0;
  int points = 0, holes = 0, pixels = 0;
  for (double t = 0.0; t < 40.0; t += 5.0) {
    noisy.render_at(t, a);
    clean.render_at(t, b);
    for (std::size_t p = 0; p < a.depth.size(); ++p) {
      const double z_m = b.depth.data()[p] / 1000.0;
      if (z_m <= 0.0 || z_m > 7.5) continue;
      ++pixels;
      holes += a.depth.data()[p] == 0;
      if (a.depth.data()[p] == 0 || z_m < 1.5) continue;
      const double error = (a.depth.data()[p] / 1000.0 - z_m) / (z_m * z_m);
      square += error * error;
      ++points;
      EXPECT_LE(a.depth.data()[p], 8500);
    }
    grey_square += std::pow(a.color.at(20, 10, 1) - b.color.at(20, 10, 1), 2);
  }
  EXPECT_NEAR(std::sqrt(square / points), 0.0025, 0.0003);
  EXPECT_GT(holes, pixels / 200);
  EXPECT_LT(holes, pixels / 4);
  EXPECT_GT(grey_square, 0.0);
}

TEST(Renderer, LabelsNameWhatIsInThePicture) {
  const World world = make_world(small_options("boxsim", 1));
  Renderer renderer(world);
  RgbdFrame frame;
  LabelFrame labels;
  renderer.render_at(2.0, frame);
  renderer.label(labels);
  int boxes = 0;
  for (std::size_t p = 0; p < labels.classes.size(); ++p) {
    const auto class_id = static_cast<ClassId>(labels.classes.data()[p]);
    EXPECT_EQ(class_id == ClassId::box, labels.instances.data()[p] > 0);
    if (class_id == ClassId::none) {
      EXPECT_EQ(frame.depth.data()[p], 0);
    }
    boxes += class_id == ClassId::box;
  }
  EXPECT_GT(boxes, 160 * 120 / 8);
}

}  // namespace povslam::synthetic
