#include "tools/povslam/progress.hpp"

#include <unistd.h>

#include <algorithm>
#include <cstdio>
#include <utility>

namespace povslam {

Progress::Progress(std::string title, std::size_t total)
    : title_(std::move(title)), total_(total), started_(monotonic_now()), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
  if (!terminal_) return;
  draw();
  std::fputc('\n', stderr);
}

void Progress::step() {
  ++done_;
  if (!terminal_ || monotonic_now() - drawn_ < 100 * kNsPerMs) return;
  draw();
}

void Progress::draw() {
  drawn_ = monotonic_now();
  const double elapsed_s = to_seconds(drawn_ - started_);
  if (total_ == 0) {
    std::fprintf(stderr, "\r%s %zu  %.0f s ", title_.c_str(), done_, elapsed_s);
    return;
  }
  constexpr int kWidth = 32;
  const double share = std::min(1.0, static_cast<double>(done_) / static_cast<double>(total_));
  const int filled = static_cast<int>(share * kWidth);
  const double left_s = done_ > 0 ? elapsed_s * (1.0 - share) / share : 0.0;
  std::fprintf(stderr, "\r%s [%.*s%*s] %zu/%zu  %.0f s left ", title_.c_str(), filled,
               "################################", kWidth - filled, "", done_, total_, left_s);
}

}  // namespace povslam
