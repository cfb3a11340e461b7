#include "daemon/reporter.hpp"

#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <utility>

#include "daemon/thread_name.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {
namespace {

constexpr std::size_t kMaxSamples = 4096;  // of a period; more are not needed for its percentiles

Percentiles percentiles(std::vector<float>& values) {
  if (values.empty()) return {};
  std::sort(values.begin(), values.end());
  const auto at = [&values](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
    return static_cast<double>(values[std::max<std::size_t>(rank, 1) - 1]);
  };
  return {at(0.50), at(0.99)};
}

double memory_rss_mb() {
  long pages = 0, resident = 0;
  if (std::FILE* file = std::fopen("/proc/self/statm", "r")) {
    if (std::fscanf(file, "%ld %ld", &pages, &resident) != 2) resident = 0;
    std::fclose(file);
  }
  return static_cast<double>(resident) * static_cast<double>(sysconf(_SC_PAGESIZE)) * 1e-6;
}

StoreHealth store_health(const Counters& counters, TimeNs now) {
  StoreHealth health;
  if (!counters.store_used.load()) return health;
  health.state = counters.store_failing.load()    ? StoreState::failing
                 : counters.store_replaced.load() ? StoreState::began_empty
                                                  : StoreState::ok;
  health.commits = counters.store_commits.load();
  const TimeNs committed_at = counters.store_committed_at.load();
  if (committed_at > 0) health.commit_age_s = to_seconds(now - committed_at);
  health.commit_last_ms = to_ms(counters.store_last.load());
  return health;
}

}  // namespace

Reporter::Reporter(const ReporterOptions& options, std::vector<Sink*> sinks, ReportRings& rings,
                   const Counters& counters)
    : options_(options), sinks_(std::move(sinks)), rings_(rings), counters_(counters) {
  for (auto* samples : {&latencies_ms_, &tracking_ms_, &understand_ms_}) samples->reserve(kMaxSamples);
  monitor_ = std::jthread([this](const std::stop_token& stop) { monitor(stop); });
  publisher_ = std::jthread([this] { publish(); });
}

Reporter::~Reporter() {
  rings_.poses.close();
  rings_.world.close();
  publisher_.join();
  monitor_.request_stop();
  monitor_.join();
}

void Reporter::watch(const TrackingThread* tracking) {
  const std::lock_guard lock(mutex_);
  tracking_ = tracking;
}

void Reporter::publish() {
  name_this_thread("publisher");
  for (;;) {
    const std::uint32_t rung = rings_.bell.count();
    const bool last = rings_.poses.closed() && rings_.world.closed();
    while (const auto frame = rings_.poses.try_pop()) take(*frame);
    while (auto report = rings_.world.try_pop()) take(std::move(*report));
    if (last) return;
    rings_.bell.wait(rung);
  }
}

void Reporter::take(const TrackedFrame& frame) {
  const std::lock_guard lock(mutex_);
  for (Sink* sink : sinks_) sink->on_frame(frame);
  if (latencies_ms_.size() < kMaxSamples) {
    latencies_ms_.push_back(static_cast<float>(to_ms(frame.handed_over - frame.received)));
    tracking_ms_.push_back(frame.pose.times.total_ms);
  }
  map_ = frame.map;
  vem_ = frame.vem;
  if (std::exchange(state_, frame.pose.state) != frame.pose.state) {
    state_changed_ = true;
    changed_.notify_one();
  }
}

void Reporter::take(WorldReport&& report) {
  const std::lock_guard lock(mutex_);
  if (const auto* event = std::get_if<ObjectEvent>(&report)) {
    log::info("{}", to_text(*event));
    for (Sink* sink : sinks_) sink->on_event(*event);
  } else if (auto* objects = std::get_if<ObjectSnapshot>(&report)) {
    objects_ = std::move(*objects);
  } else if (const auto* news = std::get_if<UnderstandingNews>(&report)) {
    news_ = *news;
    if (news->total_ms >= 0.0F && understand_ms_.size() < kMaxSamples) understand_ms_.push_back(news->total_ms);
  }
}

void Reporter::monitor(const std::stop_token& stop) {
  name_this_thread("monitor");
  std::unique_lock lock(mutex_);
  TimeNs health_due = monotonic_now() + options_.health_period, objects_due = monotonic_now();
  for (bool last = false; !last;) {
    const TimeNs wait = std::max<TimeNs>(0, std::min(health_due, objects_due) - monotonic_now());
    const bool changed =
        changed_.wait_for(lock, stop, std::chrono::nanoseconds(wait), [this] { return state_changed_; });
    last = stop.stop_requested();
    const TimeNs now = monotonic_now();
    if (last || changed || now >= health_due) {
      report_health();
      health_due = now + options_.health_period;
    }
    if (last || now >= objects_due) {
      report_objects();
      objects_due = now + options_.objects_period;
    }
  }
}

void Reporter::report_health() {
  state_changed_ = false;
  const Health health = collect();
  for (Sink* sink : sinks_) sink->on_health(health);
}

void Reporter::report_objects() {
  if (!objects_) return;
  for (Sink* sink : sinks_) sink->on_objects(*objects_);
}

Health Reporter::collect() {
  const TimeNs now = monotonic_now();
  const double period_s = std::max(1e-3, to_seconds(now - std::exchange(period_began_, now)));
  Health health;
  health.state = state_;
  health.tracking_alive = tracking_ == nullptr || tracking_->alive(options_.tracking_limit);
  health.sensors_up = counters_.sensors_up.load();
  health.sensors_down = options_.num_sensors - health.sensors_up;
  health.reopened = counters_.reopened.load();
  health.frames_in = counters_.frames_in.load();
  health.frames_tracked = counters_.tracked.load();
  health.frames_lost = counters_.lost.load();
  for (std::size_t i = 0; i < kNumDropReasons; ++i) health.drops[i] = counters_.drops[i].load();
  health.uptime_s = to_seconds(now - started_);
  health.frames_per_s = static_cast<double>(latencies_ms_.size()) / period_s;
  health.latency_ms = percentiles(latencies_ms_);
  health.tracking_ms = percentiles(tracking_ms_);
  latencies_ms_.clear();
  tracking_ms_.clear();
  health.map = map_;
  health.backend_runs = counters_.backend.runs.load();
  health.backend_last_ms = to_ms(counters_.backend.last.load());
  health.vem_runs = counters_.vem.runs.load();
  health.vem_last_ms = to_ms(counters_.vem.last.load());
  health.vem = vem_;
  health.store = store_health(counters_, now);
  health.understanding = {counters_.views.load(), counters_.views_dropped.load(), counters_.labels_dropped.load(),
                          news_, percentiles(understand_ms_)};
  understand_ms_.clear();
  health.memory_rss_mb = memory_rss_mb();
  return health;
}

TrackState overall_state(const Health& health) {
  const bool store_needs_somebody =
      health.store.state == StoreState::failing || health.store.state == StoreState::began_empty;
  return store_needs_somebody && health.state == TrackState::ok ? TrackState::degraded : health.state;
}

const char* to_string(DropReason reason) {
  switch (reason) {
    case DropReason::ring_full:
      return "ring_full";
    case DropReason::bad_frame:
      return "bad_frame";
    case DropReason::gap:
      return "gap";
    case DropReason::late:
      return "late";
    case DropReason::unused:
      return "unused";
    case DropReason::publisher:
      return "publisher";
  }
  return "unknown";
}

}  // namespace povslam
