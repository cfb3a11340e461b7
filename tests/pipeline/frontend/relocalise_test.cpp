#include "pipeline/frontend/relocalise.hpp"

#include <gtest/gtest.h>

#include "pipeline/frontend/keyframer.hpp"
#include "tests/pipeline/frontend/simulated_view.hpp"

namespace povslam {
namespace {

// One keyframe of a room, and what is seen later.
struct Place {
  explicit Place(std::uint64_t seed, double time_s)
      : view(small_drive(seed)),
        camera(view.calibration().camera),
        options(small_frontend()),
        builder(camera, options),
        frame(camera, options),
        map(options.orb.num_features, options.map, builder.level_scales()),
        keyframer(camera, options),
        relocaliser(camera, options),
        T_world_camera(view.T_world_camera(time_s)) {
    see(view.look(T_world_camera, time_s));
    frame.T_camera_world = T_world_camera.inverse();
    keyframe = keyframer.insert(map, builder, frame, Matrix6d::Zero(), -1);
  }
  void see(const RgbdFrame& image) {
    builder.build(image, 1.0, frame);
    ++frame.index;
  }

  SimulatedView view;
  PinholeCamera camera;
  FrontendOptions options;
  FrameBuilder builder;
  Frame frame;
  Map map;
  Keyframer keyframer;
  Relocaliser relocaliser;
  Rigid3 T_world_camera;
  std::int32_t keyframe = kNone;
};

constexpr double kTwentyDegrees = 20.0 * 3.14159265 / 180.0;

}  // namespace

// Against one keyframe only; tracking the map around the answer then makes it sharp.
TEST(Relocaliser, FindsTheCameraAMetreAndTwentyDegreesAway) {
  int found = 0, tried = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    for (const double time_s : {2.0, 14.0}) {
      Place place(seed, time_s);
      for (const Eigen::Vector4d& step :
           {Eigen::Vector4d(0.0, 0.0, -1.0, 1.0), Eigen::Vector4d(0.0, 0.0, -1.0, -1.0),
            Eigen::Vector4d(0.3, 0.0, -0.95, -1.0), Eigen::Vector4d(-0.3, 0.0, -0.95, 1.0)}) {
        const Rigid3 T_keyframe_camera{so3_exp({0.0, step.w() * kTwentyDegrees, 0.0}), step.head<3>()};
        const Rigid3 truth = place.T_world_camera * T_keyframe_camera;
        place.see(place.view.look(truth, 40.0));
        const auto answer = place.relocaliser.against(place.map, place.keyframe, place.frame);
        ++tried;
        if (!answer) continue;
        ++found;
        const Vector6d error = local(truth, answer->T_camera_world.inverse());
        EXPECT_LT(error.head<3>().norm(), 0.05) << seed << ", " << time_s << ": " << answer->num_inliers;
        EXPECT_LT(error.tail<3>().norm(), 0.02) << seed << ", " << time_s << ": " << answer->num_inliers;
      }
    }
  }
  EXPECT_GE(found, 0.8 * tried) << "of " << tried;
}

TEST(Relocaliser, FindsNothingInOtherRooms) {
  int images = 0;
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    Place place(seed, 2.0);
    SimulatedView other(small_drive(seed + 20));
    for (double time_s = 0.0; time_s < 50.0; time_s += 2.0) {
      place.see(other.drive(time_s));
      const auto answer = place.relocaliser.against(place.map, place.keyframe, place.frame);
      EXPECT_FALSE(answer) << "seed " << seed << ", " << time_s << " s: " << answer->num_inliers;
      ++images;
    }
  }
  EXPECT_EQ(images, 100);
}

TEST(Relocaliser, FindsNothingInTheDark) {
  Place place(1, 2.0);
  place.see(place.view.black(3.0));
  EXPECT_FALSE(place.relocaliser.against(place.map, place.keyframe, place.frame));
}

TEST(Relocaliser, AnswersTheSameForTheSameFrame) {
  Place place(1, 2.0), again(1, 2.0);
  const Rigid3 from = place.T_world_camera * Rigid3{so3_exp({0.0, 0.2, 0.0}), {0.2, 0.0, 0.1}};
  place.see(place.view.look(from, 4.0));
  again.see(again.view.look(from, 4.0));
  const auto one = place.relocaliser.against(place.map, place.keyframe, place.frame);
  const auto two = again.relocaliser.against(again.map, again.keyframe, again.frame);
  ASSERT_TRUE(one && two);
  EXPECT_EQ(one->T_camera_world.translation, two->T_camera_world.translation);
  EXPECT_EQ(one->T_camera_world.rotation.coeffs(), two->T_camera_world.rotation.coeffs());
}

}  // namespace povslam
