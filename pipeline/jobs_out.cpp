#include "pipeline/jobs_out.hpp"

#include <algorithm>

#include "pipeline/base/expects.hpp"

namespace povslam {

void JobsOut::add(const BackendJob& job, std::int64_t due) {
  EXPECTS(out_.size() < out_.capacity());
  out_.push_back({job, due, false});
}

void JobsOut::answer(const BackendJob& job) {
  const auto it = std::ranges::find_if(out_, [&](const Out& out) { return out.job == job && !out.answered; });
  EXPECTS(it != out_.end());
  it->answered = true;
}

std::optional<BackendJob> JobsOut::take_due(std::int64_t frame) {
  const auto it = std::ranges::find_if(out_, [&](const Out& out) { return out.answered && out.due <= frame; });
  if (it == out_.end()) return std::nullopt;
  const BackendJob job = it->job;
  out_.erase(it);
  return job;
}

}  // namespace povslam
