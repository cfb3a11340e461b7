// Places made by hand, some of which deceive; alone and in a search.
#include <gtest/gtest.h>

#include <limits>

#include "tests/support/alloc_counter.hpp"
#include "tests/support/made_places.hpp"

namespace povslam {
namespace {

using Verdict = Relocaliser::Verdict;

const Eigen::Vector3d kHere(0.0, 0.0, 0.0), kThere(20.0, 0.0, 0.0);
const Rigid3 kBetween = made::looking_along_y({0.1, 0.1, 0.05});
constexpr std::size_t kPoints = 400;

}  // namespace

TEST(VerifyPlace, FindsAMadePlaceAndSaysWhichFeaturesShowWhat) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  const made::View view = made.look(points, looks, kBetween);
  const auto answer = made.ask(view.frame);
  ASSERT_EQ(answer.verdict, Verdict::found);
  EXPECT_TRUE(same_pose(answer.fit.T_camera_world, view.frame.T_camera_world));
  PlaceVerifier verifier(made.camera, made.options);
  const auto fit = verifier.verify(made.map, PlaceAround(made.map, 0).keyframes(), FeatureView(view.frame));
  ASSERT_TRUE(fit);
  EXPECT_EQ(verifier.pairs().size(), static_cast<std::size_t>(fit->num_inliers));
  for (const auto& pair : verifier.pairs()) {
    const auto point = static_cast<std::size_t>(view.shown[static_cast<std::size_t>(pair.feature)]);
    EXPECT_LT((made.map.landmark(pair.landmark).p_world - points[point]).norm(), 1e-6);
  }
}

// A box that was carried looks as if the camera had been.
TEST(VerifyPlace, DoesNotBelieveOneThingAlone) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  const made::View view = made.look(points, looks, kBetween);
  const auto own = [&made](auto owner_of) {
    for (std::int32_t slot = 0; slot < made.map.landmark_slots(); ++slot) {
      if (made.map.landmark(slot).alive) made.map.landmark(slot).owner = owner_of(slot);
    }
  };
  const auto verdict = [&] { return made.ask(view.frame).verdict; };
  own([](std::int32_t) { return std::int64_t{7}; });
  EXPECT_NE(verdict(), Verdict::found);
  own([](std::int32_t slot) { return slot % 20 == 0 ? std::int64_t{9} : std::int64_t{7}; });
  EXPECT_NE(verdict(), Verdict::found);  // a few that may have been told wrongly
  own([](std::int32_t slot) { return slot % 3 == 0 ? std::int64_t{9} : std::int64_t{7}; });
  EXPECT_EQ(verdict(), Verdict::found);  // two things
  own([](std::int32_t slot) { return slot % 3 == 0 ? std::int64_t{0} : std::int64_t{7}; });
  EXPECT_EQ(verdict(), Verdict::found);  // a thing and a wall
  own([](std::int32_t slot) { return slot % 3 == 0 ? std::int64_t{7} : std::int64_t{-1}; });
  EXPECT_EQ(verdict(), Verdict::found);  // hardly anything is known
}

TEST(VerifyPlace, SeesAKeyframeAsItSeesAFrame) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  made.add_place(made::moved(points, {0.0, 0.0, 0.6}), looks, {0.0, 0.0, 0.6});  // come again, with drift
  PlaceVerifier verifier(made.camera, made.options);
  const auto fit = verifier.verify(made.map, PlaceAround(made.map, 0).keyframes(), FeatureView(made.map.keyframe(4)));
  ASSERT_TRUE(fit && believable(*fit));
  EXPECT_TRUE(same_pose(fit->T_camera_world, made.map.keyframe(1).T_world_camera.inverse()));
}

TEST(VerifyPlace, StaysInDoubtBetweenTwoPlacesThatLookTheSame) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  made.add_place(made::moved(points, kThere), looks, kThere);
  EXPECT_EQ(made.ask(made.look(points, looks, kBetween).frame).verdict, Verdict::ambiguous);
}

TEST(VerifyPlace, StaysInDoubtBetweenTwoShelvesWithTheSameThings) {
  constexpr std::size_t kFew = 250;  // twice that fits into a keyframe
  made::Places made;
  const auto points = made::cloud(kFew, 1);
  const auto looks = made::looks(kFew, 2);
  auto both = made::moved(points, {0.0, 0.0, 0.5});
  both.insert(both.end(), points.begin(), points.end());
  auto both_looks = looks;
  both_looks.insert(both_looks.end(), looks.begin(), looks.end());
  made.add_place(both, both_looks, kHere);
  EXPECT_NE(made.ask(made.look(points, looks, kBetween).frame).verdict, Verdict::found);
}

TEST(VerifyPlace, TellsSimilarPlacesApartByWhatIsTheirOwn) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  auto others = made::looks(kPoints, 3);
  std::copy_n(looks.begin(), kPoints / 4, others.begin());  // a quarter is the same
  made.add_place(points, looks, kHere);
  made.add_place(made::moved(points, kThere), others, kThere);
  const made::View view = made.look(points, looks, kBetween);
  const auto answer = made.ask(view.frame);
  ASSERT_EQ(answer.verdict, Verdict::found);
  EXPECT_TRUE(same_pose(answer.fit.T_camera_world, view.frame.T_camera_world));
}

// The same rack stands elsewhere too, where nobody mapped: half of the view is it, the rest is something else.
TEST(VerifyPlace, MissesWhatShouldBeBesideAKnownThing) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  auto seen = made::looks(kPoints, 3);
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (points[i].x() < -0.2) seen[i] = looks[i];
  }
  EXPECT_NE(made.ask(made.look(points, seen, kBetween).frame).verdict, Verdict::found);
}

// A bare board stands close before half of the lens: nothing there says that this is elsewhere.
TEST(VerifyPlace, MissesNothingWhereTheViewIsBlank) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  std::vector<Eigen::Vector3d> seen;
  std::vector<Descriptor> seen_looks;
  for (std::size_t i = 0; i < kPoints; ++i) {
    if (points[i].x() > -0.25 * points[i].y()) continue;
    seen.push_back(points[i]);
    seen_looks.push_back(looks[i]);
  }
  const made::View view = made.look(seen, seen_looks, kBetween);
  const auto answer = made.ask(view.frame);
  ASSERT_EQ(answer.verdict, Verdict::found);
  EXPECT_TRUE(same_pose(answer.fit.T_camera_world, view.frame.T_camera_world));
}

TEST(VerifyPlace, IsContradictedBySurfacesThatAreNotThere) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  made::View view = made.look(points, looks, kBetween);
  PlaceVerifier verifier(made.camera, made.options);
  const auto place = PlaceAround(made.map, 0);
  const auto before = verifier.verify(made.map, place.keyframes(), FeatureView(view.frame));
  ASSERT_TRUE(before);
  for (std::size_t f = 0; f < static_cast<std::size_t>(view.frame.size()); f += 3) view.frame.inverse_depth[f] *= 0.5F;
  const auto after = verifier.verify(made.map, place.keyframes(), FeatureView(view.frame));
  ASSERT_TRUE(after);
  EXPECT_EQ(before->num_contradicted, 0);
  EXPECT_GT(after->num_contradicted, 5);
  EXPECT_LT(after->num_inliers, 0.75 * before->num_inliers);
}

// Eight places hold the same things in other order: they look more alike than the one where some of them stand right.
TEST(VerifyPlace, ComesToThePlaceWhoseLooksAreNotTheLikeliest) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  for (unsigned p = 1; p <= 8; ++p) {
    const Eigen::Vector3d place(20.0 * p, 0.0, 0.0);
    made.add_place(made::moved(made::cloud(kPoints, 10 + p), place), looks, place);
  }
  made.add_place(std::span(points).first(kPoints / 2), std::span(looks).first(kPoints / 2), kHere);
  const made::View view = made.look(points, looks, kBetween);
  EXPECT_EQ(made.ask(view.frame).verdict, Verdict::unknown);
  for (int frame = 0; frame < 3; ++frame) {  // found with the next, and not lost again
    const auto answer = made.ask(view.frame);
    ASSERT_EQ(answer.verdict, Verdict::found) << frame;
    EXPECT_TRUE(same_pose(answer.fit.T_camera_world, view.frame.T_camera_world));
    EXPECT_LE(answer.places_tried, 2 * Relocaliser::kMaxPlaces);
  }
}

TEST(VerifyPlace, NeverTakesNoiseForAPlace) {
  made::Places made;
  for (unsigned p = 0; p < 8; ++p) {
    const Eigen::Vector3d place(20.0 * p, 0.0, 0.0);
    made.add_place(made::moved(made::cloud(kPoints, p), place), made::looks(kPoints, 100 + p), place);
  }
  for (unsigned q = 0; q < 200; ++q) {
    const Frame frame = made::random_frame(made.camera, made.options, 400, 1000 + q);
    EXPECT_EQ(made.ask(frame).verdict, Verdict::unknown) << q;
  }
}

TEST(VerifyPlace, BearsViewsThatDetermineNothing) {
  made::Places made;
  const auto looks = made::looks(kPoints, 2);
  EXPECT_EQ(made.ask(made::random_frame(made.camera, made.options, 300, 1)).verdict, Verdict::unknown) << "no map";
  std::vector<Eigen::Vector3d> line, spot(kPoints, {0.1, 3.0, 0.1});
  for (std::size_t i = 0; i < kPoints; ++i) line.emplace_back(-1.0 + 2.0 * static_cast<double>(i) / kPoints, 3.0, 0.2);
  made.add_place(line, looks, kHere);
  EXPECT_NE(made.ask(made.look(line, looks, kBetween).frame).verdict, Verdict::found) << "all on one line";
  made.add_place(made::moved(spot, kThere), made::looks(kPoints, 3), kThere);
  const auto at_spot = made.look(made::moved(spot, kThere), made::looks(kPoints, 3), made::looking_along_y(kThere));
  EXPECT_NE(made.ask(at_spot.frame).verdict, Verdict::found) << "all at one place";
  EXPECT_EQ(made.ask(Frame(made.camera, made.options)).verdict, Verdict::unknown) << "no features";
}

TEST(VerifyPlace, BearsNumbersThatAreNone) {
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  const float bad[] = {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity(), -1.0F, 0.0F};
  for (const float value : bad) {
    made::View view = made.look(points, looks, kBetween);
    const std::size_t n = static_cast<std::size_t>(view.frame.size());
    std::fill_n(view.frame.inverse_depth.begin(), n, value);
    EXPECT_NE(made.ask(view.frame).verdict, Verdict::found) << value << " for depths";
    std::fill_n(view.frame.x.begin(), n, value);
    std::fill_n(view.frame.sigma_inverse_depth.begin(), n, value);
    EXPECT_NE(made.ask(view.frame).verdict, Verdict::found) << value << " for all";
  }
}

TEST(VerifyPlace, AllocatesNothingOnceMade) {
  if (!counting_works()) GTEST_SKIP();
  made::Places made;
  const auto points = made::cloud(kPoints, 1);
  const auto looks = made::looks(kPoints, 2);
  made.add_place(points, looks, kHere);
  const made::View view = made.look(points, looks, kBetween);
  start_counting();
  const auto answer = made.ask(view.frame);
  EXPECT_EQ(stop_counting().allocations, 0U);
  EXPECT_EQ(answer.verdict, Verdict::found);
}

}  // namespace povslam
