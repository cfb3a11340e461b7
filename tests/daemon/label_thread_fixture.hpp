// A running label thread with images of a few pixels, for tests.
#pragma once

#include <gtest/gtest.h>

#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <thread>

#include "daemon/label_thread.hpp"
#include "tests/support/label_peer.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {

inline constexpr int kWidth = 16, kHeight = 12;
inline constexpr std::size_t kPixels = std::size_t{kWidth} * kHeight;

inline bool soon(const std::function<bool()>& happens) {
  for (int i = 0; i < 400; ++i) {
    if (happens()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

inline RgbdFrame image_at(TimeNs stamp, std::uint8_t value = 200) {
  RgbdFrame image;
  image.stamp = stamp;
  image.color.resize(kWidth, kHeight, 3);
  image.color.fill(value);
  image.depth.resize(kWidth, kHeight);
  image.depth.fill(1500);
  return image;
}

class LabelThreadFixture : public testing::Test {
 protected:
  void SetUp() override {
    options_.path = (folder_.path() / "labels.sock").string();
    options_.client.table = "coco";
    options_.client.limits = {kWidth, kHeight};
    options_.pause = 10 * kNsPerMs;
  }
  void start() {
    auto started = LabelThread::start(options_, ring_, counters_);
    ASSERT_TRUE(started) << started.error().message;
    thread_ = std::move(*started);
  }
  // The thread still serves: a well-behaved source is heard.
  void expect_alive() {
    std::optional<LabelPeer> peer;
    ASSERT_TRUE(soon([&] {
      peer.emplace(options_.path);
      peer->say(LabelPeer::hello("coco"));
      const auto answer = peer->hear();
      return answer && answer->type == LabelMessage::welcome;
    }));
    while (ring_.try_pop()) {
    }
    thread_->offer(image_at(777));
    peer->say(LabelPeer::next());
    ASSERT_TRUE(peer->hear());
    peer->say(LabelPeer::labels(777, kWidth, kHeight, 1, kPixels));
    std::optional<LabelFrame> labels;
    ASSERT_TRUE(soon([&] { return (labels = ring_.try_pop()).has_value(); }));
    EXPECT_EQ(labels->stamp, 777);
  }

  TempFolder folder_;
  LabelSocketOptions options_;
  LabelRing ring_{4};
  LabelSourceCounters counters_;
  std::unique_ptr<LabelThread> thread_;
};

}  // namespace povslam
