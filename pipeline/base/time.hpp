// Time as the system carries it: nanoseconds since an epoch that the source of the stamp defines.
// A frame's stamp is the time of its measurement; clocks below are for pacing and latency.
#pragma once

#include <cstdint>
#include <ctime>
#include <limits>

namespace povslam {

using TimeNs = std::int64_t;

inline constexpr TimeNs kNsPerSecond = 1'000'000'000;
inline constexpr TimeNs kNsPerMs = 1'000'000;
inline constexpr TimeNs kNsPerUs = 1'000;

constexpr double to_seconds(TimeNs time) {
  return static_cast<double>(time) * 1e-9;
}
constexpr double to_ms(TimeNs time) {
  return static_cast<double>(time) * 1e-6;
}
// Rounds to the nearest; beyond +-292 years the nearest TimeNs there is, not-a-number gives the largest.
constexpr TimeNs from_seconds(double time_s) {
  constexpr double kLimitS = 9.223372e9;
  if (!(time_s < kLimitS)) return std::numeric_limits<TimeNs>::max();
  if (time_s < -kLimitS) return std::numeric_limits<TimeNs>::min();
  return static_cast<TimeNs>(time_s * 1e9 + (time_s < 0.0 ? -0.5 : 0.5));
}

inline TimeNs read_clock(clockid_t clock) {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<TimeNs>(now.tv_sec) * kNsPerSecond + now.tv_nsec;
}
inline TimeNs monotonic_now() {
  return read_clock(CLOCK_MONOTONIC);
}
inline TimeNs wall_now() {
  return read_clock(CLOCK_REALTIME);
}
inline TimeNs thread_cpu_now() {
  return read_clock(CLOCK_THREAD_CPUTIME_ID);
}
inline TimeNs process_cpu_now() {
  return read_clock(CLOCK_PROCESS_CPUTIME_ID);
}

}  // namespace povslam
