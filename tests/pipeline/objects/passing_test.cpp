// Who walks and what drives by, before the camera.
#include "tests/pipeline/objects/library_story.hpp"

namespace povslam {
namespace {

TEST_F(LibraryStory, WantsNoLandmarksOnWhoWalks) {
  world.things = {{{{2.5, 0.0, 0.85}, {0.3, 0.5, 1.7}, 0.0}, SmallWorld::kPerson}};
  drive(3);
  std::vector<SeenLandmark> landmarks(1);
  landmarks[0] = {77, 3, 159.0F, 150.0F, 0.4F, {}};
  library.claim_landmarks(landmarks, view, step);
  ASSERT_EQ(step.owners.size(), 1U);
  EXPECT_EQ(step.owners[0].landmark, 77);
  EXPECT_EQ(step.owners[0].object, LandmarkOwner::kGone);
}

TEST_F(LibraryStory, TellsNothingOfWhatPassesBy) {
  drive(10);
  for (int i = 0; i < 20; ++i) {  // 0.8 m/s; its class says nothing of that
    world.things = {{{{2.5, -1.6 + 0.16 * i, 0.85}, {0.34, 0.5, 1.7}, 0.0}}};
    look(SmallWorld::looking({0.0, 0.0}, {2.5, 0.0}));
  }
  world.things.clear();
  drive(60);
  finish();
  EXPECT_TRUE(events.empty()) << events.size();
  EXPECT_TRUE(confirmed().empty());
}

TEST_F(LibraryStory, TellsOfWhatWasLeftByOneWhoPassed) {
  drive(20);
  for (int i = 0; i < 10; ++i) {
    world.things = {{{{2.5, -1.6 + 0.16 * i, 0.85}, {0.34, 0.5, 1.7}, 0.0}}};
    look(SmallWorld::looking({0.0, 0.0}, {2.5, 0.0}));
  }
  world.things = {{carton(2.5, 0.0)}};
  drive(60);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::appeared);
  EXPECT_NEAR(events[0].place.position.x(), 2.5, 0.15);
}

}  // namespace
}  // namespace povslam
