#include "tools/povslam/listen.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <CLI/CLI.hpp>

#include <lcm/lcm-cpp.hpp>

#include "daemon/messages/channels.hpp"
#include "pipeline/frames/calibration.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/povslam/message_text.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

pose_t pose_at(double time_s, std::int8_t state = pose_t::OK) {
  pose_t message{};
  message.utime = static_cast<std::int64_t>(time_s * 1e6);
  message.seq = message.utime / 1000;
  message.robot_id = "r2";
  message.state = state;
  message.world_body_position[0] = time_s;
  message.world_body_quaternion[0] = 1.0;
  message.latency_s = 0.010;
  message.sent_utime = wall_now() / kNsPerUs;
  return message;
}

// A file as lcm-logger records it, played back at once.
class Listen : public testing::Test {
 protected:
  void record(const std::vector<pose_t>& poses, const std::vector<health_t>& reports = {}) {
    lcm::LCM lcm("file://" + log_ + "?mode=w");
    for (const pose_t& pose : poses) lcm.publish(kPoseChannel, &pose);
    for (const health_t& health : reports) lcm.publish(kHealthChannel, &health);
  }
  std::string listen(std::vector<std::string> more) {
    CLI::App app;
    exit_code_ = -1;
    add_listen(app, exit_code_);
    more.insert(more.begin(), {"listen", "--lcm-url", "file://" + log_ + "?speed=0"});
    std::reverse(more.begin(), more.end());
    testing::internal::CaptureStdout();
    app.parse(more);
    return testing::internal::GetCapturedStdout();
  }
  static std::size_t lines_with(const std::string& text, const std::string& word) {
    std::size_t count = 0;
    for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) ++count;
    return count;
  }
  TempFolder folder_;
  std::string log_ = (folder_.path() / "in.lcm").string();
  std::string trajectory_ = (folder_.path() / "trajectory.txt").string();
  int exit_code_ = -1;
};

TEST_F(Listen, ShowsPosesAtItsRateAndChangesOfStateAtOnce) {
  std::vector<pose_t> poses;
  for (int i = 0; i < 50; ++i) poses.push_back(pose_at(0.01 * i));
  for (int i = 50; i < 60; ++i) poses.push_back(pose_at(0.01 * i, pose_t::LOST));
  record(poses);
  const std::string shown = listen({"--rate", "0"});
  EXPECT_EQ(exit_code_, 0);
  EXPECT_EQ(lines_with(shown, " r2 OK"), 1u);
  EXPECT_EQ(lines_with(shown, " r2 LOST"), 1u);
  EXPECT_THAT(shown, AllOf(HasSubstr("60 poses"), HasSubstr("p50 10.0 p99 10.0 ms from frame to hand-over")));
}

TEST_F(Listen, StopsAfterTheCountAndShowsOnlyItsChannel) {
  health_t health{};
  health.robot_id = "r2";
  record({pose_at(1.0), pose_at(2.0), pose_at(3.0)}, {health});
  EXPECT_THAT(listen({"--count", "2"}), HasSubstr("2 poses"));
  const std::string shown = listen({"--channel", kHealthChannel});
  EXPECT_THAT(shown, AllOf(HasSubstr("health: r2"), Not(HasSubstr(" r2 OK"))));
}

TEST_F(Listen, SaysWhatVariationalEmCameTo) {
  health_t health{};
  health.vem_runs = 900;
  health.vem_last_ms = 2.5;
  record({}, {health});
  EXPECT_THAT(listen({"--channel", kHealthChannel}),
              AllOf(HasSubstr("VEM 900 2.5 ms"), Not(HasSubstr("doubted")), Not(HasSubstr("corrected"))));
}

TEST_F(Listen, SaysWhatTrackingDoubtsAndThatItWasCorrected) {
  health_t health{};
  health.vem_runs = 900;
  health.objects_doubted = 5;
  health.objects_believed_again = 3;
  health.pose_corrections = 1;
  record({}, {health});
  EXPECT_THAT(listen({"--channel", kHealthChannel}),
              AllOf(HasSubstr("2 objects doubted"), HasSubstr("pose corrected 1 times")));
}

TEST_F(Listen, SaysWhatIsWrongWithALabelSource) {
  health_t health{};
  health.views = 9;
  health.labels_wrong_size = 4;
  health.naming_asked = 3;
  health.naming_failed = 2;
  health.num_label_sources = 2;
  health.label_sources.resize(2);
  health.label_sources[0].name = "socket";
  health.label_sources[0].connected = health.label_sources[0].silent = 1;
  health.label_sources[0].malformed = 7;
  health.label_sources[1].name = "lcm";
  record({}, {health});
  EXPECT_THAT(listen({"--channel", kHealthChannel}),
              AllOf(HasSubstr("4 labels of a wrong size"), HasSubstr("label source socket 0 labels of 0 images"),
                    HasSubstr("7 malformed, IT IS SILENT"), HasSubstr("lcm (nobody there)"),
                    HasSubstr("THE NETWORK FAILED 2 times")));
}

TEST_F(Listen, WritesTrackedPosesOfTheBodyOrItsCamera) {
  record({pose_at(1.0), pose_at(2.0, pose_t::LOST), pose_at(3.0, pose_t::DEGRADED)});
  listen({"--out", trajectory_});
  EXPECT_EQ(exit_code_, 0);
  auto body = read_trajectory(trajectory_);
  ASSERT_TRUE(body);
  ASSERT_EQ(body->size(), 2u);
  EXPECT_EQ((*body)[1].stamp, 3 * kNsPerSecond);
  EXPECT_NEAR((*body)[1].T_world_sensor.translation.x(), 3.0, 1e-9);
  listen({"--out", trajectory_, "--camera", "forward"});
  auto camera = read_trajectory(trajectory_);
  ASSERT_TRUE(camera);
  EXPECT_LT(rotation_angle_rad((*camera)[0].T_world_sensor.inverse() * level_forward_camera()), 1e-6);
}

TEST_F(Listen, RefusesToMixTwoDaemonsInOneFile) {
  record({pose_at(5.0), pose_at(1.0)});
  testing::internal::CaptureStderr();
  listen({"--out", trajectory_});
  EXPECT_EQ(exit_code_, 1);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("went back"));
}

TEST_F(Listen, RefusesACameraThatIsNoPose) {
  record({});
  testing::internal::CaptureStderr();
  listen({"--camera", "sideways"});
  EXPECT_EQ(exit_code_, 2);
  EXPECT_THAT(testing::internal::GetCapturedStderr(), HasSubstr("--camera"));
}

object_event_t event_at(std::int64_t seq, std::int8_t type) {
  object_event_t message{};
  message.utime = 3'000'000;
  message.seq = seq;
  message.robot_id = "r2";
  message.type = type;
  message.object_id = 12;
  message.class_name = "box";
  message.position[0] = 1.5;
  message.from_position[0] = 4.5;
  message.last_absent_utime = 2'000'000;
  return message;
}

object_list_t part_of(std::int64_t snapshot, int part, int parts, int total, int objects) {
  object_list_t message{};
  message.robot_id = "r2";
  message.snapshot = snapshot;
  message.part = part;
  message.parts = parts;
  message.num_total = total;
  message.num_objects = objects;
  message.objects.resize(static_cast<std::size_t>(objects));
  for (object_t& object : message.objects) object.class_name = "crate";
  return message;
}

TEST_F(Listen, ShowsEventsAndHowManyObjectsThereAre) {
  {
    lcm::LCM lcm("file://" + log_ + "?mode=w");
    const object_event_t moved = event_at(4, object_event_t::MOVED), removed = event_at(6, object_event_t::REMOVED);
    const object_list_t list = part_of(1, 0, 1, 2, 2), again = part_of(2, 0, 1, 2, 2);
    lcm.publish(kObjectEventChannel, &moved);
    lcm.publish(kObjectEventChannel, &removed);
    lcm.publish(kObjectsChannel, &list);
    lcm.publish(kObjectsChannel, &again);
  }
  std::string shown = listen({});
  EXPECT_THAT(shown,
              HasSubstr("r2 event 4: object 12 (box) moved from (4.50, 0.00, 0.00) m 0 deg to (1.50, 0.00, 0.00)"));
  EXPECT_THAT(shown, HasSubstr("1 events missed"));
  EXPECT_THAT(shown, HasSubstr("object 12 (box) removed from (1.50, 0.00, 0.00)"));
  EXPECT_EQ(lines_with(shown, "objects: 2"), 1u);
  EXPECT_THAT(shown, Not(HasSubstr("crate")));
  shown = listen({"--channel", kObjectsChannel});
  EXPECT_EQ(lines_with(shown, "objects: 2"), 2u);
  EXPECT_EQ(lines_with(shown, "crate"), 4u);
  EXPECT_THAT(shown, Not(HasSubstr("event")));
}

TEST(ObjectSnapshots, AreWholeWhenAllPartsAreThereInAnyOrder) {
  ObjectSnapshots snapshots;
  EXPECT_FALSE(snapshots.add(part_of(1, 2, 3, 5, 1)));
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 3, 5, 2)));
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 3, 5, 2)));  // twice
  const auto whole = snapshots.add(part_of(1, 1, 3, 5, 2));
  ASSERT_TRUE(whole);
  EXPECT_EQ(whole->size(), 5u);
  EXPECT_FALSE(snapshots.add(part_of(1, 1, 3, 5, 2))) << "told once";
}

TEST(ObjectSnapshots, DoNotMixTwo) {
  ObjectSnapshots snapshots;
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 2, 4, 2)));
  EXPECT_FALSE(snapshots.add(part_of(2, 1, 2, 4, 2)));
  EXPECT_FALSE(snapshots.add(part_of(1, 1, 2, 4, 2))) << "given up";
  EXPECT_TRUE(snapshots.add(part_of(2, 0, 2, 4, 2)));
  object_list_t restarted = part_of(0, 0, 1, 0, 0);
  restarted.session_id = 7;
  EXPECT_TRUE(snapshots.add(restarted));
}

TEST(ObjectSnapshots, LeaveOutNonsense) {
  ObjectSnapshots snapshots;
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 0, 0, 0)));
  EXPECT_FALSE(snapshots.add(part_of(1, -1, 1, 0, 0)));
  EXPECT_FALSE(snapshots.add(part_of(1, 5, 2, 0, 0)));
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 2'000'000'000, 0, 0)));
  EXPECT_FALSE(snapshots.add(part_of(1, 0, 1, 9, 2))) << "fewer than it says";
}

TEST(MessageText, NamesEveryStateAndEveryDrop) {
  EXPECT_STREQ(state_name(pose_t::INITIALISING), "INITIALISING");
  EXPECT_STREQ(state_name(42), "?");
  health_t health{};
  health.tracking_alive = 0;
  drop_t drop;
  drop.reason = "gap";
  drop.count = 7;
  health.drops = {drop};
  health.num_drops = 1;
  EXPECT_THAT(health_line(health),
              AllOf(HasSubstr("dropped 7 gap"), HasSubstr("tracking hangs"), testing::Not(HasSubstr("map stored"))));
  health.map_store = health_t::FAILING;
  health.map_commits = 3;
  health.map_commit_age_s = 42.0;
  health.map_commit_last_ms = 12.0;
  EXPECT_THAT(health_line(health),
              AllOf(HasSubstr("map stored 3 times, 42 s ago in 12 ms"), HasSubstr("STORING THE MAP FAILS")));
}

}  // namespace
}  // namespace povslam
