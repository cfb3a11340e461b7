#include "daemon/label_lcm.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <chrono>
#include <functional>
#include <lcm/lcm-cpp.hpp>
#include <opencv2/imgcodecs.hpp>
#include <povslam/label_image_t.hpp>
#include <random>

#include "daemon/label_lcm_message.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::HasSubstr;

constexpr LabelLimits kLimits{64, 48};

std::vector<std::uint8_t> png(const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(".png", image, bytes));
  return bytes;
}

label_image_t message_at(std::int64_t utime, int width = 64, int height = 48) {
  label_image_t message;
  message.utime = utime;
  message.seq = 3;
  message.robot_id = "r2";
  message.table = "coco";
  message.width = width;
  message.height = height;
  message.classes_png = png(cv::Mat(height, width, CV_8UC1, cv::Scalar(57)));
  message.num_class_bytes = static_cast<std::int32_t>(message.classes_png.size());
  message.instances_png = png(cv::Mat(height, width, CV_16UC1, cv::Scalar(1234)));
  message.num_instance_bytes = static_cast<std::int32_t>(message.instances_png.size());
  return message;
}

std::vector<std::uint8_t> bytes_of(const label_image_t& message) {
  std::vector<std::uint8_t> bytes(static_cast<std::size_t>(message.getEncodedSize()));
  EXPECT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), static_cast<int>(bytes.size()));
  return bytes;
}

std::string complaint(const label_image_t& message) {
  const auto read = read_label_image(bytes_of(message), kLimits);
  return read ? "accepted" : read.error().message;
}

TEST(LabelImage, IsReadAsItWasSent) {
  const auto read = read_label_image(bytes_of(message_at(12'345'678)), kLimits);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_EQ(read->robot_id, "r2");
  EXPECT_EQ(read->labels.table_name, "coco");
  EXPECT_EQ(read->labels.stamp, 12'345'678'000);
  ASSERT_EQ(read->labels.classes.width(), 64);
  ASSERT_EQ(read->labels.instances.height(), 48);
  EXPECT_EQ(read->labels.classes.at(63, 47), 57);
  EXPECT_EQ(read->labels.instances.at(63, 47), 1234);
}

TEST(LabelImage, MayBeSmallerThanTheImageAndWithoutInstances) {
  label_image_t message = message_at(1, 32, 24);
  message.num_instance_bytes = 0;
  message.instances_png.clear();
  const auto read = read_label_image(bytes_of(message), kLimits);
  ASSERT_TRUE(read) << read.error().message;
  EXPECT_TRUE(read->labels.instances.empty());
}

TEST(LabelImage, SaysWhatIsWrong) {
  EXPECT_THAT(complaint(message_at(1, 65, 48)), HasSubstr("65 x 48 px; the image has 64 x 48"));
  label_image_t message = message_at(1);
  message.width = 63;
  EXPECT_THAT(complaint(message), HasSubstr("classes_png: expected a grey PNG of 8 bits and 63 x 48"));
  message = message_at(1);
  message.classes_png = message.instances_png;
  message.num_class_bytes = message.num_instance_bytes;
  EXPECT_THAT(complaint(message), HasSubstr("8 bits"));
  message.classes_png = png(cv::Mat(48, 64, CV_8UC3, cv::Scalar::all(5)));
  message.num_class_bytes = static_cast<std::int32_t>(message.classes_png.size());
  EXPECT_THAT(complaint(message), HasSubstr("grey PNG"));
  message.num_class_bytes = 0;
  EXPECT_THAT(complaint(message), HasSubstr("classes_png: the file is empty"));
  message = message_at(std::numeric_limits<std::int64_t>::max());
  EXPECT_THAT(complaint(message), HasSubstr("utime"));
  std::vector<std::uint8_t> other = bytes_of(message_at(1));
  other[3] ^= 1U;
  EXPECT_THAT(read_label_image(other, kLimits).error().message, HasSubstr("another type"));
}

TEST(LabelImage, BelievesNoLength) {
  const std::vector<std::uint8_t> whole = bytes_of(message_at(1));
  constexpr std::size_t kRobotId = 8 + 16, kTable = kRobotId + 4 + 3, kNumClasses = kTable + 4 + 5 + 8;
  for (const std::size_t at : {kRobotId, kTable, kNumClasses}) {
    for (const std::uint32_t length : {0U, 0x7FFFFFFFU, 0x80000000U, 0xFFFFFFFFU, 0x00FFFFFFU}) {
      if (at == kNumClasses && length == 0U) continue;
      std::vector<std::uint8_t> bytes = whole;
      for (std::size_t i = 0; i < 4; ++i) bytes[at + i] = static_cast<std::uint8_t>(length >> (24 - 8 * i));
      const auto read = read_label_image(bytes, kLimits);
      ASSERT_FALSE(read) << at << " " << length;
      EXPECT_THAT(read.error().message, HasSubstr("lengths contradict"));
    }
  }
  for (std::size_t size = 0; size < whole.size(); ++size) {
    ASSERT_FALSE(read_label_image(std::span(whole).first(size), kLimits)) << size;
  }
}

TEST(LabelImage, SurvivesAnyDamage) {
  const std::vector<std::uint8_t> whole = bytes_of(message_at(1));
  std::mt19937 random(5);
  for (int round = 0; round < 5000; ++round) {
    std::vector<std::uint8_t> bytes = whole;
    for (int i = 0; i < 1 + round % 8; ++i) bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
    bytes.resize(round % 4 == 0 ? random() % bytes.size() : bytes.size());
    const auto read = read_label_image(bytes, kLimits);
    if (read) {
      EXPECT_LE(read->labels.classes.width(), 64);
    }
  }
}

bool soon(const std::function<bool()>& happens) {
  for (int i = 0; i < 400; ++i) {
    if (happens()) return true;
    std::this_thread::sleep_for(std::chrono::milliseconds(10));
  }
  return false;
}

class LcmLabelThreadTest : public testing::Test {
 protected:
  // LCM plays the messages of a log file to the thread.
  void record(const std::string& channel, std::vector<std::uint8_t> bytes) {
    lcm::LogEvent event;
    event.channel = channel;
    event.timestamp = ++events_;
    event.data = bytes.data();
    event.datalen = static_cast<std::int32_t>(bytes.size());
    if (!log_) log_.emplace(file_, "w");
    log_->writeEvent(&event);
  }
  void record(const label_image_t& message) { record("LABELS", bytes_of(message)); }
  void play() {
    log_.reset();
    auto started = LcmLabelThread::start(
        {"file://" + file_ + "?speed=0", "LABELS", "r2", "coco", kLimits, max_messages_per_s_, silence_}, ring_,
        counters_);
    ASSERT_TRUE(started) << started.error().message;
    thread_ = std::move(*started);
  }

  TempFolder folder_;
  std::string file_ = (folder_.path() / "labels.lcm").string();
  std::optional<lcm::LogFile> log_;
  std::int64_t events_ = 0;
  int max_messages_per_s_ = 30;
  TimeNs silence_ = kLabelSilence;
  LabelRing ring_{4};
  LabelSourceCounters counters_;
  std::unique_ptr<LcmLabelThread> thread_;
};

TEST_F(LcmLabelThreadTest, HandsOnWhatIsMeantForThisRobotAndTable) {
  record(message_at(1));
  record("OTHER", bytes_of(message_at(2)));
  label_image_t message = message_at(3);
  message.robot_id = "r3";
  record(message);
  message = message_at(4);
  message.table = "torwic";
  record(message);
  record("LABELS", {1, 2, 3});
  record(message_at(5));
  play();
  ASSERT_TRUE(soon([&] { return counters_.labels == 2; }));
  EXPECT_EQ(counters_.bad, 2) << "a message for another robot is not bad";
  EXPECT_EQ(ring_.try_pop()->stamp, 1 * kNsPerUs);
  const auto second = ring_.try_pop();
  EXPECT_EQ(second->stamp, 5 * kNsPerUs);
  EXPECT_EQ(second->table_name, "coco");
  EXPECT_GT(second->produced, 0);
}

TEST_F(LcmLabelThreadTest, DropsAFloodBeforeDecodingIt) {
  max_messages_per_s_ = 6;
  for (int i = 1; i <= 50; ++i) record(message_at(i));
  play();
  ASSERT_TRUE(soon([&] { return counters_.labels + counters_.dropped == 50; }));
  EXPECT_EQ(counters_.labels, 4) << "what the ring holds";
}

TEST_F(LcmLabelThreadTest, FlagsSilence) {
  silence_ = 100 * kNsPerMs;
  record(message_at(1));
  play();
  ASSERT_TRUE(soon([&] { return counters_.labels == 1; }));
  EXPECT_FALSE(counters_.silent);
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_FALSE(counters_.silent) << "no image, no silence";
  counters_.offered.fetch_add(1);
  EXPECT_TRUE(soon([&] { return counters_.silent.load(); }));
}

TEST(LcmLabelThread, SaysWhatToSetWhenItCannotListen) {
  LabelRing ring(1);
  LabelSourceCounters counters;
  EXPECT_THAT(LcmLabelThread::start({"", "L", "r", "coco", kLimits}, ring, counters).error().message,
              HasSubstr("lcm.url"));
  EXPECT_THAT(LcmLabelThread::start({"nosuch://", "L", "r", "coco", kLimits}, ring, counters).error().message,
              HasSubstr("nosuch://"));
}

}  // namespace
}  // namespace povslam
