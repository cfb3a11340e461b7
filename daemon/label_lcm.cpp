#include "daemon/label_lcm.hpp"

#include <chrono>
#include <lcm/lcm-cpp.hpp>
#include <utility>

#include "daemon/label_lcm_message.hpp"
#include "daemon/thread_name.hpp"
#include "pipeline/base/log.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {

namespace {

constexpr int kWait_ms = 200;
constexpr int kQueue = 4;  // messages that LCM keeps while one is decoded

}  // namespace

struct LcmLabelThread::Impl {
  Impl(LcmLabelOptions o, LabelRing& r, LabelSourceCounters& c)
      : options(std::move(o)), lcm(options.url), ring(r), counters(c), silence(options.channel, options.silence) {}

  void run(const std::stop_token& stop);
  void receive(std::span<const std::uint8_t> bytes);
  bool too_many(TimeNs now);
  void refuse(const std::string& reason);

  LcmLabelOptions options;
  lcm::LCM lcm;
  LabelRing& ring;
  LabelSourceCounters& counters;
  LabelSilence silence;
  TimeNs second_began = 0;
  int messages_this_second = 0;
  std::string last_reason;
};

Result<std::unique_ptr<LcmLabelThread>> LcmLabelThread::start(LcmLabelOptions options, LabelRing& ring,
                                                              LabelSourceCounters& counters) {
  if (options.url.empty()) return Error{"labels.lcm_channel: LCM is off; set lcm.url, or labels.lcm_channel = \"\""};
  auto impl = std::make_unique<Impl>(std::move(options), ring, counters);
  if (!impl->lcm.good()) return Error{"labels.lcm_channel: LCM cannot use " + impl->options.url};
  // As bytes: the decoder of lcm-gen does not check lengths.
  lcm::Subscription* subscription = impl->lcm.subscribeFunction<Impl*>(
      impl->options.channel,
      [](const lcm::ReceiveBuffer* message, const std::string&, Impl* self) {
        self->receive({static_cast<const std::uint8_t*>(message->data), message->data_size});
      },
      impl.get());
  if (subscription == nullptr) {
    return Error{"labels.lcm_channel: LCM cannot listen to " + impl->options.channel + " on " + impl->options.url};
  }
  subscription->setQueueCapacity(kQueue);
  return std::unique_ptr<LcmLabelThread>(new LcmLabelThread(std::move(impl)));
}

LcmLabelThread::LcmLabelThread(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {
  thread_ = std::jthread([this](const std::stop_token& stop) {
    name_this_thread("labels lcm");
    impl_->run(stop);
  });
}

LcmLabelThread::~LcmLabelThread() = default;

void LcmLabelThread::Impl::run(const std::stop_token& stop) {
  while (!stop.stop_requested()) {
    const int handled = lcm.handleTimeout(kWait_ms);
    if (handled < 0) std::this_thread::sleep_for(std::chrono::milliseconds(kWait_ms));  // a log file that is over
    silence.watch(counters, monotonic_now());
  }
}

void LcmLabelThread::Impl::receive(std::span<const std::uint8_t> bytes) {
  if (too_many(monotonic_now())) {
    counters.dropped.fetch_add(1, std::memory_order_relaxed);
    return;
  }
  Result<LabelImage> message = read_label_image(bytes, options.limits);
  if (!message) return refuse(message.error().message);
  if (message->robot_id != options.robot_id) return;
  LabelFrame& labels = message->labels;
  if (labels.table_name != options.table) {
    return refuse("it labels with class table \"" + labels.table_name + "\", this daemon reads \"" + options.table +
                  "\"; set labels.classes or the source's table");
  }
  labels.produced = monotonic_now();
  const bool taken = ring.try_push(std::move(labels));
  (taken ? counters.labels : counters.dropped).fetch_add(1, std::memory_order_relaxed);
  if (!taken) return;
  if (!counters.connected.exchange(true, std::memory_order_relaxed))
    log::info("labels: they come on {}", options.channel);
  last_reason.clear();
}

bool LcmLabelThread::Impl::too_many(TimeNs now) {
  if (now - second_began >= kNsPerSecond) {
    second_began = now;
    messages_this_second = 0;
  }
  return ++messages_this_second > options.max_messages_per_s;
}

void LcmLabelThread::Impl::refuse(const std::string& reason) {
  counters.bad.fetch_add(1, std::memory_order_relaxed);
  if (reason != last_reason) log::warn("labels: a message on {} was refused: {}", options.channel, reason);
  last_reason = reason;
}

}  // namespace povslam
