#include "daemon/store_thread.hpp"

#include <algorithm>
#include <chrono>
#include <utility>

#include "daemon/thread_name.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {

namespace {

template <class Change>
void give_back(ChangeWay<Change>& way, Change* change) {
  if (change == nullptr) return;
  const bool given_back = way.stored.try_push(std::move(change));
  EXPECTS(given_back);  // the ring holds as many as can be out at once
}

}  // namespace

StoreThread::StoreThread(MapStore store, ChangeRings& changes, Counters& counters, const StoreThreadOptions& options)
    : store_(std::move(store)),
      changes_(changes),
      counters_(counters),
      options_(options),
      thread_([this](const std::stop_token& stop) { run(stop); }) {}

StoreThread::~StoreThread() {
  finish();
}

bool StoreThread::finish() {
  if (thread_.joinable()) {
    thread_.request_stop();
    changes_.close();
    thread_.join();
    if (failing_) log::error("{}: the last changes of the map are not stored", store_.file().string());
  }
  return !failing_;
}

bool StoreThread::commit_rest(const MapChange* map, const WorldChange* world) {
  EXPECTS(!thread_.joinable());
  const bool done = commit(map, world);
  if (!done) log::error("{}: the last changes of the map are not stored", store_.file().string());
  return done;
}

void StoreThread::run(const std::stop_token& stop) {
  name_this_thread("store");
  for (;;) {
    const std::uint32_t rung = changes_.bell.count();
    const bool last = changes_.map.taken.closed() && changes_.world.taken.closed();
    MapChange* map = changes_.map.taken.try_pop().value_or(nullptr);
    WorldChange* world = changes_.world.taken.try_pop().value_or(nullptr);
    if (map == nullptr && world == nullptr) {
      if (last) return;
      changes_.bell.wait(rung);
      continue;
    }
    TimeNs wait = options_.first_pause;
    while (!commit(map, world)) {
      if (stop.stop_requested()) return;
      pause(stop, wait);
      wait = std::min(2 * wait, options_.longest_pause);
    }
    give_back(changes_.map, map);
    give_back(changes_.world, world);
  }
}

bool StoreThread::commit(const MapChange* map, const WorldChange* world) {
  const TimeNs begun = monotonic_now();
  const Result<CommitReport> done = store_.commit(map, world);
  const TimeNs now = monotonic_now();
  if (done) {
    counters_.store_last.store(now - begun, std::memory_order_relaxed);
    counters_.store_committed_at.store(now, std::memory_order_relaxed);
    counters_.store_commits.fetch_add(1, std::memory_order_relaxed);
  }
  note(done);
  return static_cast<bool>(done);
}

// The log hears of each change between working and failing, and once of rows that are no values.
void StoreThread::note(const Result<CommitReport>& done) {
  if (done && done->rows_left_out > 0 && !std::exchange(told_left_out_, true)) {
    log::error("{}: {} rows left out, the first: {}", store_.file().string(), done->rows_left_out, done->why_left_out);
  }
  if (failing_ == !done) return;
  failing_ = !done;
  counters_.store_failing.store(failing_, std::memory_order_relaxed);
  if (failing_) {
    failing_since_ = monotonic_now();
    log::error("map not stored: {}; trying on, nothing is forgotten meanwhile", done.error().message);
  } else {
    log::info("{}: stored again after {:.0f} s", store_.file().string(), to_seconds(monotonic_now() - failing_since_));
  }
}

void StoreThread::pause(const std::stop_token& stop, TimeNs duration) {
  std::unique_lock lock(pause_mutex_);
  pause_.wait_for(lock, stop, std::chrono::nanoseconds(duration), [] { return false; });
}

}  // namespace povslam
