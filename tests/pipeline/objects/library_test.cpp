// Small stories of things that stand, go, move and come while a robot drives by.
#include "pipeline/objects/library.hpp"

#include <gtest/gtest.h>

#include <algorithm>

#include "tests/pipeline/objects/library_story.hpp"

namespace povslam {
namespace {

TEST_F(LibraryStory, AThingSeenFromSeveralSidesIsOneObjectWithItsBox) {
  world.things = {{carton(2.5, 0.0)}};
  drive(20);
  finish();
  const auto objects = confirmed();
  ASSERT_EQ(objects.size(), 1U);
  EXPECT_GT(overlap(objects[0]->box_world(), carton(2.5, 0.0)).iou, 0.6);
  EXPECT_GT(objects[0]->belief.expected_consistency(), 0.85);
  EXPECT_TRUE(events.empty()) << "it was there when the robot came";
}

TEST_F(LibraryStory, AThingFiveMetresAwayIsAnObject) {
  world.things = {{{{5.0, 0.0, 0.5}, {0.4, 0.6, 1.0}, 0.0}}};
  for (int i = 0; i < 4; ++i) look(SmallWorld::looking({-0.1, 0.05 * i}, {5.0, 0.0}));
  EXPECT_EQ(confirmed().size(), 1U);
}

TEST_F(LibraryStory, ASliverIsAnObjectOnlyWhenLookedAtWell) {
  world.noise = 0.2;
  world.things = {{{{5.0, 0.0, 0.6}, {0.12, 0.13, 1.2}, 0.0}}};
  for (int i = 0; i < 4; ++i) look(SmallWorld::looking({0.0, 0.05 * i}, {5.0, 0.0}));
  ASSERT_FALSE(library.objects().empty()) << "it was seen";
  EXPECT_TRUE(confirmed().empty());
  for (int i = 0; i < 4; ++i) look(SmallWorld::looking({2.8, 0.05 * i}, {5.0, 0.0}));
  EXPECT_EQ(confirmed().size(), 1U);
}

TEST_F(LibraryStory, AThingIsNoObjectBeforeItWasSeenOften) {
  world.things = {{carton(2.5, 0.0)}};
  drive(2);
  EXPECT_TRUE(confirmed().empty());
  drive(2);
  EXPECT_EQ(confirmed().size(), 1U);
}

TEST_F(LibraryStory, WhatGoesIsRemovedOnceAndItsVoxelsWithIt) {
  world.things = {{carton(2.5, -0.6)}, {carton(2.6, 0.7, 0.0), SmallWorld::kPallet}};
  drive(20);
  world.things.erase(world.things.begin());
  drive(10);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::removed);
  EXPECT_EQ(events[0].class_name, "carton");
  EXPECT_LT((events[0].place.position - Eigen::Vector3d(2.5, -0.6, 0.35)).norm(), 0.2);
  EXPECT_GT(events[0].probability, 0.6);
  ASSERT_TRUE(events[0].evidence.first_absent);
  EXPECT_GT(*events[0].evidence.first_absent, events[0].evidence.last_present);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(confirmed()[0]->class_id(), SmallWorld::kPallet);
}

TEST_F(LibraryStory, WhatIsHiddenOrNotToldApartIsNotGone) {
  world.things = {{carton(3.2, 0.0)}};
  drive(20);
  world.things.push_back({{{1.6, 0.0, 0.75}, {0.3, 2.5, 1.5}, 0.0}, SmallWorld::kPallet});
  drive(10);
  world.things.pop_back();
  drive(10, false);
  finish();
  for (const ObjectEvent& event : events) EXPECT_NE(event.class_name, "carton") << to_string(event.type);
  ASSERT_FALSE(confirmed().empty());
  EXPECT_GT(confirmed()[0]->belief.expected_consistency(), 0.8);
}

TEST_F(LibraryStory, WhatMovesKeepsItsNumber) {
  world.things = {{carton(2.5, -0.7)}};
  drive(20);
  ASSERT_EQ(confirmed().size(), 1U);
  const std::int64_t id = confirmed()[0]->id;
  world.things = {{carton(2.6, 0.8, 1.0)}};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_EQ(events[0].object, id);
  ASSERT_TRUE(events[0].from);
  EXPECT_LT((events[0].from->position - Eigen::Vector3d(2.5, -0.7, 0.35)).norm(), 0.2);
  EXPECT_LT((events[0].place.position - Eigen::Vector3d(2.6, 0.8, 0.35)).norm(), 0.2);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(confirmed()[0]->id, id);
}

TEST_F(LibraryStory, WhatComesToAPlaceThatWasEmptyAppeared) {
  drive(20);
  world.things = {{carton(2.5, 0.0)}};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::appeared);
  ASSERT_TRUE(events[0].evidence.last_absent);
  EXPECT_LT(*events[0].evidence.last_absent, events[0].evidence.first_present);
}

TEST_F(LibraryStory, ThingsSideBySideAreTwo) {
  const Box left{{2.5, 0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0}, right{{2.5, -0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0};
  world.things = {{left}, {right}};  // 8 cm apart
  for (int i = 0; i < 12; ++i) look(SmallWorld::looking({0.2, -1.6 + 0.05 * i}, {2.6, 0.6}));
  ASSERT_EQ(confirmed().size(), 2U);
}

TEST_F(LibraryStory, WhatWasToldApartStaysApartWhenAViewTakesBothForOne) {
  const Box left{{2.5, 0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0}, right{{2.5, -0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0};
  world.things = {{left}, {right}};
  const auto drive_by = [&](int views) {
    for (int i = 0; i < views; ++i) look(SmallWorld::looking({0.2, -1.6 + 0.05 * i}, {2.6, 0.6}));
  };
  drive_by(12);
  ASSERT_EQ(confirmed().size(), 2U);
  world.things = {{{{2.5, 0.0, 0.35}, {0.5, 1.28, 0.7}, 0.0}}};  // the gap is not seen for a while
  drive_by(3);
  ASSERT_EQ(confirmed().size(), 2U);
  for (const MapObject* object : confirmed()) {
    const Box box = object->box_world();
    const double end = std::abs(box.center.y()) - 0.5 * std::abs(std::cos(box.yaw) * box.size_m.y()) -
                       0.5 * std::abs(std::sin(box.yaw) * box.size_m.x());
    EXPECT_GT(end, -0.03) << "reaches into the other's place";
  }
}

TEST_F(LibraryStory, WhatWasTakenForOneIsDividedWhereViewsTellItApart) {
  world.things = {{{{2.5, 0.0, 0.35}, {0.5, 1.28, 0.7}, 0.0}}};
  const auto drive_by = [&] {
    for (int i = 0; i < 12; ++i) look(SmallWorld::looking({0.2, -1.6 + 0.05 * i}, {2.6, 0.6}));
  };
  drive_by();
  ASSERT_EQ(confirmed().size(), 1U);
  const Box left{{2.5, 0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0}, right{{2.5, -0.34, 0.35}, {0.5, 0.6, 0.7}, 0.0};
  world.things = {{left}, {right}};
  drive_by();
  finish();
  ASSERT_EQ(confirmed().size(), 2U);
  for (const Box& box : {left, right}) {
    const auto objects = confirmed();
    EXPECT_TRUE(std::ranges::any_of(
        objects, [&](const MapObject* object) { return overlap(object->box_world(), box).iou > 0.5; }));
  }
  EXPECT_TRUE(events.empty()) << "nothing changed";
}

// Ten like it are known, so that its width is; of it only what is left and right of a post is ever seen.
TEST_F(LibraryStory, AThingBehindAPostIsOne) {
  see_ten_around();
  ASSERT_EQ(confirmed().size(), 10U);
  const Box behind{{2.5, 0.0, 0.35}, {0.6, 0.6, 0.7}, 0.0};
  world.things.push_back({behind});
  world.things.push_back({{{2.0, 0.0, 1.0}, {0.05, 0.12, 2.0}, 0.0}, SmallWorld::kWall});
  for (int i = 0; i < 10; ++i) look(SmallWorld::looking({0.0, 0.01 * i - 0.05}, {2.5, 0.0}));
  const auto objects = confirmed();
  EXPECT_EQ(objects.size(), 11U);
  EXPECT_TRUE(std::ranges::any_of(
      objects, [&](const MapObject* object) { return overlap(object->box_world(), behind).iou > 0.5; }));
}

TEST_F(LibraryStory, TwoThingsWithAPostBeforeTheirGapAreTwo) {
  see_ten_around();
  world.things.push_back({{{2.5, 0.34, 0.35}, {0.6, 0.6, 0.7}, 0.0}});
  world.things.push_back({{{2.5, -0.34, 0.35}, {0.6, 0.6, 0.7}, 0.0}});
  world.things.push_back({{{2.0, 0.0, 1.0}, {0.05, 0.12, 2.0}, 0.0}, SmallWorld::kWall});
  for (int i = 0; i < 10; ++i) look(SmallWorld::looking({0.0, 0.01 * i - 0.05}, {2.5, 0.0}));
  EXPECT_EQ(confirmed().size(), 12U) << "together they are wider than any like them";
}

TEST_F(LibraryStory, DepthIsAssumedAsThingsOfTheClassShowIt) {
  for (int i = 0; i < 6; ++i) world.things.push_back({{{2.5, 1.2 * i, 0.4}, {0.3, 0.7, 0.8}, 0.0}});
  for (int i = 0; i < 40; ++i) look(SmallWorld::looking({0.0, -2.5 + 0.2 * i}, {2.5, -0.6 + 0.2 * i}));
  ASSERT_EQ(confirmed().size(), 6U);
  world.things.push_back({{{2.5, -4.0, 0.4}, {0.3, 0.7, 0.8}, 0.0}});
  for (int i = 0; i < 6; ++i) look(SmallWorld::looking({0.0, -4.05 + 0.02 * i}, {2.5, -4.0}));
  const auto objects = confirmed();
  const auto frontal = std::ranges::find_if(
      objects, [](const MapObject* object) { return std::abs(object->box_world().center.y() + 4.0) < 0.3; });
  ASSERT_NE(frontal, objects.end());
  EXPECT_LT((*frontal)->box.size_m.head<2>().minCoeff(), 0.45) << "not as deep as it is wide";
}

TEST_F(LibraryStory, AnotherSideOfAThingIsLearnedThoughItLiesBehindTheKnownOne) {
  world.things = {{{{2.5, 0.0, 0.35}, {0.8, 0.8, 0.7}, 0.0}}};
  for (int i = 0; i < 10; ++i) look(SmallWorld::looking({0.5 + 0.02 * i, 0.0}, {2.5, 0.0}));
  for (int i = 0; i < 10; ++i) look(SmallWorld::looking({2.5, -1.8 + 0.01 * i}, {2.5, 0.0}));
  ASSERT_EQ(confirmed().size(), 1U);
  const MapObject& object = *confirmed()[0];
  int front = 0, right = 0;
  for (const SurfacePoint& point : object.surface) {
    const Eigen::Vector3d p = object.T_world_volume * point.p_volume.cast<double>();
    front += std::abs(p.x() - 2.1) < 0.06 ? 1 : 0;
    right += std::abs(p.y() + 0.4) < 0.06 ? 1 : 0;
  }
  EXPECT_GT(front, 100);
  EXPECT_GT(right, 100);
}

TEST_F(LibraryStory, ASurfaceStaysWhereItIsHoweverOftenItIsSeen) {
  const Box box{{2.5, 0.0, 0.35}, {0.8, 0.8, 0.7}, 0.0};
  world.things = {{box}};
  for (int i = 0; i < 30; ++i) look(SmallWorld::looking({-1.4 + 0.08 * i, -1.2}, {2.5, -0.4}));
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_GT(confirmed()[0]->observations, 25);
  int off = 0;
  for (const SurfacePoint& point : confirmed()[0]->surface) {
    off += box.contains(confirmed()[0]->T_world_volume * point.p_volume.cast<double>(), 0.05) ? 0 : 1;
  }
  EXPECT_LT(20 * off, static_cast<int>(confirmed()[0]->surface.size()));
}

TEST_F(LibraryStory, WhatMovesByLessThanItsSizeIsNotItsOldSelfSeenFromAnotherSide) {
  world.things = {{{{2.5, 0.0, 0.35}, {0.8, 0.8, 0.7}, 0.0}}};
  drive(20);
  ASSERT_EQ(confirmed().size(), 1U);
  const std::int64_t id = confirmed()[0]->id;
  world.things = {{{{2.9, 0.6, 0.35}, {0.8, 0.8, 0.7}, 0.3}}};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(confirmed()[0]->id, id);
}

TEST_F(LibraryStory, OwnsTheLandmarksOnIt) {
  world.things = {{carton(2.5, 0.0)}};
  drive(10);
  const std::int64_t id = confirmed().at(0)->id;
  std::vector<SeenLandmark> landmarks(2);
  landmarks[0] = {77, 3, 159.0F, 150.0F, 0.4F, {}};  // in the middle of the image: the carton
  landmarks[1] = {78, 4, 20.0F, 20.0F, 0.2F, {}};    // the wall
  library.claim_landmarks(landmarks, view, step);
  ASSERT_EQ(step.owners.size(), 1U);
  EXPECT_EQ(step.owners[0].landmark, 77);
  EXPECT_EQ(step.owners[0].object, id);
  library.claim_landmarks(landmarks, view, step);
  EXPECT_EQ(step.owners.size(), 1U) << "told once";
}

}  // namespace
}  // namespace povslam
