#include "daemon/label_sources.hpp"

#include <utility>

namespace povslam {

namespace {

LabelSourceHealth health_of(const char* name, const LabelSourceCounters& counters) {
  LabelSourceHealth health;
  health.name = name;
  health.connected = counters.connected.load();
  health.silent = counters.silent.load();
  health.offered = counters.offered.load();
  health.images = counters.images.load();
  health.labels = counters.labels.load();
  health.dropped = counters.dropped.load();
  health.bad = counters.bad.load();
  return health;
}

}  // namespace

Result<std::unique_ptr<LabelSources>> LabelSources::start(const LabelConfig& config, const LcmConfig& lcm,
                                                          const std::string& table, const PinholeCamera& camera,
                                                          Doorbell* bell) {
  std::unique_ptr<LabelSources> sources(new LabelSources(bell));
  const LabelLimits limits{camera.width, camera.height};
  if (!config.socket.empty()) {
    LabelSocketOptions options;
    options.path = config.socket;
    options.client.table = table;
    options.client.limits = limits;
    auto started = LabelThread::start(std::move(options), sources->socket_ring_, sources->socket_counters_);
    if (!started) return started.error();
    sources->socket_ = std::move(*started);
  }
  if (!config.lcm_channel.empty()) {
    LcmLabelOptions options;
    options.url = lcm.url;
    options.channel = config.lcm_channel;
    options.robot_id = lcm.robot_id;
    options.table = table;
    options.limits = limits;
    auto started = LcmLabelThread::start(std::move(options), sources->lcm_ring_, sources->lcm_counters_);
    if (!started) return started.error();
    sources->lcm_ = std::move(*started);
  }
  return sources;
}

void LabelSources::offer(const RgbdFrame& image) {
  if (socket_) socket_->offer(image);
  if (lcm_) lcm_counters_.offered.fetch_add(1, std::memory_order_relaxed);
}

std::vector<LabelSourceHealth> LabelSources::health() const {
  std::vector<LabelSourceHealth> all;
  if (socket_) all.push_back(health_of("socket", socket_counters_));
  if (lcm_) all.push_back(health_of("lcm", lcm_counters_));
  return all;
}

std::optional<LabelFrame> LabelSources::try_pop() {
  std::optional<LabelFrame> labels = socket_ring_.try_pop();
  return labels ? std::move(labels) : lcm_ring_.try_pop();
}

}  // namespace povslam
