#include "pipeline/objects/label_join.hpp"

#include <algorithm>
#include <cstdlib>
#include <numeric>

#include "pipeline/base/expects.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxKept = 16;  // half a second of a camera's labels: tracking is never that far behind

// Exact for any two stamps.
std::uint64_t distance(TimeNs a, TimeNs b) {
  return static_cast<std::uint64_t>(std::max(a, b)) - static_cast<std::uint64_t>(std::min(a, b));
}

}  // namespace

LabelJoin::LabelJoin(const LabelJoinOptions& options, const ClassTable& classes)
    : max_latency_(from_seconds(options.max_latency_s)),
      tolerance_(from_seconds(0.5 * options.period_s)),
      width_(options.width),
      height_(options.height),
      labels_come_(options.labels_come),
      views_(static_cast<std::size_t>(options.capacity)),
      order_(views_.size()),
      kept_(kMaxKept) {
  EXPECTS(options.capacity >= 1 && width_ > 0 && height_ > 0 && max_latency_ >= 0 && tolerance_ >= 0);
  std::iota(order_.begin(), order_.end(), std::size_t{0});
  for (const ObjectClass& row : classes.classes) {
    if (row.id < known_.size()) known_[row.id] = true;
  }
  known_[0] = true;  // unlabelled, whether the table says so or not
}

void LabelJoin::add(View&& view) {
  const TimeNs stamp = view.stamp();
  if (newest_view_ && stamp <= *newest_view_) {
    ++counts_.dropped_views;
    return;
  }
  if (count_ == static_cast<int>(views_.size())) {
    give_up(waiting(0).view.stamp());
    pop_first();
    ++counts_.dropped_views;
  }
  LabelledView& slot = waiting(count_++);
  std::swap(slot.view, view);
  slot.labelled = false;
  const bool first = !newest_view_;
  newest_view_ = stamp;
  if (first) judge_kept();
  serve_from_kept(slot);
}

void LabelJoin::add(const LabelFrame& labels) {
  ++counts_.received;
  const TimeNs stamp = labels.stamp;
  if (!fits(labels)) {
    ++counts_.wrong_size;
    return;
  }
  if (from_future(stamp) || (newest_labels_ && stamp <= *newest_labels_)) {
    ++counts_.bad;
    return;
  }
  newest_labels_ = stamp;
  if (LabelledView* view = nearest_waiting(stamp)) {
    join(*view, labels);
  } else if (was_given_up(stamp)) {
    ++counts_.late;
  } else if (newest_view_ && stamp <= *newest_view_) {
    ++counts_.unmatched;
  } else {
    keep(labels);
  }
}

LabelledView* LabelJoin::next() {
  if (count_ == 0 || !ready(waiting(0))) return nullptr;
  std::swap(out_, waiting(0));
  pop_first();
  if (!out_.labelled) {
    counts_.missing += labels_come_ ? 1 : 0;
    give_up(out_.view.stamp());
  }
  return &out_;
}

void LabelJoin::stop_waiting() {
  stopped_at_ = newest_view_;
}

// The image's own shape, at its size or smaller; one pixel of rounding is allowed.
bool LabelJoin::fits(const LabelFrame& labels) const {
  const ImageU8& classes = labels.classes;
  const ImageU16& instances = labels.instances;
  if (classes.empty() || classes.channels() != 1) return false;
  if (classes.width() > width_ || classes.height() > height_) return false;
  const std::int64_t skew =
      std::int64_t{classes.width()} * height_ - std::int64_t{classes.height()} * width_;  // 0: the same shape
  if (std::abs(skew) > std::max(width_, height_)) return false;
  return instances.empty() ||
         (instances.width() == classes.width() && instances.height() == classes.height() && instances.channels() == 1);
}

// Labels may overtake their view on its way through tracking, but not by more than a view may wait for them.
bool LabelJoin::from_future(TimeNs stamp) const {
  return newest_view_ && stamp > *newest_view_ &&
         distance(stamp, *newest_view_) > static_cast<std::uint64_t>(std::max(max_latency_, tolerance_));
}

bool LabelJoin::belong(TimeNs labels, TimeNs view) const {
  return distance(labels, view) <= static_cast<std::uint64_t>(tolerance_);
}

LabelledView* LabelJoin::nearest_waiting(TimeNs stamp) {
  LabelledView* nearest = nullptr;
  for (int i = 0; i < count_; ++i) {
    LabelledView& view = waiting(i);
    if (!belong(stamp, view.view.stamp())) continue;
    if (nearest != nullptr && distance(stamp, view.view.stamp()) >= distance(stamp, nearest->view.stamp())) continue;
    nearest = &view;
  }
  return nearest;
}

// Of two label frames that fit, the nearer stays; the other one counts as unmatched.
void LabelJoin::join(LabelledView& to, const LabelFrame& labels) {
  const TimeNs stamp = to.view.stamp();
  if (!to.labelled) {
    ++counts_.joined;
  } else {
    ++counts_.unmatched;
    if (distance(labels.stamp, stamp) >= distance(to.labels.stamp, stamp)) return;
  }
  to.labels = labels;
  to.labelled = true;
  for (std::uint8_t& id : to.labels.classes.pixels()) {
    if (known_[id]) continue;
    id = 0;
    ++counts_.unknown_ids;
  }
}

void LabelJoin::keep(const LabelFrame& labels) {
  // Always the same of the free ones: each that was ever used has an image.
  const auto first = std::min_element(kept_.begin(), kept_.end(), [](const Kept& a, const Kept& b) {
    return a.used != b.used ? !a.used : a.used && a.labels.stamp < b.labels.stamp;
  });
  if (first->used) ++counts_.unmatched;
  first->labels = labels;
  first->used = true;
}

// What came before there was any view could not be told from nonsense; now it can.
void LabelJoin::judge_kept() {
  newest_labels_.reset();
  for (Kept& kept : kept_) {
    if (!kept.used) continue;
    if (from_future(kept.labels.stamp)) {
      kept.used = false;
      ++counts_.bad;
    } else {
      newest_labels_ = std::max(newest_labels_.value_or(kept.labels.stamp), kept.labels.stamp);
    }
  }
}

void LabelJoin::serve_from_kept(LabelledView& fresh) {
  const TimeNs stamp = fresh.view.stamp();
  for (Kept& kept : kept_) {
    if (!kept.used) continue;
    if (belong(kept.labels.stamp, stamp)) {
      join(fresh, kept.labels);
      kept.used = false;
    } else if (kept.labels.stamp < stamp) {
      ++counts_.unmatched;
      kept.used = false;
    }
  }
}

bool LabelJoin::ready(const LabelledView& oldest) const {
  const TimeNs stamp = oldest.view.stamp();
  const bool overtaken = newest_labels_ && *newest_labels_ > stamp && !belong(*newest_labels_, stamp);
  const bool waited = distance(*newest_view_, stamp) >= static_cast<std::uint64_t>(max_latency_);
  const bool no_room = count_ == static_cast<int>(views_.size());
  return oldest.labelled || overtaken || waited || no_room || (stopped_at_ && stamp <= *stopped_at_);
}

void LabelJoin::pop_first() {
  std::rotate(order_.begin(), order_.begin() + 1, order_.begin() + count_);
  --count_;
}

void LabelJoin::give_up(TimeNs stamp) {
  given_up_[num_given_up_++ % given_up_.size()] = stamp;
}

bool LabelJoin::was_given_up(TimeNs stamp) const {
  const std::size_t count = std::min(num_given_up_, given_up_.size());
  return std::any_of(given_up_.begin(), given_up_.begin() + static_cast<std::ptrdiff_t>(count),
                     [&](TimeNs given_up) { return belong(stamp, given_up); });
}

}  // namespace povslam
