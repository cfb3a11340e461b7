#include "daemon/publisher.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <bot_core/pose_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <povslam/health_t.hpp>
#include <povslam/object_event_t.hpp>
#include <povslam/object_list_t.hpp>
#include <povslam/pose_t.hpp>

#include "daemon/messages/channels.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

template <class Message>
std::vector<Message> read_channel(const std::string& file, const std::string& channel) {
  lcm::LogFile log(file, "r");
  std::vector<Message> messages;
  while (const lcm::LogEvent* event = log.readNextEvent()) {
    if (event->channel != channel) continue;
    Message message;
    EXPECT_GT(message.decode(event->data, 0, event->datalen), 0);
    EXPECT_LT(event->datalen, 1400) << "must fit one datagram";
    messages.push_back(message);
  }
  return messages;
}

TrackedFrame frame_at(double time_s, const Rigid3& T_odom_body, TrackState state = TrackState::ok) {
  TrackedFrame frame;
  frame.pose.stamp = from_seconds(time_s);
  frame.pose.seq = static_cast<std::uint64_t>(time_s * 10.0);
  frame.pose.state = state;
  frame.pose.T_odom_body = T_odom_body;
  frame.pose.T_world_body = {Eigen::Quaterniond(0.5, 0.5, -0.5, 0.5), {7.0, 8.0, 9.0}};
  for (int i = 0; i < 36; ++i) frame.pose.covariance(i / 6, i % 6) = i;
  frame.pose.num_landmarks = 321;
  frame.received = 1000 * kNsPerMs;
  frame.handed_over = 1012 * kNsPerMs;
  return frame;
}

class PublisherTest : public testing::Test {
 protected:
  std::unique_ptr<Publisher> open() {
    auto publisher = Publisher::open({"file://" + file_ + "?mode=w", "r2"});
    EXPECT_TRUE(publisher);
    return std::move(*publisher);
  }
  TempFolder folder_;
  std::string file_ = (folder_.path() / "out.lcm").string();
};

TEST_F(PublisherTest, SendsThePoseAsItWasTracked) {
  open()->on_frame(frame_at(12.5, Rigid3{Eigen::Quaterniond::Identity(), {1.0, 2.0, 3.0}}));
  const auto messages = read_channel<pose_t>(file_, kPoseChannel);
  ASSERT_EQ(messages.size(), 1u);
  const pose_t& m = messages[0];
  EXPECT_EQ(m.utime, 12500000);
  EXPECT_EQ(m.seq, 125);
  EXPECT_EQ(m.robot_id, "r2");
  EXPECT_EQ(m.state, pose_t::OK);
  EXPECT_THAT(m.world_body_position, testing::ElementsAre(7.0, 8.0, 9.0));
  EXPECT_THAT(m.world_body_quaternion, testing::ElementsAre(0.5, 0.5, -0.5, 0.5));  // w first
  EXPECT_THAT(m.odom_body_position, testing::ElementsAre(1.0, 2.0, 3.0));
  EXPECT_EQ(m.cov[1], 1.0);  // row-major
  EXPECT_EQ(m.cov[35], 35.0);
  EXPECT_EQ(m.landmarks, 321);
  EXPECT_NEAR(m.latency_s, 0.012, 1e-12);
}

TEST_F(PublisherTest, SpeaksBotCoreWithVelocitiesFromSuccessivePoses) {
  auto publisher = open();
  const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.2, Eigen::Vector3d::UnitZ()));
  publisher->on_frame(frame_at(1.0, Rigid3{turned, {0.0, 0.0, 0.0}}));
  const Eigen::Quaterniond more = turned * Eigen::Quaterniond(Eigen::AngleAxisd(0.05, Eigen::Vector3d::UnitX()));
  publisher->on_frame(frame_at(1.1, Rigid3{more, {0.1, -0.2, 0.0}}));
  publisher.reset();
  const auto messages = read_channel<bot_core::pose_t>(file_, kBotCorePoseChannel);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_THAT(messages[0].vel, testing::ElementsAre(0.0, 0.0, 0.0));
  EXPECT_NEAR(messages[1].vel[0], 1.0, 1e-9);  // along odom's axes
  EXPECT_NEAR(messages[1].vel[1], -2.0, 1e-9);
  EXPECT_NEAR(messages[1].rotation_rate[0], 0.5, 1e-9);  // about the body's axes
  EXPECT_NEAR(messages[1].rotation_rate[2], 0.0, 1e-9);
  EXPECT_NEAR(messages[1].orientation[0], more.w(), 1e-12);
}

TEST_F(PublisherTest, KeepsBotCoresFingerprint) {
  std::array<std::uint8_t, 256> bytes{};
  const bot_core::pose_t message{};
  ASSERT_EQ(message.encode(bytes.data(), 0, static_cast<int>(bytes.size())), 8 + 8 + 16 * 8);
  std::uint64_t fingerprint = 0;
  for (int i = 0; i < 8; ++i) fingerprint = fingerprint << 8U | bytes[static_cast<std::size_t>(i)];
  EXPECT_EQ(fingerprint, 0x170b77d82958082fULL << 1U);
}

TEST_F(PublisherTest, IsSilentOnPoseWhileLostButNotOnItsOwnChannel) {
  open()->on_frame(frame_at(1.0, Rigid3{}, TrackState::lost));
  EXPECT_TRUE(read_channel<bot_core::pose_t>(file_, kBotCorePoseChannel).empty());
  ASSERT_EQ(read_channel<pose_t>(file_, kPoseChannel).size(), 1u);
  EXPECT_EQ(read_channel<pose_t>(file_, kPoseChannel)[0].state, pose_t::LOST);
}

TEST_F(PublisherTest, SendsHealthWithEachReasonByName) {
  Health health;
  health.frames_in = 10;
  health.drops[static_cast<std::size_t>(DropReason::gap)] = 3;
  health.latency_ms.p99 = 17.0;
  health.state = TrackState::ok;
  health.store = {StoreState::failing, 5, 61.0, 12.0};
  health.understanding = {.views = 20, .views_dropped = 2, .labels_dropped = 1, .news = {}, .view_ms = {25.0, 40.0}};
  health.vem_runs = 77;
  health.vem.doubted = 3;
  health.vem.believed_again = 2;
  health.vem.corrections = 1;
  health.understanding.news.objects = 9;
  health.understanding.news.labels.late = 4;
  health.understanding.news.labels.wrong_size = 3;
  health.understanding.news.naming = {30, 1, 12};
  health.understanding.news.label_sources = {{"socket", true, true, 50, 40, 30, 2, 1}, {"lcm"}};
  auto publisher = open();
  publisher->on_health(health);
  publisher->on_health(health);
  publisher.reset();
  const auto messages = read_channel<health_t>(file_, kHealthChannel);
  ASSERT_EQ(messages.size(), 2u);
  EXPECT_EQ(messages[1].seq, 1);
  EXPECT_EQ(messages[1].session_id, messages[0].session_id);
  ASSERT_EQ(messages[0].num_drops, static_cast<int>(kNumDropReasons));
  EXPECT_EQ(messages[0].drops[static_cast<std::size_t>(DropReason::gap)].reason, "gap");
  EXPECT_EQ(messages[0].drops[static_cast<std::size_t>(DropReason::gap)].count, 3);
  EXPECT_EQ(messages[0].latency_p99_ms, 17.0);
  EXPECT_EQ(messages[0].version, POVSLAM_VERSION);
  EXPECT_EQ(messages[0].state, pose_t::DEGRADED);
  EXPECT_EQ(messages[0].map_store, health_t::FAILING);
  EXPECT_EQ(messages[0].map_commits, 5);
  EXPECT_EQ(messages[0].vem_runs, 77);
  EXPECT_EQ(messages[0].objects_doubted, 3);
  EXPECT_EQ(messages[0].objects_believed_again, 2);
  EXPECT_EQ(messages[0].pose_corrections, 1);
  EXPECT_EQ(messages[0].views, 20);
  EXPECT_EQ(messages[0].views_dropped, 2);
  EXPECT_EQ(messages[0].labels_dropped, 1);
  EXPECT_EQ(messages[0].labels_late, 4);
  EXPECT_EQ(messages[0].labels_wrong_size, 3);
  EXPECT_EQ(messages[0].naming_failed, 1);
  ASSERT_EQ(messages[0].num_label_sources, 2);
  EXPECT_EQ(messages[0].label_sources[0].name, "socket");
  EXPECT_EQ(messages[0].label_sources[0].silent, 1);
  EXPECT_EQ(messages[0].label_sources[0].malformed, 1);
  EXPECT_EQ(messages[0].label_sources[1].connected, 0);
  EXPECT_LT(messages[0].getEncodedSize(), 1350) << "LCM loses messages of more than one datagram";
  EXPECT_EQ(messages[0].objects, 9);
  EXPECT_EQ(messages[0].understand_p99_ms, 40.0);
  EXPECT_EQ(messages[0].map_commit_age_s, 61.0);
}

ObjectEvent moved_event() {
  ObjectEvent event;
  event.seq = 41;
  event.stamp = from_seconds(99.5);
  event.type = ObjectEventType::moved;
  event.object = 12;
  event.class_name = "box";
  event.place = {{1.0, 2.0, 0.3}, 0.5};
  event.size_m = {0.4, 0.5, 0.6};
  event.from = ObjectPlace{{1.0, 5.0, 0.4}, -0.5};
  event.consistency = 0.8;
  event.probability = 0.97;
  event.evidence = {from_seconds(1.0), from_seconds(2.0), from_seconds(3.0), from_seconds(4.0)};
  return event;
}

TEST_F(PublisherTest, SendsAnEventWithItsEvidence) {
  open()->on_event(moved_event());
  const auto messages = read_channel<object_event_t>(file_, kObjectEventChannel);
  ASSERT_EQ(messages.size(), 1u);
  const object_event_t& m = messages[0];
  EXPECT_EQ(m.utime, 99500000);
  EXPECT_EQ(m.seq, 41);
  EXPECT_EQ(m.robot_id, "r2");
  EXPECT_EQ(m.type, object_event_t::MOVED);
  EXPECT_EQ(m.object_id, 12);
  EXPECT_EQ(m.class_name, "box");
  EXPECT_THAT(m.position, testing::ElementsAre(1.0, 2.0, 0.3));
  EXPECT_EQ(m.yaw, 0.5);
  EXPECT_THAT(m.size, testing::ElementsAre(0.4, 0.5, 0.6));
  EXPECT_THAT(m.from_position, testing::ElementsAre(1.0, 5.0, 0.4));
  EXPECT_EQ(m.from_yaw, -0.5);
  EXPECT_EQ(m.consistency, 0.8);
  EXPECT_EQ(m.probability, 0.97);
  EXPECT_EQ(m.first_absent_utime, 1000000);
  EXPECT_EQ(m.last_absent_utime, 2000000);
  EXPECT_EQ(m.first_present_utime, 3000000);
  EXPECT_EQ(m.last_present_utime, 4000000);
}

TEST_F(PublisherTest, SendsZeroForWhatAnEventDoesNotHave) {
  ObjectEvent event = moved_event();
  event.type = ObjectEventType::removed;
  event.from.reset();
  event.evidence.first_absent.reset();
  event.evidence.last_absent.reset();
  open()->on_event(event);
  const auto messages = read_channel<object_event_t>(file_, kObjectEventChannel);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].type, object_event_t::REMOVED);
  EXPECT_THAT(messages[0].from_position, testing::Each(0.0));
  EXPECT_EQ(messages[0].first_absent_utime, 0);
  EXPECT_EQ(messages[0].last_absent_utime, 0);
}

ObjectSnapshot many_objects(int count, const std::string& class_name) {
  ObjectSnapshot snapshot;
  snapshot.stamp = from_seconds(7.0);
  for (int i = 0; i < count; ++i) {
    ObjectRecord object;
    object.id = i;
    object.class_name = class_name;
    snapshot.objects.push_back(object);
  }
  return snapshot;
}

TEST_F(PublisherTest, SplitsTheObjectsSoThatEachMessageFitsOneDatagram) {
  const ObjectSnapshot snapshot = many_objects(100, std::string(300, 'x'));
  auto publisher = open();
  publisher->on_objects(snapshot);
  publisher->on_objects(snapshot);
  publisher.reset();
  const auto messages = read_channel<object_list_t>(file_, kObjectsChannel);  // which checks the size
  ASSERT_EQ(messages.size() % 2, 0u);
  const std::size_t parts = messages.size() / 2;
  EXPECT_GT(parts, 10u);
  std::int64_t next_id = 0;
  for (std::size_t i = 0; i < parts; ++i) {
    EXPECT_EQ(messages[i].snapshot, messages[0].snapshot);
    EXPECT_EQ(messages[i].part, static_cast<int>(i));
    EXPECT_EQ(messages[i].parts, static_cast<int>(parts));
    EXPECT_EQ(messages[i].num_total, 100);
    EXPECT_EQ(messages[i].utime, 7000000);
    for (const object_t& object : messages[i].objects) EXPECT_EQ(object.id, next_id++);
  }
  EXPECT_EQ(next_id, 100);
  EXPECT_EQ(messages[parts].snapshot, messages[0].snapshot + 1);
  EXPECT_EQ(messages[parts].seq, static_cast<std::int64_t>(parts));
}

TEST_F(PublisherTest, SaysThatThereAreNoObjects) {
  open()->on_objects({});
  const auto messages = read_channel<object_list_t>(file_, kObjectsChannel);
  ASSERT_EQ(messages.size(), 1u);
  EXPECT_EQ(messages[0].parts, 1);
  EXPECT_EQ(messages[0].num_total, 0);
}

TEST(Publisher, SaysWhatToDoWhenTheUrlCannotBeUsed) {
  const auto nonsense = Publisher::open({"nosuch://", "r"});
  ASSERT_FALSE(nonsense);
  EXPECT_THAT(nonsense.error().message, testing::HasSubstr("nosuch://"));
  const auto unroutable = Publisher::open({"udpm://not-an-address:1?ttl=0", "r"});
  ASSERT_FALSE(unroutable);
  EXPECT_THAT(unroutable.error().message, testing::HasSubstr("ip route add 224.0.0.0/4 dev lo"));
}

}  // namespace
}  // namespace povslam
