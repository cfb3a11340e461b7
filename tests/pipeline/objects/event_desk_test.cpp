#include "pipeline/objects/event_desk.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

class EventDeskTest : public testing::Test {
 protected:
  static PlaceChange thing(std::int64_t id, double x, TimeNs at, const char* name = "box",
                           Eigen::Vector3d size = {0.8, 0.6, 0.5}) {
    PlaceChange change;
    change.object = id;
    change.class_name = name;
    change.place.position = {x, 0.0, 0.25};
    change.size_m = size;
    change.probability = 0.9;
    change.decided = at;
    return change;
  }
  void decide(double t) { desk.decide(from_seconds(t), events); }

  std::vector<std::pair<std::int64_t, std::int64_t>> renamed;
  EventDesk desk{EventDeskOptions{}, 5,
                 [this](std::int64_t came, std::int64_t gone) { renamed.emplace_back(came, gone); }};
  std::vector<ObjectEvent> events;
};

TEST_F(EventDeskTest, TellsAMoveOnceWhenWhatWentIsFoundElsewhere) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  decide(11.0);
  EXPECT_TRUE(events.empty());
  desk.came(thing(2, 1.5, from_seconds(12), "box", {0.62, 0.79, 0.52}));  // a quarter turned
  decide(12.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_EQ(events[0].seq, 5);
  EXPECT_EQ(events[0].object, 1);
  EXPECT_EQ(events[0].place.position.x(), 1.5);
  ASSERT_TRUE(events[0].from);
  EXPECT_EQ(events[0].from->position.x(), 0.0);
  EXPECT_EQ(renamed, (std::vector<std::pair<std::int64_t, std::int64_t>>{{2, 1}}));
  decide(100.0);
  EXPECT_EQ(events.size(), 1U);
}

TEST_F(EventDeskTest, LooksAtWhatCameBeforeItTellsWhere) {
  PlaceChange came = thing(2, 1.5, from_seconds(12));
  came.evidence.last_present = from_seconds(12);
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(came);
  for (int t = 12; t < 16; ++t) {
    came.place.position.x() = 1.5 + 0.1 * (t - 11);
    came.evidence.last_present = from_seconds(t);
    desk.refresh(came);
    decide(t);
    EXPECT_TRUE(events.empty()) << t;
  }
  decide(16.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_NEAR(events[0].place.position.x(), 1.9, 1e-9);
}

TEST_F(EventDeskTest, LooksNoLongerThanWhatWentCanWait) {
  PlaceChange came = thing(2, 1.5, from_seconds(16));
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(came);
  for (int t = 16; t <= 20; ++t) {
    came.evidence.last_present = from_seconds(t);
    desk.refresh(came);
    decide(t);
  }
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_EQ(events[0].stamp, from_seconds(18));
}

TEST_F(EventDeskTest, TellsWhereAThingCameWhenItIsOutOfView) {
  PlaceChange came = thing(2, 1.5, from_seconds(12));
  came.evidence.last_present = from_seconds(12);
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(came);
  decide(13.0);
  EXPECT_TRUE(events.empty());
  decide(13.1);
  EXPECT_EQ(events.size(), 1U);
}

TEST_F(EventDeskTest, AThingWithoutANameMayBeOneThatHasOne) {
  desk.gone(thing(1, 0.0, from_seconds(10), "chair"));
  PlaceChange unnamed = thing(2, 1.5, from_seconds(12), "object");
  unnamed.named = false;
  desk.came(unnamed);
  decide(12.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_EQ(events[0].class_name, "chair");
}

TEST_F(EventDeskTest, WaitsForTheOtherHalfWhicheverComesFirst) {
  desk.came(thing(2, 1.5, from_seconds(10)));
  decide(15.0);
  EXPECT_TRUE(events.empty());
  desk.gone(thing(1, 0.0, from_seconds(15)));
  decide(15.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
}

TEST_F(EventDeskTest, TellsHalvesThatStayAloneAfterTheHold) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(thing(2, 1.0, from_seconds(11), "pallet"));
  desk.came(thing(3, 1.0, from_seconds(12), "box", {2.0, 0.6, 0.5}));
  decide(17.9);
  EXPECT_TRUE(events.empty());
  decide(18.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::removed);
  decide(20.0);
  ASSERT_EQ(events.size(), 3U);
  EXPECT_EQ(events[1].type, ObjectEventType::appeared);
  EXPECT_EQ(events[2].seq, 7);
}

TEST_F(EventDeskTest, PairsAThingWithTheNearestOfThoseAlike) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.gone(thing(2, 2.0, from_seconds(10)));
  desk.came(thing(3, 2.8, from_seconds(10)));
  decide(10.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].object, 2);
}

TEST_F(EventDeskTest, GivesEachThingTheOriginThatSuitsAllBest) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.gone(thing(2, 2.0, from_seconds(10)));
  desk.came(thing(3, 1.4, from_seconds(10)));
  desk.came(thing(4, 2.1, from_seconds(10)));
  decide(10.0);
  ASSERT_EQ(renamed.size(), 2U);
  EXPECT_EQ(renamed[0], std::make_pair(std::int64_t{4}, std::int64_t{2}));
  EXPECT_EQ(renamed[1], std::make_pair(std::int64_t{3}, std::int64_t{1}));
}

TEST_F(EventDeskTest, WaitsWithAFarPairForANearerOne) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(thing(2, 6.0, from_seconds(11)));
  decide(12.0);
  EXPECT_TRUE(events.empty());
  desk.came(thing(3, 0.7, from_seconds(13)));
  decide(13.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(renamed[0].first, 3);
}

TEST_F(EventDeskTest, PairsWhatShowsItselfAlikeOnlyWhileItWaits) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(thing(2, 0.7, from_seconds(10), "box", {0.3, 0.2, 0.5}));
  decide(10.0);
  EXPECT_TRUE(events.empty());
  desk.refresh(thing(2, 0.8, from_seconds(12)));
  decide(12.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
  EXPECT_EQ(events[0].place.position.x(), 0.8);
}

TEST_F(EventDeskTest, AThingFoundCameFromNearbyOnlyIfItLooksTheSameAndBothCannotHaveStood) {
  PlaceChange gone = thing(1, 0.0, from_seconds(10)), found = thing(2, 0.5, from_seconds(10));
  gone.appearance.share[0] = found.appearance.share[0] = 1.0F;
  gone.evidence.last_present = from_seconds(9);
  found.evidence.first_present = from_seconds(8);  // their boxes overlap: one of the two was taken for the other
  PlaceChange beside = found;
  beside.object = 3;
  beside.place.position.x() = 1.5;
  desk.gone(gone);
  desk.found(beside);
  decide(10.0);
  EXPECT_TRUE(events.empty()) << "it stood there before the other went";
  desk.found(found);
  decide(10.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(renamed[0].first, 2);
}

TEST_F(EventDeskTest, AThingSeenInPartMayHaveBeenLarger) {
  PlaceChange gone = thing(1, 0.0, from_seconds(10), "box", {0.4, 0.35, 0.5});
  const PlaceChange came = thing(2, 1.0, from_seconds(10));
  desk.gone(gone);
  desk.came(came);
  decide(10.0);
  EXPECT_TRUE(events.empty()) << "it was seen whole";
  gone.object = 3;
  gone.whole = false;
  desk.gone(gone);
  decide(10.0);
  EXPECT_TRUE(events.empty()) << "nothing is known of their looks";
}

TEST_F(EventDeskTest, AThingSeenInPartIsKnownByItsLooks) {
  PlaceChange gone = thing(1, 0.0, from_seconds(10), "box", {0.4, 0.35, 0.5}), came = thing(2, 1.0, from_seconds(10));
  gone.whole = false;
  gone.appearance.share[0] = came.appearance.share[0] = 1.0F;
  came.size_m = {0.3, 0.35, 0.5};
  desk.gone(gone);
  desk.came(came);
  came.object = 3;
  came.size_m = {0.8, 0.2, 0.5};
  desk.came(came);
  decide(10.0);
  ASSERT_EQ(renamed.size(), 1U) << "no smaller one than was seen";
  EXPECT_EQ(renamed[0].first, 2);
}

TEST_F(EventDeskTest, AThingOthersHidInPartIsKnownByVeryAlikeLooks) {
  PlaceChange gone = thing(1, 0.0, from_seconds(10), "box", {0.4, 0.35, 0.5}), came = thing(2, 1.0, from_seconds(10));
  gone.appearance.share = {0.7F, 0.3F};
  came.appearance.share = {0.7F, 0.0F, 0.3F};
  desk.gone(gone);
  desk.came(came);
  decide(10.0);
  EXPECT_TRUE(events.empty());
  came.appearance.share = {0.8F, 0.2F};
  desk.refresh(came);
  decide(11.0);
  EXPECT_EQ(renamed.size(), 1U);
}

TEST_F(EventDeskTest, WhatStandsBesideIsTakenForItWhenNothingLooksMoreAlike) {
  PlaceChange gone = thing(1, 0.0, from_seconds(10)), found = thing(2, 1.2, from_seconds(12));
  gone.evidence.last_present = from_seconds(9);
  found.evidence.first_present = from_seconds(11);
  gone.appearance.share = {0.4F, 0.6F};
  found.appearance.share = {0.4F, 0.0F, 0.6F};
  desk.gone(gone);
  desk.found(found);
  decide(17.9);
  EXPECT_TRUE(events.empty());
  decide(18.0);
  ASSERT_EQ(events.size(), 1U);
  EXPECT_EQ(events[0].type, ObjectEventType::moved);
}

TEST_F(EventDeskTest, ForgetsWhatIsWithdrawn) {
  desk.came(thing(3, 2.8, from_seconds(10)));
  desk.withdraw(3);
  desk.decide_all(from_seconds(11), events);
  EXPECT_TRUE(events.empty());
}

TEST_F(EventDeskTest, DecidesEverythingAtTheEnd) {
  desk.gone(thing(1, 0.0, from_seconds(10)));
  desk.came(thing(2, 1.0, from_seconds(10), "pallet"));
  desk.decide_all(from_seconds(11), events);
  ASSERT_EQ(events.size(), 2U);
  EXPECT_EQ(events[0].stamp, from_seconds(11));
  EXPECT_EQ(desk.next_seq(), 7);
}

}  // namespace
}  // namespace povslam
