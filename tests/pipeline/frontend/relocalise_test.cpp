#include "pipeline/frontend/relocalise.hpp"

#include <gtest/gtest.h>

#include "pipeline/frontend/keyframer.hpp"
#include "pipeline/frontend/track.hpp"
#include "tests/pipeline/frontend/made_frame.hpp"
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

using Verdict = Relocaliser::Verdict;

std::vector<std::uint32_t> words_of(std::span<const Descriptor> looks) {
  std::vector<std::uint32_t> words(looks.size());
  Vocabulary::shipped().words(looks, words);
  return words;
}

void learn_words(const Map& map, PlaceIndex& index) {
  for (std::int32_t slot = 0; slot < map.keyframe_slots(); ++slot) {
    if (map.keyframe(slot).alive) index.add(slot, words_of(map.keyframe(slot).descriptor));
  }
}

// A simulated room, tracked for a while.
struct Toured {
  explicit Toured(const std::string& scene, std::uint64_t seed, double until_s)
      : view(options_of(scene, seed)),
        calibration(view.calibration()),
        options(small_frontend()),
        tracker(calibration, options, view.T_world_camera(0.0)),
        builder(calibration.camera, options),
        frame(calibration.camera, options),
        index(Vocabulary::shipped(), options.map.max_keyframes, options.orb.num_features),
        relocaliser(calibration.camera, options) {
    for (double t = 0.0; t < until_s; t += view.period_s()) tracker.track(view.drive(t));
    learn_words(tracker.map(), index);
  }
  static synthetic::SyntheticOptions options_of(const std::string& scene, std::uint64_t seed) {
    synthetic::SyntheticOptions made = small_drive(seed);
    made.scene = scene;
    return made;
  }
  const Frame& see(const RgbdFrame& image) {
    builder.build(image, 1.0, frame);
    return frame;
  }
  SimulatedView view;
  SensorCalibration calibration;
  FrontendOptions options;
  Tracker tracker;
  FrameBuilder builder;
  Frame frame;
  PlaceIndex index;
  Relocaliser relocaliser;
};

Rigid3 beside(std::mt19937& random) {
  std::uniform_real_distribution<double> step(-0.3, 0.3), turn(-0.25, 0.25);
  return {so3_exp({0.0, turn(random), 0.0}), {step(random), 0.3 * step(random), step(random)}};
}

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

TEST(RelocaliserSearch, FindsViewsBesideTheWay) {
  for (const char* scene : {"static", "aisle"}) {
    Toured tour(scene, 3, 14.0);
    std::mt19937 random(1);
    int asked = 0, found = 0, first = 0, five = 0;
    for (double t = 0.5; t < 13.0; t += 0.8, ++asked) {
      const Rigid3 truth = tour.view.T_world_camera(t) * beside(random);
      const Frame& frame = tour.see(tour.view.look(truth, t));
      const auto answer = tour.relocaliser.search(tour.tracker.map(), tour.index, frame);
      tour.index.query(words_of({frame.features.descriptor.data(), static_cast<std::size_t>(frame.size())}));
      for (int rank = 1; rank <= 5; ++rank) {
        const auto likely = tour.index.next();
        ASSERT_TRUE(likely);
        const Rigid3 between = tour.tracker.map().keyframe(likely->keyframe).T_world_camera.inverse() * truth;
        if (between.translation.norm() > 1.2 || rotation_angle_rad(between) > 0.5) continue;
        first += rank == 1 ? 1 : 0;
        ++five;
        break;
      }
      if (answer.verdict != Verdict::found) continue;
      ++found;
      const Vector6d error = local(truth, answer.fit.T_camera_world.inverse());
      EXPECT_LT(error.head<3>().norm(), 0.1) << scene << " at " << t << " s: " << answer.fit.num_inliers;
      EXPECT_LT(error.tail<3>().norm(), 0.03) << scene << " at " << t << " s: " << answer.fit.num_inliers;
    }
    EXPECT_GE(found, 0.85 * asked) << scene;
    EXPECT_GE(first, 0.8 * asked) << scene;
    EXPECT_GE(five, 0.95 * asked) << scene;
  }
}

TEST(RelocaliserSearch, FindsNothingInOtherRooms) {
  Toured tour("static", 3, 14.0);
  for (const std::uint64_t seed : {31, 32, 33}) {
    SimulatedView other(small_drive(seed));
    std::mt19937 random(1);
    for (double t = 0.0; t < 50.0; t += 1.0) {
      const RgbdFrame& image = other.look(other.T_world_camera(t) * beside(random), t);
      const auto answer = tour.relocaliser.search(tour.tracker.map(), tour.index, tour.see(image));
      EXPECT_NE(answer.verdict, Verdict::found) << seed << " at " << t << " s: " << answer.fit.num_inliers;
    }
  }
}

namespace {
Relocaliser::Answer found_at(double x) {
  Relocaliser::Answer answer;
  answer.verdict = Verdict::found;
  answer.twins_known = true;
  answer.fit.T_camera_world = made::looking_along_y({x, 0.0, 0.0}).inverse();
  return answer;
}
constexpr TimeNs kFrameNs = kNsPerSecond / 30;
}  // namespace

TEST(Agreement, BelievesTheThirdAnswerThatAgrees) {
  Agreement agreement;
  EXPECT_FALSE(agreement.add(found_at(1.00), 1 * kFrameNs));
  EXPECT_FALSE(agreement.add(found_at(1.02), 2 * kFrameNs));
  EXPECT_TRUE(agreement.add(found_at(1.04), 3 * kFrameNs));
}

TEST(Agreement, WaitsUntilTheMapWasAskedForTwins) {
  Agreement agreement;
  Relocaliser::Answer unasked = found_at(1.0);
  unasked.twins_known = false;
  for (int i = 0; i < 6; ++i) EXPECT_FALSE(agreement.add(unasked, i * kFrameNs));
  EXPECT_TRUE(agreement.add(found_at(1.0), 6 * kFrameNs));
}

TEST(Agreement, ForgivesAFrameWithoutAnAnswerButNotADoubt) {
  Agreement agreement;
  Relocaliser::Answer nothing, doubt = found_at(1.0);
  doubt.verdict = Verdict::ambiguous;
  agreement.add(found_at(1.0), 1 * kFrameNs);
  agreement.add(found_at(1.0), 2 * kFrameNs);
  agreement.add(nothing, 3 * kFrameNs);
  EXPECT_TRUE(agreement.add(found_at(1.0), 4 * kFrameNs));
  agreement.forget();
  agreement.add(found_at(1.0), 5 * kFrameNs);
  agreement.add(found_at(1.0), 6 * kFrameNs);
  agreement.add(doubt, 7 * kFrameNs);
  EXPECT_FALSE(agreement.add(found_at(1.0), 8 * kFrameNs));
}

TEST(Agreement, BeginsAnewWhenTheAnswersJump) {
  Agreement agreement;
  for (int i = 0; i < 20; ++i) EXPECT_FALSE(agreement.add(found_at(i % 2), i * kFrameNs));
}

}  // namespace povslam
