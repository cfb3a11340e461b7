// EXPECTS(condition): our own contract. A failure is a bug of ours: it says where and ends the process.
// The world's failures (files, devices, configuration) are Result values instead.
#pragma once

#include <cstdio>
#include <cstdlib>

namespace povslam {

[[noreturn]] inline void contract_failed(const char* condition, const char* file, int line) {
  std::fprintf(stderr, "povslam: contract failed: %s (%s:%d)\n", condition, file, line);
  std::abort();
}

}  // namespace povslam

#define EXPECTS(condition) \
  (static_cast<bool>(condition) ? void(0) : ::povslam::contract_failed(#condition, __FILE__, __LINE__))
