// The two hand-offs under load: 10^8 values through each, checked, and how long a sleeping consumer takes to wake.
//   handoff_bench [OPERATIONS]
#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <thread>
#include <vector>

#include "pipeline/base/latest.hpp"
#include "pipeline/base/spsc_ring.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {
namespace {

struct Stamped {
  std::uint64_t number = 0;
  std::uint64_t complement = 0;
};

bool ring_throughput(std::uint64_t operations) {
  SpscRing<std::uint64_t> ring(1024);
  const TimeNs start = monotonic_now();
  std::jthread producer([&] {
    for (std::uint64_t i = 0; i < operations; ++i) {
      std::uint64_t value = i;
      while (!ring.try_push(std::move(value))) std::this_thread::yield();
    }
    ring.close();
  });
  std::uint64_t expected = 0, wrong = 0;
  while (const auto value = ring.pop()) wrong += *value != expected++ ? 1 : 0;
  const double elapsed_s = to_seconds(monotonic_now() - start);
  const bool good = wrong == 0 && expected == operations;
  std::printf("SpscRing  %llu values in %.1f s, %.1f ns each, order and count %s\n",
              static_cast<unsigned long long>(operations), elapsed_s, elapsed_s * 1e9 / static_cast<double>(operations),
              good ? "kept" : "BROKEN");
  return good;
}

bool latest_throughput(std::uint64_t operations) {
  Latest<Stamped> mailbox;
  const TimeNs start = monotonic_now();
  std::jthread writer([&] {
    for (std::uint64_t i = 1; i <= operations; ++i) {
      mailbox.draft() = {i, ~i};
      mailbox.publish();
    }
  });
  std::uint64_t last = 0, taken = 0, wrong = 0;
  while (last < operations) {
    const Stamped* const value = mailbox.take();
    if (value == nullptr) continue;
    ++taken;
    wrong += value->complement != ~value->number || value->number <= last ? 1 : 0;
    last = value->number;
  }
  const double elapsed_s = to_seconds(monotonic_now() - start);
  std::printf("Latest    %llu values in %.1f s, %.1f ns each, %llu taken, %s\n",
              static_cast<unsigned long long>(operations), elapsed_s, elapsed_s * 1e9 / static_cast<double>(operations),
              static_cast<unsigned long long>(taken), wrong == 0 ? "none torn, none old" : "BROKEN");
  return wrong == 0;
}

// The producer pushes its clock each millisecond; the consumer, asleep by then, looks at its own on waking.
void wake_up_latency() {
  constexpr int kRounds = 5000;
  SpscRing<TimeNs> ring(4);
  std::vector<TimeNs> latencies;
  latencies.reserve(kRounds);
  std::jthread consumer([&] {
    while (const auto pushed = ring.pop()) latencies.push_back(monotonic_now() - *pushed);
  });
  for (int i = 0; i < kRounds; ++i) {
    std::this_thread::sleep_for(std::chrono::milliseconds(1));
    ring.try_push(monotonic_now());
  }
  ring.close();
  consumer.join();
  std::sort(latencies.begin(), latencies.end());
  const auto quantile_us = [&](double q) {
    return 1e-3 *
           static_cast<double>(latencies[static_cast<std::size_t>(q * static_cast<double>(latencies.size() - 1))]);
  };
  std::printf("wake-up   p50 %.1f us, p99 %.1f us, max %.1f us over %zu sleeps\n", quantile_us(0.5), quantile_us(0.99),
              quantile_us(1.0), latencies.size());
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  const std::uint64_t operations = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000'000;
  const bool ring_good = povslam::ring_throughput(operations);
  const bool latest_good = povslam::latest_throughput(operations);
  povslam::wake_up_latency();
  return ring_good && latest_good ? 0 : 1;
}
