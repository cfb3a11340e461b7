// The log: one line with units, once per change of state, never per frame. spdlog's door.
// Safe from any thread; formatting allocates, so the tracking thread reports through its output instead.
#pragma once

#include <spdlog/spdlog.h>

#include <utility>

namespace povslam::log {

template <class... Args>
void info(spdlog::format_string_t<Args...> format, Args&&... args) {
  spdlog::info(format, std::forward<Args>(args)...);
}
template <class... Args>
void warn(spdlog::format_string_t<Args...> format, Args&&... args) {
  spdlog::warn(format, std::forward<Args>(args)...);
}
template <class... Args>
void error(spdlog::format_string_t<Args...> format, Args&&... args) {
  spdlog::error(format, std::forward<Args>(args)...);
}

}  // namespace povslam::log
