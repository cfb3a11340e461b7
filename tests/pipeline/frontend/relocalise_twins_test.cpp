// Racks that look the same: which of them a lost camera stands before, the map must be able to rule out.
#include <gtest/gtest.h>

#include "tests/support/made_places.hpp"

namespace povslam {
namespace {

using Verdict = Relocaliser::Verdict;

const Eigen::Vector3d kHere(0.0, 0.0, 0.0), kThere(20.0, 0.0, 0.0);
const Rigid3 kBeforeIt = made::looking_along_y({0.1, 0.1, 0.05});
constexpr std::size_t kPoints = 400;
constexpr std::size_t kAlike = 80;  // of the points, where racks look alike from wherever they are seen

// A rack; and how its twin looks from where the map saw it: alike in part.
struct Rack {
  std::vector<Eigen::Vector3d> points = made::cloud(kPoints, 1);
  std::vector<Descriptor> looks = made::looks(kPoints, 2);
  std::vector<Descriptor> otherwise = made::looks(kPoints, 3);

  Rack() { std::copy_n(looks.begin(), kAlike, otherwise.begin()); }
};

struct Outcome {
  bool believed = false;
  Relocaliser::Answer last;
};

// A lost camera stands still and looks for a second.
Outcome search(made::Places& made, const Frame& frame) {
  constexpr int kFrames = 30;
  Outcome outcome;
  Agreement agreement;
  for (int i = 0; i < kFrames && !outcome.believed; ++i) {
    outcome.last = made.ask(frame);
    outcome.believed = agreement.add(outcome.last, i * kNsPerSecond / kFrames);
  }
  return outcome;
}

}  // namespace

TEST(Twins, APlaceWithoutOneIsBelieved) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  const made::View view = made.look(rack.points, rack.looks, kBeforeIt);
  const Outcome outcome = search(made, view.frame);
  EXPECT_TRUE(outcome.believed);
  EXPECT_TRUE(same_pose(outcome.last.fit.T_camera_world, view.frame.T_camera_world));
}

// A box was carried while the map was made: it holds the box where it stood, too. There it alone explains the image,
// here all around it does as well.
TEST(Twins, WhereOneThingStoodBeforeIsNone) {
  constexpr std::size_t kBox = 160;  // of the points: more than a rival needs
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  std::vector<Descriptor> before = rack.otherwise;
  std::copy_n(rack.looks.begin(), kBox, before.begin());
  made.add_place(made::moved(rack.points, kThere), before, kThere);
  const made::View view = made.look(rack.points, rack.looks, kBeforeIt);
  const auto own = [&made](std::int64_t there, std::int64_t here) {
    for (std::int32_t slot = 0; slot < made.map.landmark_slots(); ++slot) {
      if (!made.map.landmark(slot).alive) continue;
      const bool far = made.map.landmark(slot).p_world.x() > 10.0;
      made.map.landmark(slot).owner = far ? there : slot % 2 == 0 ? here : 0;
    }
  };
  own(0, 0);  // of structure: walls are not carried
  EXPECT_EQ(search(made, view.frame).last.verdict, Verdict::ambiguous);
  own(5, 7);
  const Outcome outcome = search(made, view.frame);
  EXPECT_TRUE(outcome.believed);
  EXPECT_TRUE(same_pose(outcome.last.fit.T_camera_world, view.frame.T_camera_world));
}

TEST(Twins, IdenticalOnesLeaveTheCameraLost) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  made.add_place(made::moved(rack.points, kThere), rack.looks, kThere);
  const Outcome outcome = search(made, made.look(rack.points, rack.looks, kBeforeIt).frame);
  EXPECT_FALSE(outcome.believed);
  EXPECT_EQ(outcome.last.verdict, Verdict::ambiguous);
}

// The camera stands before the twin, where the map never saw it from: only the rack here explains the image.
TEST(Twins, OneNeverSeenFromThereIsNotTakenForTheOther) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  const auto twin = made::moved(rack.points, kThere);
  made.add_place(std::span(twin).first(kAlike), std::span(rack.looks).first(kAlike), kThere);
  const Rigid3 before_twin{kBeforeIt.rotation, kBeforeIt.translation + kThere};
  const Outcome outcome = search(made, made.look(twin, rack.looks, before_twin).frame);
  EXPECT_FALSE(outcome.believed);
  EXPECT_EQ(outcome.last.verdict, Verdict::ambiguous);
  ASSERT_FALSE(same_pose(outcome.last.fit.T_camera_world, before_twin.inverse())) << "nothing to be deceived by";
}

TEST(Twins, AViewThatTheOtherIsKnownNotToShowIsBelieved) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  made.add_place(made::moved(rack.points, kThere), rack.otherwise, kThere);
  const made::View view = made.look(rack.points, rack.looks, kBeforeIt);
  const Outcome outcome = search(made, view.frame);
  EXPECT_TRUE(outcome.believed);
  EXPECT_TRUE(same_pose(outcome.last.fit.T_camera_world, view.frame.T_camera_world));
}

TEST(Twins, AreAskedForBeforeAnAnswerCounts) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);  // three keyframes, two are looked up a frame
  const Frame frame = made.look(rack.points, rack.looks, kBeforeIt).frame;
  EXPECT_FALSE(made.ask(frame).twins_known);
  EXPECT_TRUE(made.ask(frame).twins_known);
}

TEST(Twins, OneMappedLaterIsDoubtedToo) {
  const Rack rack;
  made::Places made;
  made.add_place(rack.points, rack.looks, kHere);
  const Frame frame = made.look(rack.points, rack.looks, kBeforeIt).frame;
  ASSERT_TRUE(search(made, frame).believed);
  const auto twin = made::moved(rack.points, kThere);
  made.add_place(std::span(twin).first(kAlike), std::span(rack.looks).first(kAlike), kThere);
  EXPECT_FALSE(search(made, frame).believed);
}

}  // namespace povslam
