#include "pipeline/frames/frame_merge.hpp"

#include <algorithm>

#include "pipeline/base/expects.hpp"

namespace povslam {

FrameMerge::FrameMerge(int num_streams, double max_wait_s) : max_wait_(from_seconds(max_wait_s)) {
  EXPECTS(num_streams > 0);
  streams_.resize(static_cast<std::size_t>(num_streams));
}

bool FrameMerge::push(int stream, TimeNs stamp, std::uint64_t ticket) {
  Stream& s = streams_.at(static_cast<std::size_t>(stream));
  const bool late = (s.last && stamp <= *s.last) || (handed_out_ && stamp < *handed_out_);
  if (late) {
    ++rejected_;
    return false;
  }
  s.last = stamp;
  s.waiting.push_back({stamp, stream, ticket});
  newest_ = newest_ ? std::max(*newest_, stamp) : stamp;
  return true;
}

void FrameMerge::finish(int stream) { streams_.at(static_cast<std::size_t>(stream)).finished = true; }

std::optional<FrameMerge::Item> FrameMerge::pop() {
  Stream* first = nullptr;
  for (Stream& s : streams_) {
    if (!s.waiting.empty() && (first == nullptr || s.waiting.front().stamp < first->waiting.front().stamp)) first = &s;
  }
  if (first == nullptr) return std::nullopt;
  const TimeNs stamp = first->waiting.front().stamp;
  for (const Stream& s : streams_) {
    const bool may_still_deliver_earlier = s.waiting.empty() && !s.finished && (!s.last || *s.last < stamp);
    if (may_still_deliver_earlier && *newest_ - stamp <= max_wait_) return std::nullopt;
  }
  const Item item = first->waiting.front();
  first->waiting.pop_front();
  handed_out_ = item.stamp;
  return item;
}

std::size_t FrameMerge::pending() const {
  std::size_t count = 0;
  for (const Stream& s : streams_) count += s.waiting.size();
  return count;
}

}  // namespace povslam
