#include "daemon/label_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cstdio>
#include <filesystem>

#include "tests/daemon/label_thread_fixture.hpp"

namespace povslam {
namespace {

using LabelThreadTest = LabelThreadFixture;

TEST_F(LabelThreadTest, SendsTheNewestImageWhenAskedAndHandsItsLabelsOn) {
  start();
  LabelPeer peer(options_.path);
  ASSERT_TRUE(peer.say(LabelPeer::hello("coco", 1)));
  const auto welcome = peer.hear();
  ASSERT_TRUE(welcome);
  EXPECT_EQ(welcome->type, LabelMessage::welcome);
  EXPECT_EQ(welcome->content, (LabelPeer::Bytes{kWidth, 0, 0, 0, kHeight, 0, 0, 0}));
  thread_->offer(image_at(1));
  thread_->offer(image_at(2));
  thread_->offer(image_at(3, 99));
  peer.say(LabelPeer::next());
  const auto image = peer.hear();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->type, LabelMessage::image);
  ASSERT_EQ(image->content.size(), kLabelHeadBytes + kPixels * 3 + kPixels * 2);
  EXPECT_EQ(image->content[0], 3) << "older images are not sent any more";
  EXPECT_EQ(image->content[kLabelHeadBytes], 99);
  EXPECT_EQ(image->content.back(), 1500 >> 8);
  peer.say(LabelPeer::labels(3, kWidth / 2, kHeight / 2, 2, kPixels / 4 * 3, 5));
  std::optional<LabelFrame> labels;
  ASSERT_TRUE(soon([&] { return (labels = ring_.try_pop()).has_value(); }));
  EXPECT_EQ(labels->stamp, 3);
  EXPECT_EQ(labels->table_name, "coco");
  EXPECT_EQ(labels->classes.at(kWidth / 2 - 1, kHeight / 2 - 1), 5);
  EXPECT_EQ(labels->instances.at(0, 0), 0x0505);
  EXPECT_EQ(counters_.images, 1);
  EXPECT_EQ(counters_.labels, 1);
  EXPECT_TRUE(counters_.connected);
}

TEST_F(LabelThreadTest, AnswersAQuestionThatCameBeforeTheImage) {
  start();
  LabelPeer peer(options_.path);
  peer.say(LabelPeer::hello("coco"));
  peer.say(LabelPeer::next());
  ASSERT_TRUE(peer.hear());
  thread_->offer(image_at(8));
  const auto image = peer.hear();
  ASSERT_TRUE(image);
  EXPECT_EQ(image->content.size(), kLabelHeadBytes + kPixels * 3) << "depth was not asked for";
}

TEST_F(LabelThreadTest, ListensAgainWhenTheSourceIsGone) {
  start();
  for (int i = 0; i < 3; ++i) expect_alive();
  EXPECT_EQ(counters_.clients, 3);
  EXPECT_TRUE(soon([&] { return !counters_.connected; }));
}

TEST_F(LabelThreadTest, DropsLabelsThatNobodyTakes) {
  start();
  LabelPeer peer(options_.path);
  peer.say(LabelPeer::hello("coco"));
  ASSERT_TRUE(peer.hear());
  for (int stamp = 1; stamp <= 7; ++stamp) {
    thread_->offer(image_at(stamp));
    peer.say(LabelPeer::next());
    ASSERT_TRUE(peer.hear());
    peer.say(LabelPeer::labels(stamp, kWidth, kHeight, 1, kPixels));
  }
  EXPECT_TRUE(soon([&] { return counters_.labels + counters_.dropped == 7; }));
  EXPECT_EQ(counters_.labels, 4);
}

TEST_F(LabelThreadTest, FlagsASourceThatLeavesImagesUnanswered) {
  options_.silence = 100 * kNsPerMs;
  start();
  std::this_thread::sleep_for(std::chrono::milliseconds(250));
  EXPECT_FALSE(counters_.silent) << "no image, no silence";
  thread_->offer(image_at(1));
  EXPECT_TRUE(soon([&] { return counters_.silent.load(); }));
  expect_alive();
  EXPECT_TRUE(soon([&] { return !counters_.silent; }));
}

TEST_F(LabelThreadTest, StopsAtOnceWhateverTheSourceDoes) {
  start();
  LabelPeer peer(options_.path);
  peer.say(LabelPeer::hello("coco"));
  peer.say({'P'});
  const TimeNs before = monotonic_now();
  thread_.reset();
  EXPECT_LT(monotonic_now() - before, kNsPerSecond);
  EXPECT_FALSE(std::filesystem::exists(options_.path));
}

TEST_F(LabelThreadTest, ServesTheReferenceSourceInPython) {
  start();
  const std::string command = std::string(POVSLAM_SOURCE_DIR "/tools/experiments/label_client ") + options_.path +
                              " --table coco --class-id 57 --count 2 --depth 2>&1";
  FILE* source = ::popen(command.c_str(), "r");
  ASSERT_NE(source, nullptr);
  for (int stamp = 1; stamp <= 2; ++stamp) {
    thread_->offer(image_at(stamp, stamp == 1 ? 200 : 20));
    std::optional<LabelFrame> labels;
    ASSERT_TRUE(soon([&] { return (labels = ring_.try_pop()).has_value(); }));
    EXPECT_EQ(labels->stamp, stamp);
    EXPECT_EQ(labels->classes.width(), kWidth / 2);
    EXPECT_EQ(labels->classes.at(3, 3), stamp == 1 ? 57 : 0);
  }
  char line[200] = {};
  ASSERT_NE(std::fgets(line, sizeof line, source), nullptr);
  EXPECT_STREQ(line, "1 16x12 depth=384\n");
  while (std::fgets(line, sizeof line, source) != nullptr) {
  }
  EXPECT_EQ(::pclose(source), 0);
}

}  // namespace
}  // namespace povslam
