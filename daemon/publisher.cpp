#include "daemon/publisher.hpp"

#include <algorithm>
#include <bot_core/pose_t.hpp>
#include <lcm/lcm-cpp.hpp>
#include <povslam/health_t.hpp>
#include <povslam/object_event_t.hpp>
#include <povslam/object_list_t.hpp>
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

// LCM 1.3.1 loses messages of more than one datagram: this, its header and the channel stay below 1,400 bytes.
constexpr int kMaxMessageBytes = 1350;
constexpr std::size_t kMaxNameBytes = 64;  // of a class: a table may hold anything

std::int64_t utime_of(const std::optional<TimeNs>& stamp) {
  return stamp.value_or(0) / kNsPerUs;
}

void write_vector(const Eigen::Vector3d& v, double* out) {
  Eigen::Map<Eigen::Vector3d>{out} = v;
}

object_t message_of(const ObjectRecord& object) {
  object_t message;
  message.id = object.id;
  message.class_name = object.class_name.substr(0, kMaxNameBytes);
  write_vector(object.place.position, message.position);
  message.yaw = object.place.yaw;
  write_vector(object.size_m, message.size);
  message.consistency = object.belief.expected_consistency();
  message.observations = object.observations;
  message.landmarks = static_cast<std::int32_t>(object.landmarks.size());
  message.first_seen_utime = object.first_seen / kNsPerUs;
  message.last_seen_utime = object.last_seen / kNsPerUs;
  message.first_absent_utime = utime_of(object.first_absent);
  message.last_absent_utime = utime_of(object.last_absent);
  return message;
}

bool has_pose(TrackState state) {
  return state == TrackState::ok || state == TrackState::degraded;
}

label_source_t message_of(const LabelSourceHealth& source) {
  label_source_t message;
  message.name = source.name;
  message.connected = source.connected ? 1 : 0;
  message.silent = source.silent ? 1 : 0;
  message.offered = source.offered;
  message.images = source.images;
  message.labels = source.labels;
  message.dropped = source.dropped;
  message.malformed = source.bad;
  return message;
}

void write_understanding(const UnderstandingHealth& health, health_t& message) {
  const LabelCounts& labels = health.news.labels;
  message.views = health.views;
  message.views_dropped = health.views_dropped;
  message.views_understood = health.news.views_understood;
  message.understand_p50_ms = health.view_ms.p50;
  message.understand_p99_ms = health.view_ms.p99;
  message.objects = health.news.objects;
  message.events = health.news.events;
  message.labels_received = labels.received;
  message.labels_joined = labels.joined;
  message.labels_late = labels.late;
  message.labels_unmatched = labels.unmatched;
  message.labels_missing = labels.missing;
  message.labels_wrong_size = labels.wrong_size;
  message.labels_bad = labels.bad;
  message.labels_dropped = health.labels_dropped;
  message.unknown_label_pixels = labels.unknown_ids;
  for (const LabelSourceHealth& source : health.news.label_sources) message.label_sources.push_back(message_of(source));
  message.num_label_sources = static_cast<std::int32_t>(message.label_sources.size());
  message.naming_asked = health.news.naming.asked;
  message.naming_failed = health.news.naming.failed;
  message.segments_named = health.news.naming.named;
  message.naming_last_ms = static_cast<double>(health.news.naming_ms);
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
  object_list_t empty_part(const ObjectSnapshot& objects) const;

  lcm::LCM lcm;
  std::string robot_id;
  std::int64_t session_id = wall_now() / kNsPerUs;
  std::int64_t health_seq = 0, list_seq = 0, snapshot = 0;
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
  message.vem_runs = health.vem_runs;
  message.vem_last_ms = health.vem_last_ms;
  message.objects_doubted = health.vem.doubted;
  message.objects_believed_again = health.vem.believed_again;
  message.pose_corrections = health.vem.corrections;
  message.map_store = static_cast<std::int8_t>(health.store.state);
  message.map_commits = health.store.commits;
  message.map_commit_age_s = health.store.commit_age_s;
  message.map_commit_last_ms = health.store.commit_last_ms;
  write_understanding(health.understanding, message);
  message.memory_rss_mb = health.memory_rss_mb;
  impl_->send(kHealthChannel, message);
}

void Publisher::on_event(const ObjectEvent& event) {
  object_event_t message;
  message.utime = event.stamp / kNsPerUs;
  message.seq = event.seq;
  message.robot_id = impl_->robot_id;
  message.session_id = impl_->session_id;
  message.type = static_cast<std::int8_t>(event.type);
  message.object_id = event.object;
  message.class_name = event.class_name.substr(0, kMaxNameBytes);
  const ObjectPlace from = event.from.value_or(ObjectPlace{});
  write_vector(event.place.position, message.position);
  message.yaw = event.place.yaw;
  write_vector(event.size_m, message.size);
  write_vector(from.position, message.from_position);
  message.from_yaw = from.yaw;
  message.consistency = event.consistency;
  message.probability = event.probability;
  message.first_absent_utime = utime_of(event.evidence.first_absent);
  message.last_absent_utime = utime_of(event.evidence.last_absent);
  message.first_present_utime = event.evidence.first_present / kNsPerUs;
  message.last_present_utime = event.evidence.last_present / kNsPerUs;
  impl_->send(kObjectEventChannel, message);
}

object_list_t Publisher::Impl::empty_part(const ObjectSnapshot& objects) const {
  object_list_t part;
  part.utime = objects.stamp / kNsPerUs;
  part.robot_id = robot_id;
  part.session_id = session_id;
  part.snapshot = snapshot;
  part.num_total = static_cast<std::int32_t>(objects.objects.size());
  part.num_objects = 0;
  return part;
}

void Publisher::on_objects(const ObjectSnapshot& objects) {
  std::vector<object_list_t> parts{impl_->empty_part(objects)};
  for (const ObjectRecord& object : objects.objects) {
    object_t next = message_of(object);
    if (parts.back().getEncodedSize() + next._getEncodedSizeNoHash() > kMaxMessageBytes) {
      parts.push_back(impl_->empty_part(objects));
    }
    parts.back().objects.push_back(std::move(next));
    ++parts.back().num_objects;
  }
  ++impl_->snapshot;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    parts[i].seq = impl_->list_seq++;
    parts[i].part = static_cast<std::int32_t>(i);
    parts[i].parts = static_cast<std::int32_t>(parts.size());
    impl_->send(kObjectsChannel, parts[i]);
  }
}

}  // namespace povslam
