// Two boxes that were seen as one; one is taken.
#include "pipeline/objects/part_change.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/objects/library_story.hpp"

namespace povslam {
namespace {

class PartStory : public LibraryStory {
 protected:
  using LibraryStory::LibraryStory;

  // Touching: no groove tells them apart.
  const SmallWorld::Thing left{{{2.5, 0.4, 0.35}, {0.6, 0.8, 0.7}, 0.0}, SmallWorld::kPallet, 120};
  const SmallWorld::Thing right{{{2.5, -0.3, 0.35}, {0.6, 0.6, 0.7}, 0.0}, SmallWorld::kPallet, 120};
};
TEST_F(PartStory, ATakenHalfIsRemovedAndTheOtherHalfStaysWhatItWas) {
  world.things = {left, right};
  drive(20);
  ASSERT_EQ(confirmed().size(), 1U) << "the story needs two that are seen as one";
  const std::int64_t id = confirmed()[0]->id;
  world.things = {left};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::removed);
  EXPECT_NE(events[0].object, id);
  EXPECT_EQ(events[0].class_name, "pallet");
  EXPECT_LT((events[0].place.position - right.box.center).norm(), 0.15);
  EXPECT_GT(overlap({events[0].place.position, events[0].size_m, events[0].place.yaw}, right.box).iou, 0.5);
  ASSERT_TRUE(events[0].evidence.first_absent);
  EXPECT_GT(*events[0].evidence.first_absent, events[0].evidence.last_present);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(confirmed()[0]->id, id);
  EXPECT_GT(overlap(confirmed()[0]->box_world(), left.box).iou, 0.5);
}

TEST_F(PartStory, ATakenHalfThatIsFoundElsewhereMoved) {
  world.things = {left, right};
  drive(20);
  SmallWorld::Thing moved = right;
  moved.box.center.y() = -1.1;
  world.things = {left, moved};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_LT((events[0].place.position - moved.box.center).norm(), 0.15);
  EXPECT_EQ(confirmed().size(), 2U);
}

TEST_F(PartStory, TheOtherHalfCanGoLater) {
  world.things = {left, right};
  drive(20);
  world.things = {left};
  drive(20);
  world.things = {};
  drive(20);
  finish();
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[1].type, ObjectEventType::removed);
  EXPECT_LT((events[1].place.position - left.box.center).norm(), 0.25);
  EXPECT_TRUE(confirmed().empty());
}

// Shifted along its face, most of it seems to stand and an end to be gone.
TEST_F(PartStory, AShiftedThingHasNotLostAPart) {
  SmallWorld::Thing wide{{{2.5, 0.2, 0.35}, {0.6, 1.6, 0.7}, 0.0}, SmallWorld::kPallet, 120};
  world.things = {wide};
  drive(20);
  wide.box.center.y() = -0.3;
  world.things = {wide};
  drive(20);
  finish();
  for (const ObjectEvent& event : events) EXPECT_GT(event.size_m.maxCoeff(), 1.2) << to_string(event.type);
}

TEST_F(PartStory, WhatIsHiddenIsNotTaken) {
  world.things = {left, right};
  drive(20);
  world.things.push_back({{{1.2, -0.35, 0.5}, {0.3, 0.5, 1.0}, 0.0}, SmallWorld::kCarton, 80});
  drive(20);
  finish();
  for (const ObjectEvent& event : events) EXPECT_NE(event.class_name, "pallet") << to_string(event.type);
}

ObjectOptions switched_off() {
  ObjectOptions options;
  options.life.part_min_m = 0.0;
  return options;
}
class SwitchedOffStory : public PartStory {
 protected:
  SwitchedOffStory() : PartStory(switched_off()) {}
};

TEST_F(SwitchedOffStory, SaysNothing) {
  world.things = {left, right};
  drive(20);
  world.things = {left};
  drive(20);
  finish();
  EXPECT_TRUE(events.empty());
}

}  // namespace
}  // namespace povslam
