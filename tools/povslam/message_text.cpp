#include "tools/povslam/message_text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <numbers>

namespace povslam {
namespace {

template <class... Args>
std::string format(const char* pattern, Args... args) {
  char text[512];
  std::snprintf(text, sizeof text, pattern, args...);
  return text;
}

double yaw_deg(const double* wxyz) {
  const double w = wxyz[0], x = wxyz[1], y = wxyz[2], z = wxyz[3];
  return std::atan2(2.0 * (w * z + x * y), 1.0 - 2.0 * (y * y + z * z)) * 180.0 / std::numbers::pi;
}

double seconds(std::int64_t utime) {
  return static_cast<double>(utime) * 1e-6;
}

// Half axis of the covariance's block along its longest direction is at most this: sqrt of the trace.
double sigma(const double* cov, int first) {
  return std::sqrt(cov[first * 7] + cov[(first + 1) * 7] + cov[(first + 2) * 7]);
}

long long ll(std::int64_t value) {
  return value;
}

std::string source_part(const label_source_t& s) {
  std::string text = ", label source " + s.name + (s.connected != 0 ? "" : " (nobody there)");
  text += format(" %lld labels of %lld images", ll(s.labels), ll(s.offered));
  if (s.dropped > 0) text += format(", %lld dropped", ll(s.dropped));
  if (s.malformed > 0) text += format(", %lld malformed", ll(s.malformed));
  return s.silent != 0 ? text + ", IT IS SILENT" : text;
}

std::string vem_part(const health_t& m) {
  if (m.vem_runs == 0) return "";
  std::string text = format(", VEM %lld %.1f ms", ll(m.vem_runs), m.vem_last_ms);
  const std::int64_t doubted = m.objects_doubted - m.objects_believed_again;
  if (doubted > 0) text += format(", %lld objects doubted", ll(doubted));
  if (m.pose_corrections > 0) text += format(", pose corrected %lld times", ll(m.pose_corrections));
  return text;
}

std::string understanding_part(const health_t& m) {
  if (m.views == 0 && m.views_dropped == 0) return "";
  std::string text =
      format(", %d objects %lld events, views %lld understood %lld, p50 %.1f p99 %.1f ms", m.objects, ll(m.events),
             ll(m.views), ll(m.views_understood), m.understand_p50_ms, m.understand_p99_ms);
  if (m.views_dropped > 0) text += format(", dropped %lld views", ll(m.views_dropped));
  if (m.labels_received > 0) text += format(", labels %lld joined %lld", ll(m.labels_received), ll(m.labels_joined));
  const std::pair<std::int64_t, const char*> faults[] = {{m.labels_late, "late"},
                                                         {m.labels_missing, "missing"},
                                                         {m.labels_wrong_size, "of a wrong size"},
                                                         {m.labels_bad, "bad"},
                                                         {m.labels_dropped, "dropped"}};
  for (const auto& [count, what] : faults) {
    if (count > 0) text += format(", %lld labels %s", ll(count), what);
  }
  for (const label_source_t& source : m.label_sources) text += source_part(source);
  if (m.naming_asked > 0) {
    text += format(", network asked %lld times, %.0f ms, %lld segments named", ll(m.naming_asked), m.naming_last_ms,
                   ll(m.segments_named));
  }
  if (m.naming_failed > 0) text += format(", THE NETWORK FAILED %lld times", ll(m.naming_failed));
  return text;
}

const char* type_name(int type) {
  constexpr const char* kNames[] = {"appeared", "moved", "removed"};
  return type >= 0 && type < 3 ? kNames[type] : "?";
}

double degrees(double angle_rad) {
  return angle_rad * 180.0 / std::numbers::pi;
}

// "seen empty 10.0 to 12.0 s", or "never seen empty"
std::string seen(const char* what, std::int64_t first_utime, std::int64_t last_utime) {
  if (last_utime == 0) return std::string("never seen ") + what;
  return format("seen %s %.1f to %.1f s", what, seconds(first_utime), seconds(last_utime));
}

}  // namespace

std::string event_line(const object_event_t& m) {
  const double *p = m.position, *s = m.size, *f = m.from_position;
  std::string text = format("%14.3f s  %s event %lld: object %lld (%s) %s", seconds(m.utime), m.robot_id.c_str(),
                            ll(m.seq), ll(m.object_id), m.class_name.c_str(), type_name(m.type));
  if (m.type == object_event_t::MOVED) {
    text += format(" from (%.2f, %.2f, %.2f) m %.0f deg to", f[0], f[1], f[2], degrees(m.from_yaw));
  } else {
    text += m.type == object_event_t::REMOVED ? " from" : " at";
  }
  text += format(" (%.2f, %.2f, %.2f) m %.0f deg, %.2f x %.2f x %.2f m, consistency %.2f, probability %.2f; ", p[0],
                 p[1], p[2], degrees(m.yaw), s[0], s[1], s[2], m.consistency, m.probability);
  return text + seen("empty", m.first_absent_utime, m.last_absent_utime) + ", " +
         seen("there", m.first_present_utime, m.last_present_utime);
}

std::string object_line(const object_t& o) {
  const double *p = o.position, *s = o.size;
  return format(
      "  %5lld %-12s x %8.3f  y %8.3f  z %7.3f m  yaw %7.2f deg  %.2f x %.2f x %.2f m  consistency %.2f  %d looks"
      "  last %.1f s",
      ll(o.id), o.class_name.c_str(), p[0], p[1], p[2], degrees(o.yaw), s[0], s[1], s[2], o.consistency, o.observations,
      seconds(o.last_seen_utime));
}

const char* state_name(int state) {
  switch (state) {
    case pose_t::INITIALISING:
      return "INITIALISING";
    case pose_t::OK:
      return "OK";
    case pose_t::DEGRADED:
      return "DEGRADED";
    case pose_t::LOST:
      return "LOST";
    default:
      return "?";
  }
}

std::string pose_line(const pose_t& m) {
  const double* p = m.world_body_position;
  return format(
      "%14.3f s  %s %-12s  x %8.3f  y %8.3f  z %7.3f m  yaw %7.2f deg  +-%.3f m %.2f deg  %4d landmarks  %5.1f ms",
      seconds(m.utime), m.robot_id.c_str(), state_name(m.state), p[0], p[1], p[2], yaw_deg(m.world_body_quaternion),
      sigma(m.cov, 0), sigma(m.cov, 3) * 180.0 / std::numbers::pi, m.landmarks, m.latency_s * 1e3);
}

std::string bot_core_pose_line(const bot_core::pose_t& m) {
  return format("%14.3f s  POSE  x %8.3f  y %8.3f  z %7.3f m  yaw %7.2f deg  %6.3f m/s  %7.2f deg/s", seconds(m.utime),
                m.pos[0], m.pos[1], m.pos[2], yaw_deg(m.orientation), std::hypot(m.vel[0], m.vel[1], m.vel[2]),
                m.rotation_rate[2] * 180.0 / std::numbers::pi);
}

std::string health_line(const health_t& m) {
  std::string text = format(
      "health: %s %s, up %.0f s, sensors %d up %d down, frames %lld in %lld tracked %lld lost, %.1f/s, latency p50 "
      "%.1f "
      "p99 %.1f ms, tracking p50 %.1f p99 %.1f ms, map %d keyframes %d landmarks, %.0f MB",
      m.robot_id.c_str(), state_name(m.state), m.uptime_s, m.sensors_up, m.sensors_down,
      static_cast<long long>(m.frames_in), static_cast<long long>(m.frames_tracked),
      static_cast<long long>(m.frames_lost), m.frames_per_s, m.latency_p50_ms, m.latency_p99_ms, m.tracking_p50_ms,
      m.tracking_p99_ms, m.keyframes, m.landmarks, m.memory_rss_mb);
  for (const drop_t& drop : m.drops) {
    if (drop.count > 0) text += format(", dropped %lld %s", static_cast<long long>(drop.count), drop.reason.c_str());
  }
  text += vem_part(m);
  text += understanding_part(m);
  if (m.map_store != health_t::NO_STORE) {
    text += format(", map stored %lld times", static_cast<long long>(m.map_commits));
    if (m.map_commits > 0) text += format(", %.0f s ago in %.0f ms", m.map_commit_age_s, m.map_commit_last_ms);
  }
  if (m.map_store == health_t::FAILING) text += ", STORING THE MAP FAILS";
  if (m.map_store == health_t::BEGAN_EMPTY) text += ", the stored map was damaged";
  if (m.tracking_alive == 0) text += ", tracking hangs";
  return text;
}

}  // namespace povslam
