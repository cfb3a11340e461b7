#include "daemon/publisher.hpp"

#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <povslam/health_t.hpp>
#include <povslam/pose_t.hpp>

#include "daemon/messages/channels.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {
namespace {

void write_position(const Rigid3& T, double* position) {
  Eigen::Map<Eigen::Vector3d>{position} = T.translation;
}

void write_quaternion(const Rigid3& T, double* wxyz) {
  const Eigen::Quaterniond& q = T.rotation;
  wxyz[0] = q.w();
  wxyz[1] = q.x();
  wxyz[2] = q.y();
  wxyz[3] = q.z();
}

bool has_pose(TrackState state) {
  return state == TrackState::ok || state == TrackState::degraded;
}

std::string advice(const std::string& url) {
  if (!url.starts_with("udpm://")) return "the log above says why; is it a valid LCM URL?";
  return "multicast needs a route, also on a machine without network: "
         "ip link set lo up && ip route add 224.0.0.0/4 dev lo";
}

}  // namespace

struct Publisher::Impl {
  Impl(const LcmConfig& config) : lcm(config.url), robot_id(config.robot_id) {}

  template <class Message>
  void send(const char* channel, const Message& message) {
    if (lcm.publish(channel, &message) == 0) {
      failing = false;
      return;
    }
    if (!failing) log::error("LCM: a message on {} could not be sent; trying on", channel);
    failing = true;
  }
  void send_bot_core(const PoseEstimate& pose);

  lcm::LCM lcm;
  std::string robot_id;
  std::int64_t session_id = wall_now() / kNsPerUs;
  std::int64_t health_seq = 0;
  bool failing = false;
  struct Odom {
    TimeNs stamp;
    Rigid3 T_odom_body;
  };
  std::optional<Odom> before;  // the last frame with a pose
};

Publisher::Publisher(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}
Publisher::~Publisher() = default;

Result<std::unique_ptr<Publisher>> Publisher::open(const LcmConfig& config) {
  auto impl = std::make_unique<Impl>(config);
  if (!impl->lcm.good()) return Error{"LCM cannot use " + config.url + ": " + advice(config.url)};
  return std::unique_ptr<Publisher>(new Publisher(std::move(impl)));
}

void Publisher::on_frame(const TrackedFrame& frame) {
  const PoseEstimate& pose = frame.pose;
  pose_t message;
  message.utime = pose.stamp / kNsPerUs;
  message.seq = static_cast<std::int64_t>(pose.seq);
  message.robot_id = impl_->robot_id;
  message.session_id = impl_->session_id;
  message.map_version = static_cast<std::int32_t>(pose.map_version);
  message.state = static_cast<std::int8_t>(pose.state);
  write_position(pose.T_world_body, message.world_body_position);
  write_quaternion(pose.T_world_body, message.world_body_quaternion);
  write_position(pose.T_odom_body, message.odom_body_position);
  write_quaternion(pose.T_odom_body, message.odom_body_quaternion);
  Eigen::Map<Eigen::Matrix<double, 6, 6, Eigen::RowMajor>>{message.cov} = pose.covariance;
  message.landmarks = pose.num_landmarks;
  message.latency_s = to_seconds(frame.handed_over - frame.received);
  message.sent_utime = (wall_now() - (monotonic_now() - frame.handed_over)) / kNsPerUs;
  impl_->send(kPoseChannel, message);
  // bot_core.pose_t cannot say "lost": silence says it.
  if (has_pose(pose.state)) impl_->send_bot_core(pose);
}

void Publisher::Impl::send_bot_core(const PoseEstimate& pose) {
  bot_core::pose_t message{};
  message.utime = pose.stamp / kNsPerUs;
  write_position(pose.T_odom_body, message.pos);
  write_quaternion(pose.T_odom_body, message.orientation);
  if (before && pose.stamp > before->stamp) {
    const double dt_s = to_seconds(pose.stamp - before->stamp);
    const Rigid3& last = before->T_odom_body;
    const Eigen::Quaterniond turn_body = last.rotation.conjugate() * pose.T_odom_body.rotation;
    Eigen::Map<Eigen::Vector3d>{message.vel} = (pose.T_odom_body.translation - last.translation) / dt_s;
    Eigen::Map<Eigen::Vector3d>{message.rotation_rate} = so3_log(turn_body) / dt_s;
  }
  before = {pose.stamp, pose.T_odom_body};
  send(kBotCorePoseChannel, message);
}

void Publisher::on_health(const Health& health) {
  health_t message;
  message.utime = wall_now() / kNsPerUs;
  message.seq = impl_->health_seq++;
  message.robot_id = impl_->robot_id;
  message.session_id = impl_->session_id;
  message.version = POVSLAM_VERSION;
  message.uptime_s = health.uptime_s;
  message.state = static_cast<std::int8_t>(overall_state(health));
  message.tracking_alive = health.tracking_alive ? 1 : 0;
  message.sensors_up = health.sensors_up;
  message.sensors_down = health.sensors_down;
  message.reopened = health.reopened;
  message.frames_in = health.frames_in;
  message.frames_tracked = health.frames_tracked;
  message.frames_lost = health.frames_lost;
  for (std::size_t i = 0; i < kNumDropReasons; ++i) {
    drop_t drop;
    drop.reason = to_string(static_cast<DropReason>(i));
    drop.count = health.drops[i];
    message.drops.push_back(std::move(drop));
  }
  message.num_drops = static_cast<std::int32_t>(message.drops.size());
  message.frames_per_s = health.frames_per_s;
  message.latency_p50_ms = health.latency_ms.p50;
  message.latency_p99_ms = health.latency_ms.p99;
  message.tracking_p50_ms = health.tracking_ms.p50;
  message.tracking_p99_ms = health.tracking_ms.p99;
  message.keyframes = health.map.keyframes;
  message.landmarks = health.map.landmarks;
  message.backend_runs = health.backend_runs;
  message.backend_last_ms = health.backend_last_ms;
  message.map_store = static_cast<std::int8_t>(health.store.state);
  message.map_commits = health.store.commits;
  message.map_commit_age_s = health.store.commit_age_s;
  message.map_commit_last_ms = health.store.commit_last_ms;
  message.memory_rss_mb = health.memory_rss_mb;
  impl_->send(kHealthChannel, message);
}

}  // namespace povslam
