#include "daemon/understanding_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>

#include "daemon/store_thread.hpp"
#include "tests/support/fake_mind.hpp"
#include "tests/support/log_text.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 5000; ++i) {
    if (condition()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
  }
  return false;
}

constexpr PinholeCamera kCamera{32, 24, 30.0, 30.0, 15.5, 11.5, {}};

struct Heard {
  std::vector<std::int64_t> events;
  std::size_t objects = 99;
  UnderstandingNews news;
};

class UnderstandingThreadTest : public testing::Test {
 protected:
  using Thread = BasicUnderstandingThread<FakeMind>;

  std::unique_ptr<Thread> start(ChangeWay<WorldChange>* changes = nullptr) {
    return std::make_unique<Thread>(
        mind_, UnderstandingLinks{bell_, views_, labels_, nullptr, owners_, beliefs_, reports_, changes});
  }
  // As tracking does: false when there is no room.
  bool hand_over(TimeNs stamp) {
    View* view = views_.draft();
    if (view == nullptr) return false;
    view->frame.stamp = stamp;
    views_.submit();
    return true;
  }
  void label(TimeNs stamp) {
    LabelFrame labels;
    labels.stamp = stamp;
    EXPECT_TRUE(labels_.try_push(std::move(labels)));
  }
  const Heard& listen() {
    while (auto report = reports_.try_pop()) {
      if (const auto* event = std::get_if<ObjectEvent>(&*report)) heard_.events.push_back(event->seq);
      if (const auto* objects = std::get_if<ObjectSnapshot>(&*report)) heard_.objects = objects->objects.size();
      if (const auto* news = std::get_if<UnderstandingNews>(&*report)) heard_.news = *news;
    }
    return heard_;
  }

  Doorbell bell_;
  ViewExchange views_{3, kCamera, 100, &bell_};
  LabelRing labels_{8, &bell_};
  OwnerRing owners_{64};
  BeliefRing beliefs_{64};
  ReportRing reports_{256};
  FakeMind mind_;
  Heard heard_;
};

TEST_F(UnderstandingThreadTest, SaysOnceThatTheNetworkFails) {
  const LogText log;
  mind_.names_failed = 3;
  auto thread = start();
  ASSERT_TRUE(hand_over(1));
  ASSERT_TRUE(hand_over(2));
  thread->finish();
  EXPECT_EQ(listen().news.naming.failed, 3);
  EXPECT_THAT(log.text(), testing::HasSubstr("out of memory"));
  EXPECT_EQ(log.lines(), 1);
}

TEST_F(UnderstandingThreadTest, UnderstandsEachViewAndTellsWhatCameOfIt) {
  const auto thread = start();
  for (TimeNs stamp = 1; stamp <= 20; ++stamp) {
    ASSERT_TRUE(eventually([&] { return hand_over(stamp); }));
  }
  thread->finish();
  const Heard& heard = listen();
  EXPECT_EQ(heard.events.size(), 21u) << "one a view, one at the end";
  EXPECT_TRUE(std::is_sorted(heard.events.begin(), heard.events.end()));
  EXPECT_EQ(heard.objects, 10u) << "the confirmed ones";
  EXPECT_EQ(heard.news.views_understood, 20);
  EXPECT_EQ(heard.news.events, 21);
  EXPECT_EQ(heard.news.objects, 10);
  int owners = 0;
  while (const auto owner = owners_.try_pop()) owners += owner->object == 7 ? 1 : 0;
  EXPECT_EQ(owners, 20);
}

TEST_F(UnderstandingThreadTest, WakesForLabelsToo) {
  mind_.wait_for_labels = true;
  const auto thread = start();
  hand_over(5);
  EXPECT_TRUE(eventually([this] { return mind_.views == 1; }));
  EXPECT_EQ(listen().news.views_understood, 0);
  label(5);
  EXPECT_TRUE(eventually([this] { return listen().news.views_understood == 1; }));
  EXPECT_EQ(heard_.news.labels.received, 1);
}

TEST_F(UnderstandingThreadTest, EndsWithViewsThatWaitForLabelsUnderstoodWithout) {
  mind_.wait_for_labels = true;
  const auto thread = start();
  for (TimeNs stamp = 1; stamp <= 5; ++stamp) {
    ASSERT_TRUE(eventually([&] { return hand_over(stamp); }));
  }
  thread->finish();
  EXPECT_EQ(listen().news.views_understood, 5);
}

TEST_F(UnderstandingThreadTest, LeavesTrackingWithoutASlotAndNeverWaitingWhenItIsSlow) {
  mind_.slowness_ms = 30;
  const auto thread = start();
  int dropped = 0;
  for (TimeNs stamp = 1; stamp <= 100; ++stamp) dropped += hand_over(stamp) ? 0 : 1;
  EXPECT_GT(dropped, 50);
  thread->finish();
  EXPECT_EQ(mind_.views, 100 - dropped);
  EXPECT_EQ(listen().news.views_understood, 100 - dropped);
}

TEST_F(UnderstandingThreadTest, KeepsTheBuffersOfViewsReadyForTracking) {
  const auto thread = start();
  for (TimeNs stamp = 1; stamp <= 10; ++stamp) {
    ASSERT_TRUE(eventually([&] { return hand_over(stamp); }));
    EXPECT_TRUE(eventually([&] { return views_.draft() != nullptr; }));
    const View& next = *views_.draft();
    EXPECT_EQ(next.frame.color.size(), 32u * 24 * 3);
    EXPECT_EQ(next.frame.depth.size(), 32u * 24);
    EXPECT_GE(next.landmarks.capacity(), 100u);
  }
}

TEST_F(UnderstandingThreadTest, PublishesAnEventOnlyOnceItIsStored) {
  ChangeRings changes(&bell_);
  const auto thread = start(&changes.world);
  hand_over(1);
  auto change = changes.world.taken.pop();  // without waiting for the period of changes
  ASSERT_TRUE(change);
  hand_over(2);
  EXPECT_TRUE(eventually([this] { return mind_.views == 2 && listen().news.views_understood == 2; }));
  EXPECT_TRUE(listen().events.empty());
  changes.world.stored.try_push(std::move(*change));
  EXPECT_TRUE(eventually([this] { return listen().events.size() == 1; }));
  change = changes.world.taken.pop();  // the second, handed out when the first was back
  EXPECT_EQ((*change)->events.size(), 1u);
  EXPECT_EQ(mind_.given_back, 1);
  changes.world.stored.try_push(std::move(*change));
  thread->finish();
  EXPECT_THAT(listen().events, testing::ElementsAre(0, 1)) << "the one of the end is not stored yet";
}

TEST_F(UnderstandingThreadTest, GivesTheRestOutAtTheEnd) {
  ChangeRings changes(&bell_);
  const auto thread = start(&changes.world);
  hand_over(1);
  auto change = changes.world.taken.pop();
  thread->finish();  // the first change is still out
  EXPECT_TRUE(listen().events.empty());
  changes.world.stored.try_push(std::move(*change));
  WorldChange* rest = thread->rest();
  ASSERT_NE(rest, nullptr);
  EXPECT_THAT(listen().events, testing::ElementsAre(0));
  EXPECT_EQ(rest->events.size(), 1u);
  thread->stored(rest);
  EXPECT_THAT(listen().events, testing::ElementsAre(0, 1));
  EXPECT_EQ(thread->rest(), nullptr);
}

// The whole way through a real store: whatever was published is on the disk.
TEST_F(UnderstandingThreadTest, StoresWhatItPublishes) {
  const TempFolder folder;
  const auto file = folder.path() / "map.db";
  Counters counters;
  ChangeRings changes(&bell_);
  auto store = MapStore::open(file, StoreMode::read_write);
  ASSERT_TRUE(store);
  StoreThread storing(std::move(*store), changes, counters);
  const auto thread = start(&changes.world);
  for (TimeNs stamp = 1; stamp <= 30; ++stamp) {
    ASSERT_TRUE(eventually([&] { return hand_over(stamp); }));
    if (stamp % 10 != 0) continue;
    const std::vector<std::int64_t> told = listen().events;
    auto reader = MapStore::open(file, StoreMode::read_only);
    ASSERT_TRUE(reader);
    const auto world = reader->load_world();
    ASSERT_TRUE(world);
    EXPECT_GE(world->events.size(), told.size());
  }
  thread->finish();
  ASSERT_TRUE(storing.finish());
  if (WorldChange* rest = thread->rest()) {
    ASSERT_TRUE(storing.commit_rest(nullptr, rest));
    thread->stored(rest);
  }
  std::vector<std::int64_t> all(31);
  for (std::size_t i = 0; i < all.size(); ++i) all[i] = static_cast<std::int64_t>(i);
  EXPECT_EQ(listen().events, all);
  EXPECT_EQ(MapStore::open(file, StoreMode::read_only)->load_world()->events.size(), 31u);
}

TEST(UnderstandingOutlet, KeepsEventsOwnersAndBeliefsUntilThereIsRoom) {
  ReportRing reports(2);
  OwnerRing owners(2);
  BeliefRing beliefs(2);
  UnderstandingOutlet outlet(reports, owners, beliefs);
  std::vector<ObjectEvent> events(5);
  for (std::size_t i = 0; i < events.size(); ++i) events[i].seq = static_cast<std::int64_t>(i);
  const std::vector<LandmarkOwner> changed{{1, 0, 1}, {2, 0, 1}, {3, 0, 1}};
  outlet.add(std::span<const ObjectEvent>(events));
  outlet.add(std::span<const LandmarkOwner>(changed));
  std::vector<ObjectBelief> told(3);
  for (std::size_t i = 0; i < told.size(); ++i) told[i].object = static_cast<std::int64_t>(i);
  outlet.add(std::span<const ObjectBelief>(told));
  std::vector<std::int64_t> got, landmarks, objects;
  for (int i = 0; i < 3; ++i) {
    outlet.flush();
    while (const auto report = reports.try_pop()) got.push_back(std::get<ObjectEvent>(*report).seq);
    while (const auto owner = owners.try_pop()) landmarks.push_back(owner->landmark);
    while (const auto belief = beliefs.try_pop()) objects.push_back(belief->object);
  }
  EXPECT_THAT(got, testing::ElementsAre(0, 1, 2, 3, 4));
  EXPECT_THAT(landmarks, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(objects, testing::ElementsAre(0, 1, 2));
  EXPECT_EQ(outlet.unsent_events(), 0u);
}

}  // namespace
}  // namespace povslam
