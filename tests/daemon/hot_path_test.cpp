// From taking a frame to handing its pose over, keyframes included, the tracking thread neither allocates nor locks
// once it is warm: counted at malloc, mmap and mutexes, libraries included.
#include <gtest/gtest.h>

#include <atomic>
#include <cstdlib>

#include "daemon/app.hpp"
#include "daemon/config_file.hpp"
#include "drivers/registry.hpp"
#include "tests/support/alloc_counter.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

constexpr int kWarmFrames = 60;
constexpr int kFrames = 180;

struct Tally {
  int frames = 0;
  int guilty_frames = 0;
  std::uint64_t allocations_while_warming = 0;
  CallCounts counts;
};
Tally tally;  // tracking thread; read after it ended

void frame_taken() {
  start_counting();
}

void pose_handed_over() {
  if (tally.frames == 0) {  // one call of ours shows that the counter sees this thread
    void* volatile memory = std::malloc(1);
    std::free(memory);
  }
  const CallCounts counts = stop_counting();
  if (++tally.frames <= kWarmFrames) {
    tally.allocations_while_warming += counts.allocations;
    return;
  }
  tally.guilty_frames += counts.allocations + counts.maps + counts.locks > 0 ? 1 : 0;
  tally.counts.allocations += counts.allocations;
  tally.counts.maps += counts.maps;
  tally.counts.locks += counts.locks;
}

class KeyframeCounter : public Sink {
 public:
  void on_frame(const TrackedFrame& frame) override {
    if (++frames_ > kWarmFrames && frame.pose.keyframe) ++keyframes;
  }
  int keyframes = 0;

 private:
  int frames_ = 0;
};

TEST(HotPath, NeitherAllocatesNorLocksOnceWarm) {
  if (!counting_works()) GTEST_SKIP() << "sanitizers interpose the heap themselves";
  const auto config = load_config("", {});
  ASSERT_TRUE(config);
  auto driver = make_driver(
      "synthetic", {{"scene", "aisle"}, {"realtime", "false"}, {"fps", "8"}, {"frames", std::to_string(kFrames)}});
  ASSERT_TRUE(driver) << driver.error().message;
  KeyframeCounter sink;
  std::atomic<bool> ended{false};
  const TempFolder folder;
  AppOptions options;
  options.driver = std::move(*driver);
  options.sinks = {&sink};
  options.on_end = [&ended] {
    ended = true;
    ended.notify_all();
  };
  options.probe = {frame_taken, pose_handed_over};
  options.map_store = folder.path() / "map.db";
  auto app = App::start(*config, std::move(options));
  ASSERT_TRUE(app) << app.error().message;
  ended.wait(false);
  (*app)->stop();

  EXPECT_EQ(tally.frames, kFrames);
  EXPECT_GT(sink.keyframes, 5);
  EXPECT_GT((*app)->counters().backend.runs.load(), 2);
  EXPECT_GT(tally.allocations_while_warming, 0u) << "the counter does not see the tracking thread";
  EXPECT_EQ(tally.counts.allocations, 0u) << "in " << tally.guilty_frames << " frames";
  EXPECT_EQ(tally.counts.maps, 0u);
  EXPECT_EQ(tally.counts.locks, 0u);
}

}  // namespace
}  // namespace povslam
