// What a label source can do wrong, by mistake or on purpose.
#include "daemon/label_socket.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <filesystem>
#include <fstream>
#include <random>

#include "tests/daemon/label_thread_fixture.hpp"

namespace povslam {
namespace {

using testing::HasSubstr;
using LabelSocketTest = LabelThreadFixture;

TEST_F(LabelSocketTest, TellsASecondSourceThatThereIsOne) {
  start();
  LabelPeer first(options_.path);
  first.say(LabelPeer::hello("coco"));
  ASSERT_TRUE(first.hear());
  LabelPeer second(options_.path);
  const auto answer = second.hear();
  ASSERT_TRUE(answer);
  EXPECT_EQ(answer->type, LabelMessage::refused);
  EXPECT_THAT(answer->text(), HasSubstr("another label source"));
  thread_->offer(image_at(1));
  first.say(LabelPeer::next());
  EXPECT_TRUE(first.hear()) << "the first one is served on";
}

TEST_F(LabelSocketTest, SaysWhyItRefusesAndHangsUp) {
  options_.client.max_messages_per_s = 20;
  start();
  using Bytes = LabelPeer::Bytes;
  const auto after_hello = [](Bytes more) {
    Bytes bytes = LabelPeer::hello("coco");
    bytes.insert(bytes.end(), more.begin(), more.end());
    return bytes;
  };
  Bytes flood;
  for (int i = 0; i < 30; ++i) {
    const Bytes next = LabelPeer::next();
    flood.insert(flood.end(), next.begin(), next.end());
  }
  Bytes huge = LabelPeer::labels(1, kWidth, kHeight, 1, 0), future = LabelPeer::next();
  for (int i = 8; i < 12; ++i) huge[static_cast<std::size_t>(i)] = 0xFF;
  future[4] = 9;
  const std::vector<std::pair<Bytes, std::string>> cases = {
      {Bytes(64, 'x'), "does not begin with PVLB"},
      {LabelPeer::hello("torwic"), "this daemon reads \"coco\""},
      {LabelPeer::hello(""), "hello: expected flags"},
      {LabelPeer::hello("coco", 6), "unknown flags"},
      {LabelPeer::hello("co\nco"), "no plain text"},
      {LabelPeer::hello(std::string(65, 'c')), "at most 68 are allowed"},
      {LabelPeer::next(), "first message must be hello"},
      {future, "protocol version 9"},
      {LabelPeer::message(LabelMessage::image, {}), "message type 5"},
      {after_hello(LabelPeer::hello("coco")), "said already"},
      {after_hello(huge), "with 4294967295 bytes"},
      {after_hello(LabelPeer::message(LabelMessage::labels, Bytes(23, 0))), "ends inside its head"},
      {after_hello(LabelPeer::labels(1, 1U << 31U, 1U << 31U, 1, 0)), "the image has 16 x 12"},
      {after_hello(LabelPeer::labels(1, 0, kHeight, 1, 0)), "0 x 12 px"},
      {after_hello(LabelPeer::labels(1, kWidth, kHeight, 3, kPixels)), "format must be 1"},
      {after_hello(LabelPeer::labels(1, kWidth, kHeight, 2, kPixels)), "size and format make"},
      {after_hello(flood), "more than 20 messages a second"},
  };
  for (const auto& [bytes, reason] : cases) {
    LabelPeer peer(options_.path);
    peer.say(bytes);
    auto answer = peer.hear();
    if (answer && answer->type == LabelMessage::welcome) answer = peer.hear();
    ASSERT_TRUE(answer) << reason;
    EXPECT_EQ(answer->type, LabelMessage::refused);
    EXPECT_THAT(answer->text(), HasSubstr(reason));
    EXPECT_TRUE(peer.hung_up_on()) << reason;
  }
  EXPECT_EQ(counters_.bad, static_cast<std::int64_t>(cases.size()));
  expect_alive();
}

TEST_F(LabelSocketTest, CountsLabelsOfImagesThatWereNotSentAndTakesEachAnswerOnce) {
  start();
  LabelPeer peer(options_.path);
  peer.say(LabelPeer::hello("coco"));
  ASSERT_TRUE(peer.hear());
  thread_->offer(image_at(5));
  peer.say(LabelPeer::next());
  ASSERT_TRUE(peer.hear());
  for (const std::int64_t stamp : {4, 5, 5}) peer.say(LabelPeer::labels(stamp, kWidth, kHeight, 1, kPixels));
  EXPECT_TRUE(soon([&] { return counters_.bad == 2; }));
  EXPECT_EQ(counters_.labels, 1);
}

TEST_F(LabelSocketTest, GivesUpOnSourcesThatDoNotGoOn) {
  options_.client.hello_timeout = options_.client.message_timeout = 100 * kNsPerMs;
  options_.client.idle_timeout = 300 * kNsPerMs;
  start();
  LabelPeer silent(options_.path);
  EXPECT_THAT(silent.hear()->text(), HasSubstr("no hello"));
  expect_alive();
  LabelPeer half(options_.path);
  half.say(LabelPeer::hello("coco"));
  half.say({'P', 'V', 'L'});
  ASSERT_EQ(half.hear()->type, LabelMessage::welcome);
  EXPECT_THAT(half.hear()->text(), HasSubstr("not finished"));
  expect_alive();
  LabelPeer idle(options_.path);
  idle.say(LabelPeer::hello("coco"));
  ASSERT_EQ(idle.hear()->type, LabelMessage::welcome);
  EXPECT_THAT(idle.hear()->text(), HasSubstr("no message within"));
  expect_alive();
}

TEST_F(LabelSocketTest, WaitsForeverForImagesButNotForASourceThatDoesNotTakeThem) {
  options_.client.limits = {2048, 1536};
  options_.client.message_timeout = 100 * kNsPerMs;
  options_.client.idle_timeout = 100 * kNsPerMs;
  start();
  LabelPeer peer(options_.path);
  peer.say(LabelPeer::hello("coco"));
  peer.say(LabelPeer::next());
  ASSERT_EQ(peer.hear()->type, LabelMessage::welcome);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_TRUE(counters_.connected);
  RgbdFrame large;
  large.stamp = 1;
  large.color.resize(2048, 1536, 3);
  large.color.fill(7);
  thread_->offer(large);  // more than the socket's buffers hold
  EXPECT_TRUE(soon([&] { return !counters_.connected; }));
}

TEST_F(LabelSocketTest, SurvivesRandomBytesTruncationsAndDisconnects) {
  options_.pause = 0;
  start();
  std::mt19937 random(3);
  const auto below = [&random](std::size_t end) {
    return std::uniform_int_distribution<std::size_t>(0, end - 1)(random);
  };
  for (int round = 0; round < 300; ++round) {
    LabelPeer peer(options_.path);
    LabelPeer::Bytes bytes = LabelPeer::hello("coco");
    for (const LabelPeer::Bytes& more :
         {LabelPeer::next(), LabelPeer::labels(777, kWidth, kHeight, 2, 3 * kPixels), LabelPeer::next()}) {
      bytes.insert(bytes.end(), more.begin(), more.end());
    }
    if (round % 3 == 0) {
      for (std::uint8_t& byte : bytes) byte = static_cast<std::uint8_t>(below(256));
    }
    for (std::size_t i = below(8); i > 0; --i) bytes[below(bytes.size())] = static_cast<std::uint8_t>(below(256));
    bytes.resize(below(bytes.size()) + 1);
    if (round % 10 == 0) thread_->offer(image_at(777));
    peer.say(bytes);
  }
  expect_alive();
}

TEST_F(LabelSocketTest, TakesOverASocketLeftBehindAndNothingElse) {
  start();
  const auto second = LabelThread::start(options_, ring_, counters_);
  ASSERT_FALSE(second);
  EXPECT_THAT(second.error().message, HasSubstr("in use by another program"));
  struct stat status {};
  ASSERT_EQ(::stat(options_.path.c_str(), &status), 0);
  EXPECT_EQ(status.st_mode & 0777U, 0660U);
  const std::string left = (folder_.path() / "left.sock").string();
  std::filesystem::create_hard_link(options_.path, left);
  thread_.reset();  // nobody listens at the other name of the socket any more
  options_.path = left;
  start();
  expect_alive();
  thread_.reset();
  std::ofstream(options_.path) << "a file";
  EXPECT_FALSE(LabelThread::start(options_, ring_, counters_));
  EXPECT_TRUE(std::filesystem::exists(options_.path)) << "files of others are left alone";
  options_.path = "/nowhere/labels.sock";
  EXPECT_THAT(LabelThread::start(options_, ring_, counters_).error().message, HasSubstr("folder must exist"));
  options_.path = std::string(108, 'a');
  EXPECT_THAT(LabelThread::start(options_, ring_, counters_).error().message, HasSubstr("labels.socket"));
}

}  // namespace
}  // namespace povslam
