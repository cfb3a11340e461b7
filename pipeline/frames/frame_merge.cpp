#include "pipeline/frames/frame_merge.hpp"

#include <algorithm>

#include "pipeline/base/expects.hpp"

namespace povslam {
namespace {

// later - earlier without overflow, whatever the stamps.
std::uint64_t span_ns(TimeNs earlier, TimeNs later) {
  return later <= earlier ? 0 : static_cast<std::uint64_t>(later) - static_cast<std::uint64_t>(earlier);
}

}  // namespace

FrameMerge::FrameMerge(int num_streams, double max_wait_s) {
  EXPECTS(num_streams > 0 && max_wait_s >= 0.0);
  streams_.resize(static_cast<std::size_t>(num_streams));
  max_wait_ns_ = static_cast<std::uint64_t>(from_seconds(max_wait_s));
}

bool FrameMerge::push(int stream, TimeNs stamp, std::uint64_t ticket) {
  Stream& s = at(stream);
  const bool in_order = !s.last || stamp > *s.last;
  if (in_order) s.last = stamp;  // even if too late to be used: the stream is alive and will be waited for again
  if (!in_order || (handed_out_ && stamp < *handed_out_)) {
    ++rejected_;
    return false;
  }
  if (!heard_) first_ = newest_ = stamp;
  heard_ = true;
  newest_ = std::max(newest_, stamp);
  s.items.push_back({stamp, stream, ticket});
  return true;
}

void FrameMerge::finish(int stream) {
  at(stream).finished = true;
}

std::optional<FrameMerge::Item> FrameMerge::pop() {
  Stream* first = nullptr;
  for (Stream& s : streams_) {
    if (!s.empty() && (first == nullptr || s.front().stamp < first->front().stamp)) first = &s;
  }
  if (first == nullptr) return std::nullopt;
  for (const Stream& s : streams_) {
    if (may_deliver_before(s, first->front().stamp)) return std::nullopt;
  }
  handed_out_ = first->front().stamp;
  return first->take();
}

bool FrameMerge::may_deliver_before(const Stream& stream, TimeNs stamp) const {
  if (!stream.empty() || stream.finished || (stream.last && *stream.last >= stamp)) return false;
  const bool silent = span_ns(stream.last.value_or(first_), newest_) > max_wait_ns_;
  return !silent;
}

std::size_t FrameMerge::pending() const {
  std::size_t count = 0;
  for (const Stream& s : streams_) count += s.items.size() - s.head;
  return count;
}

FrameMerge::Stream& FrameMerge::at(int stream) {
  EXPECTS(stream >= 0 && static_cast<std::size_t>(stream) < streams_.size());
  return streams_[static_cast<std::size_t>(stream)];
}

FrameMerge::Item FrameMerge::Stream::take() {
  const Item item = items[head++];
  if (2 * head >= items.size()) {
    items.erase(items.begin(), items.begin() + static_cast<std::ptrdiff_t>(head));
    head = 0;
  }
  return item;
}

}  // namespace povslam
