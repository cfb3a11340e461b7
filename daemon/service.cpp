#include "daemon/service.hpp"

#include <spdlog/fmt/fmt.h>
#include <systemd/sd-daemon.h>

#include <numeric>

#include "pipeline/base/log.hpp"

namespace povslam {

std::string status_text(const Health& health) {
  const std::int64_t dropped = std::accumulate(health.drops.begin(), health.drops.end(), std::int64_t{0}) -
                               health.drops[static_cast<std::size_t>(DropReason::unused)];
  std::string text = fmt::format(
      "tracking {}, {:.1f} frames/s, latency p50 {:.1f} p99 {:.1f} ms, {} keyframes, {} landmarks, "
      "{} of {} frames dropped, {:.0f} MB",
      to_string(health.state), health.frames_per_s, health.latency_ms.p50, health.latency_ms.p99, health.map.keyframes,
      health.map.landmarks, dropped, health.frames_in + dropped, health.memory_rss_mb);
  if (health.sensors_down > 0) text += fmt::format(", {} sensor down", health.sensors_down);
  if (!health.tracking_alive) text += ", tracking hangs";
  if (health.store.state == StoreState::failing) text += ", DEGRADED: the map is not being stored";
  if (health.store.state == StoreState::began_empty)
    text += ", DEGRADED: the stored map was damaged, an empty one began";
  return text;
}

void Service::ready() {
  sd_notify(0, "READY=1");
  log::info("ready");
}

void Service::stopping() {
  sd_notify(0, "STOPPING=1");
  log::info("stopping");
}

void Service::on_health(const Health& health) {
  if (health.tracking_alive) sd_notify(0, "WATCHDOG=1");
  const bool changed = !any_health_ || health.state != last_.state || health.sensors_down != last_.sensors_down ||
                       health.tracking_alive != last_.tracking_alive || health.store.state != last_.store.state;
  if (changed) {
    const std::string text = status_text(health);
    sd_notifyf(0, "STATUS=%s", text.c_str());
    if (any_health_ || health.state != TrackState::initialising) log::info("{}", text);
  }
  if (any_health_ && health.vem.corrections > last_.vem.corrections) {
    log::warn("the pose was corrected: tracking had followed things that moved ({} times so far)",
              health.vem.corrections);
  }
  any_health_ = true;
  last_ = health;
}

}  // namespace povslam
