#include "daemon/reporter.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <functional>

#include "tests/support/log_text.hpp"

namespace povslam {
namespace {

using testing::HasSubstr;

class Keeper : public Sink {
 public:
  void on_health(const Health& health) override { health_ = health; }
  void on_event(const ObjectEvent& event) override { events.push_back(event.seq); }
  void on_objects(const ObjectSnapshot& objects) override {
    num_objects = objects.objects.size();
    ++lists;
  }
  std::vector<std::int64_t> events;
  std::size_t num_objects = 99;
  std::atomic<int> lists{0};
  Health health_;
};

ObjectEvent event(std::int64_t seq, ObjectEventType type = ObjectEventType::appeared) {
  ObjectEvent event;
  event.seq = seq;
  event.type = type;
  event.object = 12;
  event.class_name = "box";
  event.place.position = {1.0, 5.0, 0.4};
  event.probability = 0.97;
  return event;
}

struct Bench {
  Counters counters;
  ReportRings rings{16, 64};
  Keeper keeper;
  std::optional<Reporter> reporter;
  LogText log;

  void start(TimeNs objects_period = kNsPerSecond) {
    reporter.emplace(ReporterOptions{.health_period = kNsPerSecond, .objects_period = objects_period},
                     std::vector<Sink*>{&keeper}, rings, counters);
  }
};

TEST(Reporter, GivesEachEventOnceInOrderAndALineOfLog) {
  Bench bench;
  bench.start();
  ObjectEvent moved = event(3, ObjectEventType::moved);
  moved.from = ObjectPlace{{1.0, 2.0, 0.4}, 0.0};
  EXPECT_TRUE(bench.rings.world.try_push(event(1)));
  EXPECT_TRUE(bench.rings.world.try_push(event(2, ObjectEventType::removed)));
  EXPECT_TRUE(bench.rings.world.try_push(std::move(moved)));
  bench.reporter.reset();
  EXPECT_THAT(bench.keeper.events, testing::ElementsAre(1, 2, 3));
  EXPECT_THAT(bench.log.text(), HasSubstr("object 12 (box) appeared at (1.00, 5.00, 0.40) m, probability 0.97"));
  EXPECT_THAT(bench.log.text(), HasSubstr("object 12 (box) removed from (1.00, 5.00, 0.40) m"));
  EXPECT_THAT(bench.log.text(), HasSubstr("object 12 (box) moved from (1.00, 2.00, 0.40) to (1.00, 5.00, 0.40) m"));
}

TEST(Reporter, RepeatsTheNewestListOfObjectsForThoseWhoComeLater) {
  Bench bench;
  bench.start(2 * kNsPerMs);
  ObjectSnapshot one, two;
  one.objects.resize(1);
  two.objects.resize(2);
  EXPECT_TRUE(bench.rings.world.try_push(std::move(one)));
  EXPECT_TRUE(bench.rings.world.try_push(std::move(two)));
  for (int i = 0; i < 2000 && bench.keeper.lists < 3; ++i) std::this_thread::sleep_for(std::chrono::milliseconds(1));
  bench.reporter.reset();
  EXPECT_GE(bench.keeper.lists, 3);
  EXPECT_EQ(bench.keeper.num_objects, 2u);
}

TEST(Reporter, IsSilentAboutObjectsWhileNobodyUnderstands) {
  Bench bench;
  bench.start(kNsPerMs);
  std::this_thread::sleep_for(std::chrono::milliseconds(10));
  bench.reporter.reset();
  EXPECT_EQ(bench.keeper.lists, 0);
}

TEST(Reporter, SumsUpUnderstandingInItsHealth) {
  Bench bench;
  bench.start();
  bench.counters.views = 7;
  bench.counters.views_dropped = 2;
  for (int i = 1; i <= 100; ++i) {
    UnderstandingNews news;
    news.views_understood = i;
    news.total_ms = static_cast<float>(i);
    news.labels.joined = i;
    while (!bench.rings.world.try_push(std::move(news))) std::this_thread::yield();
  }
  bench.reporter.reset();
  const UnderstandingHealth& health = bench.keeper.health_.understanding;
  EXPECT_EQ(health.views, 7);
  EXPECT_EQ(health.views_dropped, 2);
  EXPECT_EQ(health.news.views_understood, 100);
  EXPECT_EQ(health.news.labels.joined, 100);
  EXPECT_EQ(health.view_ms.p50, 50.0);
  EXPECT_EQ(health.view_ms.p99, 99.0);
}

}  // namespace
}  // namespace povslam
