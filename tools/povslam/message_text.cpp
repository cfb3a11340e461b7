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

}  // namespace

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
