#include "daemon/app.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <fstream>
#include <functional>
#include <map>

#include "daemon/config_file.hpp"
#include "drivers/registry.hpp"
#include "tests/support/fake_driver.hpp"
#include "tests/support/log_text.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using Kind = FakeStep::Kind;

class CollectingSink : public Sink {
 public:
  void on_frame(const TrackedFrame& frame) override { frames.push_back(frame); }
  void on_health(const Health& health) override { reports.push_back(health); }
  void on_objects(const ObjectSnapshot& /*objects*/) override { ++lists; }
  std::vector<TrackedFrame> frames;
  std::vector<Health> reports;
  int lists = 0;
};

struct Bench {
  std::shared_ptr<FakeScript> script = std::make_shared<FakeScript>();
  CollectingSink sink;
  std::atomic<bool> ended{false};
  AppConfig config = *parse_config("[[sensor]]\ndriver = \"fake\"\n[daemon]\nhealth_period_s = 0.05\n", "test", {});
  TrackingProbe probe;
  std::filesystem::path map_store;

  Result<std::unique_ptr<App>> start() {
    AppOptions options;
    options.driver = std::make_unique<FakeDriver>(script);
    options.sinks = {&sink};
    options.on_end = [this] {
      ended = true;
      ended.notify_all();
    };
    options.sensor.first_pause = 2 * kNsPerMs;
    options.sensor.longest_pause = 10 * kNsPerMs;
    options.probe = probe;
    options.map_store = map_store;
    return App::start(config, std::move(options));
  }
  std::unique_ptr<App> run_to_end() {
    auto app = start();
    EXPECT_TRUE(app) << app.error().message;
    ended.wait(false);
    (*app)->stop();
    return std::move(*app);
  }
};

bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 1000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(10));
  return condition();
}

std::int64_t all_drops(const Counters& counters) {
  std::int64_t sum = 0;
  for (const auto& drop : counters.drops) sum += drop.load();
  return sum;
}

TEST(App, TracksEveryFrameOfARecordingAndGivesItToTheSinks) {
  Bench bench;
  bench.script->frames(30);
  const auto app = bench.run_to_end();
  ASSERT_EQ(bench.sink.frames.size(), 30u);
  for (std::size_t i = 0; i < 30; ++i) {
    const TrackedFrame& frame = bench.sink.frames[i];
    EXPECT_EQ(frame.pose.seq, i);
    EXPECT_EQ(frame.pose.state, TrackState::ok);
    EXPECT_GE(frame.handed_over, frame.received);
    EXPECT_GT(frame.received, 0);
    EXPECT_LT(frame.pose.T_world_body.translation.norm(), 0.02);  // the camera stands still
  }
  EXPECT_EQ(all_drops(app->counters()), 0);
  EXPECT_EQ(app->counters().tracked.load(), 30);
  EXPECT_GT(bench.sink.frames.back().map.landmarks, 50);
}

TEST(App, CountsEachDroppedFrameWithItsReason) {
  Bench bench;
  FakeScript& script = *bench.script;
  script.frames(3);
  script.then(Kind::bad).frames(1, 4);             // number 3 was torn: no gap as well
  script.frames(1, 7);                             // 5 and 6 never came
  script.steps.push_back({Kind::frame, 1000, 8});  // a stamp of long ago
  script.steps.push_back({Kind::other_sensor, 2 * kNsPerSecond, 0});
  script.steps.push_back({Kind::wrong_size, 3 * kNsPerSecond, 9});
  script.steps.push_back({Kind::frame, 4 * kNsPerSecond, 10});
  const auto app = bench.run_to_end();
  const Counters& counters = app->counters();
  EXPECT_EQ(counters.dropped(DropReason::bad_frame), 2);
  EXPECT_EQ(counters.dropped(DropReason::gap), 2);
  EXPECT_EQ(counters.dropped(DropReason::late), 1);
  EXPECT_EQ(counters.dropped(DropReason::unused), 1);
  EXPECT_EQ(counters.dropped(DropReason::ring_full), 0);
  EXPECT_EQ(bench.sink.frames.size(), 6u);
  const Health& last = bench.sink.reports.back();
  EXPECT_EQ(last.frames_in, 9);
  EXPECT_EQ(last.drops[static_cast<std::size_t>(DropReason::gap)], 2);
}

TEST(App, DropsWhatADeviceDeliversFasterThanTrackingTakesItAndAccountsForAll) {
  Bench bench;
  bench.config.daemon.frame_slots = 3;
  bench.script->paced = true;
  bench.script->frames(300);
  const auto app = bench.run_to_end();
  const Counters& counters = app->counters();
  EXPECT_GT(counters.dropped(DropReason::ring_full), 0);
  EXPECT_EQ(counters.frames_in.load(), 300);
  EXPECT_EQ(counters.tracked.load() + counters.lost.load() + counters.dropped(DropReason::ring_full), 300);
  EXPECT_EQ(static_cast<std::int64_t>(bench.sink.frames.size()), counters.tracked.load() + counters.lost.load());
}

TEST(App, ReopensACameraThatFailedAndGoesOn) {
  Bench bench;
  bench.script->frames(5).then(Kind::fail).frames(5, 20);
  bench.script->refuse_opens = 3;
  const auto app = bench.run_to_end();
  EXPECT_EQ(app->counters().reopened.load(), 1);
  EXPECT_EQ(bench.script->opened.load(), 5);
  EXPECT_EQ(bench.sink.frames.size(), 10u);
  EXPECT_EQ(app->counters().dropped(DropReason::gap), 0);  // a device that was gone counts anew
}

TEST(App, SaysThatACameraIsDownWhileItIs) {
  Bench bench;
  bench.script->frames(3).then(Kind::fail);
  bench.script->refuse_opens = 1 << 20;
  auto app = bench.start();
  ASSERT_TRUE(app);
  EXPECT_TRUE(eventually([&] { return bench.script->opened > 4; }));
  (*app)->stop();
  EXPECT_EQ(bench.sink.reports.back().sensors_up, 0);
  EXPECT_EQ(bench.sink.reports.back().sensors_down, 1);
  EXPECT_TRUE(bench.sink.reports.back().tracking_alive);
}

TEST(App, DoesNotTrackWithACameraOfAnotherCalibration) {
  Bench bench;
  bench.script->frames(3).then(Kind::fail).frames(3, 10);
  bench.script->width_at_reopen = 640;
  auto app = bench.start();
  ASSERT_TRUE(app);
  EXPECT_TRUE(eventually([&] { return bench.script->opened > 3; }));
  (*app)->stop();
  EXPECT_EQ(bench.sink.frames.size(), 3u);
  EXPECT_EQ((*app)->counters().reopened.load(), 0);
}

TEST(App, DoesNotStartWithoutItsCamera) {
  Bench bench;
  bench.script->refuse_opens_from = 0;
  bench.script->refuse_opens = 1;
  const auto app = bench.start();
  ASSERT_FALSE(app);
  EXPECT_THAT(app.error().message, testing::AllOf(testing::HasSubstr("front"), testing::HasSubstr("plug it in")));
}

// A sanitizer slows the work that a stop waits for, not the stopping.
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
constexpr double kStopLimit_s = 20.0;
#else
constexpr double kStopLimit_s = 2.0;
#endif

TEST(App, StartsAndStopsFiftyTimesEachWithinTwoSeconds) {
  for (int i = 0; i < 50; ++i) {
    Bench bench;
    bench.script->repeat = true;
    bench.script->paced = true;
    bench.script->period = kNsPerMs;
    auto app = bench.start();
    ASSERT_TRUE(app);
    std::this_thread::sleep_for(std::chrono::milliseconds(i % 5));
    const TimeNs begun = monotonic_now();
    (*app)->stop();
    EXPECT_LT(to_seconds(monotonic_now() - begun), kStopLimit_s);
    EXPECT_EQ(bench.script->opened.load(), bench.script->closed.load());
    EXPECT_EQ(static_cast<std::int64_t>(bench.sink.frames.size()),
              (*app)->counters().tracked.load() + (*app)->counters().lost.load());
  }
}

TEST(App, ReportsAChangeOfStateAtOnceAndTheLastCountsAtTheEnd) {
  Bench bench;
  bench.config.daemon.health_period_s = 5.0;
  bench.script->frames(20);
  bench.run_to_end();
  ASSERT_GE(bench.sink.reports.size(), 2u);
  EXPECT_EQ(bench.sink.reports.front().state, TrackState::ok);
  EXPECT_EQ(bench.sink.reports.back().frames_tracked, 20);
  EXPECT_GT(bench.sink.reports.back().memory_rss_mb, 1.0);
}

TEST(App, StartsWhereItIsTold) {
  Bench bench;
  bench.config.start.translation_m = {1.0, 2.0, 3.0};
  bench.script->frames(1);
  bench.run_to_end();
  EXPECT_LT((bench.sink.frames.at(0).pose.T_world_body.translation - Eigen::Vector3d(1, 2, 3)).norm(), 1e-9);
  const Rigid3 T = bench.sink.frames.at(0).pose.T_world_camera;
  EXPECT_LT(rotation_angle_rad(T.inverse() * level_forward_camera()), 1e-9);
}

// 60 frames, one every 33 ms of their stamps, each with its labels.
void add_labelled_frames(FakeScript& script) {
  script.has_labels = true;
  script.frames(60);
  for (std::size_t i = 0; i < 60; ++i) {
    const FakeStep frame = script.steps[2 * i];
    script.steps.insert(script.steps.begin() + static_cast<std::ptrdiff_t>(2 * i + 1), {Kind::labels, frame.stamp, 0});
  }
  script.period = 4 * kNsPerMs;
}

TEST(App, UnderstandsSomeFramesBesideTrackingAll) {
  Bench bench;
  add_labelled_frames(*bench.script);
  const auto app = bench.run_to_end();
  const Health& health = bench.sink.reports.back();
  EXPECT_EQ(bench.sink.frames.size(), 60u);
  EXPECT_EQ(health.frames_in, 60) << "labels are no frames";
  EXPECT_EQ(all_drops(app->counters()), 0);
  const UnderstandingHealth& understanding = health.understanding;
  EXPECT_EQ(understanding.views + understanding.views_dropped, 10) << "one each 0.2 s";
  EXPECT_GT(understanding.views, 0);
  EXPECT_EQ(understanding.news.views_understood, understanding.views);
  EXPECT_EQ(understanding.news.labels.received + understanding.labels_dropped, 60);
  EXPECT_GT(understanding.news.labels.joined, 0);
  EXPECT_GT(bench.sink.lists, 0);
}

TEST(App, LeavesLabelsUnusedWhenItSegmentsByGeometryAndAllWhenUnderstandingIsOff) {
  for (const std::string labels : {"geometric", "off"}) {
    Bench bench;
    bench.config.pipeline.understanding.labels = labels;
    add_labelled_frames(*bench.script);
    const auto app = bench.run_to_end();
    EXPECT_EQ(app->counters().dropped(DropReason::unused), 60) << labels;
    EXPECT_EQ(bench.sink.frames.size(), 60u);
    EXPECT_EQ(bench.sink.reports.back().understanding.views > 0, labels != "off");
    EXPECT_EQ(bench.sink.lists > 0, labels != "off");
  }
}

TEST(App, SaysWhereLabelsShouldComeFrom) {
  Bench bench;
  bench.config.pipeline.understanding.labels = "replay";
  bench.script->frames(1);
  const auto app = bench.start();
  ASSERT_FALSE(app);
  EXPECT_THAT(app.error().message,
              testing::AllOf(testing::HasSubstr("understanding.labels"), testing::HasSubstr("delivers no labels")));
}

TEST(App, KeepsItsMapWhereItIsTold) {
  const TempFolder folder;
  Bench bench;
  bench.map_store = folder.path() / "map.db";
  bench.script->frames(10);
  bench.run_to_end();
  EXPECT_EQ(bench.sink.reports.back().store.state, StoreState::ok);
  EXPECT_EQ(overall_state(bench.sink.reports.back()), TrackState::ok);
  auto store = MapStore::open(bench.map_store, StoreMode::read_write);  // nobody holds it any more
  ASSERT_TRUE(store) << store.error().message;
  EXPECT_TRUE(store->load());
}

// A simulated drive of two seconds in real time, on the map of the store.
std::vector<TrackedFrame> drive_on(const std::filesystem::path& map_store) {
  CollectingSink sink;
  std::atomic<bool> ended{false};
  AppOptions options;
  options.driver = std::move(*make_driver(
      "synthetic",
      {{"scene", "static"}, {"seed", "3"}, {"width", "320"}, {"height", "240"}, {"fps", "30"}, {"frames", "60"}}));
  options.sinks = {&sink};
  options.map_store = map_store;
  options.on_end = [&ended] {
    ended = true;
    ended.notify_all();
  };
  auto app = App::start(*parse_config("[[sensor]]\ndriver = \"synthetic\"\n", "test", {}), std::move(options));
  EXPECT_TRUE(app) << app.error().message;
  ended.wait(false);
  (*app)->stop();
  return sink.frames;
}

TEST(App, FindsItselfOnTheMapItStored) {
  const TempFolder folder;
  const auto first = drive_on(folder.path() / "map.db"), second = drive_on(folder.path() / "map.db");
  ASSERT_FALSE(first.empty() || second.empty());
  EXPECT_EQ(first.front().pose.state, TrackState::ok);
  EXPECT_EQ(second.front().pose.state, TrackState::lost);
  EXPECT_EQ(second.back().pose.state, TrackState::ok);
  EXPECT_GT(second.back().map.keyframes, 0);
  std::map<std::uint64_t, Rigid3> places;
  for (const TrackedFrame& frame : first) places[frame.pose.seq] = frame.pose.T_world_body;
  int compared = 0;
  for (const TrackedFrame& frame : second) {
    const auto before = places.find(frame.pose.seq);
    if (frame.pose.state != TrackState::ok || before == places.end()) continue;
    EXPECT_LT((frame.pose.T_world_body.translation - before->second.translation).norm(), 0.03);
    ++compared;
  }
  EXPECT_GT(compared, 0);
}

TEST(App, BeginsEmptyAndDegradedWhenTheMapIsDamaged) {
  const TempFolder folder;
  const LogText log;
  Bench bench;
  bench.map_store = folder.path() / "map.db";
  std::ofstream(bench.map_store) << "no map";
  bench.script->frames(10);
  bench.run_to_end();
  const Health& health = bench.sink.reports.back();
  EXPECT_EQ(health.store.state, StoreState::began_empty);
  EXPECT_EQ(health.state, TrackState::ok);
  EXPECT_EQ(overall_state(health), TrackState::degraded);
  EXPECT_EQ(bench.sink.frames.size(), 10u);
  EXPECT_THAT(log.text(), testing::HasSubstr("map store damaged"));
}

TEST(App, DoesNotStartOnAMapThatAnotherProcessUses) {
  const TempFolder folder;
  Bench bench;
  bench.map_store = folder.path() / "map.db";
  const auto other = MapStore::open(bench.map_store, StoreMode::read_write);
  ASSERT_TRUE(other);
  const auto app = bench.start();
  ASSERT_FALSE(app);
  EXPECT_THAT(app.error().message, testing::HasSubstr("map.store: " + bench.map_store.string()));
  EXPECT_EQ(bench.script->opened.load(), 0) << "the camera is left alone";
}

TEST(Mount, IsTheConfigurationsElseTheDriversElseLevelAndForward) {
  SensorConfig config;
  SensorCalibration calibration;
  EXPECT_LT(rotation_angle_rad(mount_of(config, calibration).inverse() * level_forward_camera()), 1e-12);
  calibration.T_body_sensor.translation.z() = 0.7;
  EXPECT_EQ(mount_of(config, calibration).translation.z(), 0.7);
  config.has_mount = true;
  config.translation_m = {0.0, 0.0, 0.3};
  EXPECT_EQ(mount_of(config, calibration).translation.z(), 0.3);
}

std::atomic<bool> hold_tracking{false};

TEST(TrackingThread, LooksDeadOnlyWhenItHangsOnAFrame) {
  Bench bench;
  Pipeline pipeline(bench.config.pipeline, FakeDriver(bench.script).open()->sensors[0], Rigid3{});
  FrameExchange frames(3);
  PoseRing poses(16);
  JobRing asked(8), solved(8);
  Counters counters;
  hold_tracking = true;
  TrackingThread tracking(pipeline, {frames, poses, asked, solved}, counters,
                          {.frame_taken = [] { hold_tracking.wait(true); }});
  std::this_thread::sleep_for(std::chrono::milliseconds(30));
  EXPECT_TRUE(tracking.alive(kNsPerMs));  // a silent camera
  bench.script->frames(1);
  FakeDriver(bench.script).next(frames.draft());
  ASSERT_TRUE(frames.try_submit());
  EXPECT_TRUE(eventually([&] { return !tracking.alive(20 * kNsPerMs); }));
  hold_tracking = false;
  hold_tracking.notify_all();
  EXPECT_TRUE(eventually([&] { return tracking.alive(20 * kNsPerMs); }));
}

TEST(FrameExchange, KeepsTheDraftWhenTrackingIsBehind) {
  FrameExchange frames(2);
  frames.draft().rgbd.seq = 1;
  EXPECT_TRUE(frames.try_submit());
  frames.draft().rgbd.seq = 2;
  EXPECT_FALSE(frames.try_submit());
  EXPECT_EQ(frames.draft().rgbd.seq, 2u);
  EXPECT_TRUE(frames.waiting());
  EXPECT_EQ(frames.take()->rgbd.seq, 1u);
  frames.give_back();
  EXPECT_TRUE(frames.try_submit());
  frames.close();
  EXPECT_EQ(frames.take()->rgbd.seq, 2u);
  EXPECT_EQ(frames.take(), nullptr);
}

}  // namespace
}  // namespace povslam
