#include "pipeline/objects/label_join.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <algorithm>
#include <limits>
#include <random>
#include <set>

namespace povslam {
namespace {

using testing::ElementsAre;
using testing::IsEmpty;

constexpr TimeNs kPeriod = 100 * kNsPerMs;  // of the camera: 10 Hz
constexpr int kWidth = 64, kHeight = 48;

View view_at(TimeNs stamp) {
  View view;
  view.frame.stamp = stamp;
  view.frame.color.resize(kWidth, kHeight, 3);
  return view;
}

LabelFrame labels_at(TimeNs stamp, std::uint8_t id = kGeometricObject, int width = kWidth, int height = kHeight) {
  LabelFrame labels;
  labels.stamp = stamp;
  labels.classes.resize(width, height);
  labels.classes.fill(id);
  return labels;
}

class LabelJoinTest : public testing::Test {
 protected:
  void view(TimeNs stamp) { join_.add(view_at(stamp)); }
  void labels(TimeNs stamp) { join_.add(labels_at(stamp)); }
  // Stamps in ms of the views that are ready; negative: went on without labels.
  std::vector<TimeNs> ready() {
    std::vector<TimeNs> stamps;
    while (const LabelledView* out = join_.next()) {
      stamps.push_back(out->view.stamp() / kNsPerMs * (out->labelled ? 1 : -1));
    }
    return stamps;
  }
  const LabelCounts& counts() const { return join_.counts(); }

  LabelJoin join_{{.capacity = 6, .max_latency_s = 1.0, .period_s = 0.1, .width = kWidth, .height = kHeight},
                  geometric_classes()};
};

TEST_F(LabelJoinTest, GivesAViewTheLabelsOfItsImageHoweverLateTheyAre) {
  view(1 * kPeriod);
  EXPECT_THAT(ready(), IsEmpty());
  view(3 * kPeriod);
  view(5 * kPeriod);
  labels(1 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(100));
  labels(3 * kPeriod);
  labels(5 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(300, 500));
  EXPECT_EQ(counts().joined, 3);
  EXPECT_EQ(counts().missing, 0);
}

// An image is a megabyte and a half.
TEST_F(LabelJoinTest, NeedsNoMoreBuffersThanViewsWaitAtOnce) {
  LabelJoin unlabelled({.capacity = 6, .max_latency_s = 0.0, .width = kWidth, .height = kHeight, .labels_come = false},
                       geometric_classes());
  std::set<const void*> buffers;
  View view;
  for (int i = 1; i <= 20; ++i) {
    view.frame.stamp = i * kPeriod;
    view.frame.color.resize(kWidth, kHeight, 3);
    buffers.insert(view.frame.color.data());
    unlabelled.add(std::move(view));
    ASSERT_NE(unlabelled.next(), nullptr);
  }
  EXPECT_LE(buffers.size(), 3u);
}

TEST_F(LabelJoinTest, KeepsLabelsThatComeBeforeTheirView) {
  labels(1 * kPeriod);
  labels(2 * kPeriod);
  labels(3 * kPeriod);
  view(2 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(200));
  EXPECT_EQ(counts().unmatched, 1) << "nobody took a view of the first image, and nobody will";
  view(3 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(300));
}

TEST_F(LabelJoinTest, TakesTheNearestWithinHalfAFramePeriodAndNoFarther) {
  view(10 * kPeriod);
  labels(10 * kPeriod + kPeriod / 2);
  EXPECT_THAT(ready(), ElementsAre(1000));
  view(20 * kPeriod);
  labels(20 * kPeriod - kPeriod / 2 - 1);
  EXPECT_THAT(ready(), IsEmpty());
  EXPECT_EQ(counts().unmatched, 1);
  view(21 * kPeriod);
  labels(20 * kPeriod + kPeriod / 2 + 1);  // nearer to the second
  EXPECT_THAT(ready(), ElementsAre(-2000, 2100));
}

TEST_F(LabelJoinTest, PrefersExactLabelsToNearOnesWhileTheViewIsHere) {
  view(10 * kPeriod);
  join_.add(labels_at(10 * kPeriod - 20 * kNsPerMs, kGeometricStructure));
  join_.add(labels_at(10 * kPeriod, kGeometricObject));
  join_.add(labels_at(10 * kPeriod + 20 * kNsPerMs, kGeometricStructure));
  const LabelledView* out = join_.next();
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(out->labels.stamp, 10 * kPeriod);
  EXPECT_EQ(out->labels.classes.at(5, 5), kGeometricObject);
  EXPECT_EQ(counts().joined, 1);
  EXPECT_EQ(counts().unmatched, 2);
}

TEST_F(LabelJoinTest, LetsAViewGoOnWithoutLabelsAfterTheLongestLatency) {
  view(0);
  view(9 * kPeriod);
  EXPECT_THAT(ready(), IsEmpty());
  view(10 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(0)) << "0 has no sign";
  EXPECT_EQ(counts().missing, 1);
  labels(0);
  EXPECT_EQ(counts().late, 1);
  labels(9 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(900)) << "late labels do no harm to those in time";
}

TEST_F(LabelJoinTest, DoesNotWaitForLabelsThatTheSourceHasPassedOver) {
  for (int i = 1; i <= 4; ++i) view(i * kPeriod);
  labels(4 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(-100, -200, -300, 400));
  EXPECT_EQ(counts().missing, 3);
}

TEST_F(LabelJoinTest, RefusesDuplicatesAndLabelsOutOfOrder) {
  view(1 * kPeriod);
  view(2 * kPeriod);
  labels(2 * kPeriod);
  labels(2 * kPeriod);
  labels(1 * kPeriod);
  EXPECT_EQ(counts().bad, 2);
  EXPECT_THAT(ready(), ElementsAre(-100, 200));
}

TEST_F(LabelJoinTest, RefusesStampsFromTheFutureAndGoesOn) {
  view(1 * kPeriod);
  labels(1 * kPeriod + from_seconds(1.0) + 1);
  labels(std::numeric_limits<TimeNs>::max());
  EXPECT_EQ(counts().bad, 2);
  labels(1 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(100));
  labels(std::numeric_limits<TimeNs>::min());
  EXPECT_EQ(counts().bad, 3);
}

TEST_F(LabelJoinTest, ForgetsNonsenseThatCameBeforeTheFirstView) {
  labels(1 * kPeriod);
  labels(std::numeric_limits<TimeNs>::max());
  view(1 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(100));
  EXPECT_EQ(counts().bad, 1);
  view(2 * kPeriod);
  labels(2 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(200));
}

TEST_F(LabelJoinTest, RefusesSizesThatAreNotTheImages) {
  view(1 * kPeriod);
  for (const auto& [width, height] : {std::pair{0, 0}, {128, 96}, {64, 24}, {32, 48}, {48, 64}}) {
    join_.add(labels_at(1 * kPeriod, kGeometricObject, width, height));
  }
  LabelFrame wrong_instances = labels_at(1 * kPeriod);
  wrong_instances.instances.resize(kWidth / 2, kHeight / 2);
  join_.add(wrong_instances);
  EXPECT_EQ(counts().wrong_size, 6);
  EXPECT_EQ(counts().bad, 0);
  join_.add(labels_at(1 * kPeriod, kGeometricObject, kWidth / 3, kHeight / 3));  // smaller, rounded
  EXPECT_THAT(ready(), ElementsAre(100));
}

TEST_F(LabelJoinTest, MissesNothingWhereNobodyLabels) {
  LabelJoin join({.max_latency_s = 0.0, .width = kWidth, .height = kHeight, .labels_come = false}, geometric_classes());
  join.add(view_at(1 * kPeriod));
  EXPECT_NE(join.next(), nullptr);
  EXPECT_EQ(join.counts().missing, 0);
}

TEST_F(LabelJoinTest, TurnsIdsThatTheTableDoesNotKnowIntoUnlabelledAndCountsThem) {
  view(1 * kPeriod);
  LabelFrame labels = labels_at(1 * kPeriod);
  labels.classes.at(3, 4) = 77;
  labels.classes.at(4, 4) = 255;
  labels.classes.at(5, 4) = 0;
  join_.add(labels);
  const LabelledView* out = join_.next();
  ASSERT_NE(out, nullptr);
  EXPECT_EQ(out->labels.classes.at(3, 4), 0);
  EXPECT_EQ(out->labels.classes.at(4, 4), 0);
  EXPECT_EQ(out->labels.classes.at(6, 4), kGeometricObject);
  EXPECT_EQ(counts().unknown_ids, 2);
}

TEST_F(LabelJoinTest, DropsTheOldestViewWhenNobodyTakesThem) {
  for (int i = 1; i <= 8; ++i) view(i * kPeriod / 2);
  EXPECT_EQ(counts().dropped_views, 2);
  labels(1 * kPeriod / 2);
  EXPECT_EQ(counts().late, 1);
  join_.stop_waiting();
  EXPECT_THAT(ready(), ElementsAre(-150, -200, -250, -300, -350, -400));
}

TEST_F(LabelJoinTest, LetsTheOldestGoOnInsteadOfDroppingItWhenTheRingIsFull) {
  std::vector<TimeNs> out;
  for (int i = 1; i <= 20; ++i) {
    view(i * kPeriod / 10);  // far more views than may wait
    for (const TimeNs stamp : ready()) out.push_back(stamp);
  }
  EXPECT_EQ(out.size(), 15u);
  EXPECT_EQ(counts().dropped_views, 0);
}

TEST_F(LabelJoinTest, CountsViewsWhoseStampsDoNotIncreaseAndIgnoresThem) {
  view(2 * kPeriod);
  view(2 * kPeriod);
  view(1 * kPeriod);
  EXPECT_EQ(counts().dropped_views, 2);
  labels(2 * kPeriod);
  EXPECT_THAT(ready(), ElementsAre(200));
}

TEST_F(LabelJoinTest, GivesBuffersBackForReuse) {
  const std::uint8_t* first = nullptr;
  bool reused = false;
  View mine;
  for (int i = 1; i <= 30; ++i) {
    mine.frame.stamp = i * kPeriod;
    mine.frame.color.resize(kWidth, kHeight, 3);
    if (i == 1) first = mine.frame.color.data();
    if (i > 1) reused |= mine.frame.color.data() == first;
    join_.add(std::move(mine));
    labels(i * kPeriod);
    ready();
  }
  EXPECT_TRUE(reused);
}

// A source as bad as sources get: latency with jitter, losses, duplicates, reordering. Whatever comes, every view comes
// out once and in order, labelled only by its own image, and every label frame is counted exactly once.
TEST(LabelJoinProperty, EveryViewComesOutOnceWithItsOwnLabelsOrNone) {
  rc::check([] {
    const auto seed = *rc::gen::arbitrary<std::uint32_t>();
    std::mt19937 random(seed);
    const auto chance = [&random](double p) { return std::uniform_real_distribution<>(0, 1)(random) < p; };
    LabelJoin join({.capacity = 8, .max_latency_s = 0.5, .period_s = 0.1, .width = 8, .height = 6},
                   geometric_classes());
    struct Arrival {
      TimeNs when = 0, stamp = 0;
    };
    std::vector<Arrival> arrivals;
    const int max_delay_ms = std::uniform_int_distribution<>(0, 800)(random);
    for (int i = 0; i < 60; ++i) {
      if (chance(0.2)) continue;
      for (int copy = 0; copy < (chance(0.1) ? 2 : 1); ++copy) {
        const TimeNs delay = std::uniform_int_distribution<TimeNs>(-50, max_delay_ms)(random) * kNsPerMs;
        arrivals.push_back({i * kPeriod + delay, i * kPeriod});
      }
    }
    std::stable_sort(arrivals.begin(), arrivals.end(), [](const auto& a, const auto& b) { return a.when < b.when; });
    std::vector<TimeNs> out;
    std::int64_t labelled = 0, views = 0;
    const auto take = [&] {
      while (const LabelledView* view = join.next()) {
        if (view->labelled) RC_ASSERT(view->labels.stamp == view->view.stamp());
        RC_ASSERT((out.empty() || view->view.stamp() > out.back()));
        out.push_back(view->view.stamp());
        labelled += view->labelled ? 1 : 0;
      }
    };
    std::size_t arrived = 0;
    for (int i = 0; i < 60; i += 2, ++views) {
      for (; arrived < arrivals.size() && arrivals[arrived].when < i * kPeriod; ++arrived) {
        join.add(labels_at(arrivals[arrived].stamp, kGeometricObject, 8, 6));
        take();
      }
      join.add(view_at(i * kPeriod));
      take();
    }
    join.stop_waiting();
    take();
    const LabelCounts& counts = join.counts();
    RC_ASSERT(static_cast<std::int64_t>(out.size()) == views);
    RC_ASSERT(counts.dropped_views == 0);
    RC_ASSERT((counts.joined == labelled && counts.missing == views - labelled));
    RC_ASSERT(counts.received == static_cast<std::int64_t>(arrived));
    const std::int64_t judged = counts.joined + counts.late + counts.unmatched + counts.bad + counts.wrong_size;
    RC_ASSERT((judged <= counts.received && judged >= counts.received - 16));  // the rest may still find a view
  });
}

}  // namespace
}  // namespace povslam
