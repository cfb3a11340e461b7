// Views wait here for the labels of their image; labels come later than their image, out of step, or never.
//
// A label frame belongs to the view with its stamp, else to the nearest within half a frame period. Labels of a source
// come in the order of their stamps; so a view is done with as soon as labels of a later image came, and goes on
// without: not having been labelled says nothing about what stands where. Labels may also come before their view: they
// wait, too. Pure values, the time is the newest view's stamp. The same calls give the same answers.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/view.hpp"

namespace povslam {

struct LabelCounts {
  std::int64_t received = 0, joined = 0;
  std::int64_t late = 0;           // their view was given up before
  std::int64_t unmatched = 0;      // no view was taken at their stamp
  std::int64_t missing = 0;        // views that went on without labels
  std::int64_t wrong_size = 0;     // not the images' shape, or larger
  std::int64_t bad = 0;            // stamps that do not increase, or from the future
  std::int64_t dropped_views = 0;  // nobody took them and there was no more room, or stamps that do not increase
  std::int64_t unknown_ids = 0;    // pixels
};

struct LabelJoinOptions {
  int capacity = 16;             // views that may wait; as many buffers are kept as ever waited at once
  double max_latency_s = 3;      // a view waits so long
  double period_s = 1.0 / 30.0;  // of the camera
  int width = 0, height = 0;     // px, of its images
  bool labels_come = true;       // false: nobody labels, so none are missing
};

struct LabelledView {
  View view;
  bool labelled = false;  // false: `labels` means nothing
  LabelFrame labels;      // ids that the table does not know are 0
};

class LabelJoin {
 public:
  LabelJoin(const LabelJoinOptions& options, const ClassTable& classes);

  void add(View&& view);  // the view is left with buffers of an earlier one, for reuse
  void add(const LabelFrame& labels);

  // The oldest view if it has its labels or need not wait any more, else null. Valid until the next call; its content
  // may be moved from as long as buffers are put back.
  LabelledView* next();

  // Views inside wait no longer.
  void stop_waiting();
  const LabelCounts& counts() const { return counts_; }

 private:
  struct Kept {
    LabelFrame labels;
    bool used = false;
  };

  bool fits(const LabelFrame& labels) const;
  bool from_future(TimeNs stamp) const;
  bool belong(TimeNs labels, TimeNs view) const;
  LabelledView& waiting(int i) { return views_[order_[static_cast<std::size_t>(i)]]; }
  LabelledView* nearest_waiting(TimeNs stamp);
  void join(LabelledView& to, const LabelFrame& labels);
  void keep(const LabelFrame& labels);
  void judge_kept();
  void serve_from_kept(LabelledView& fresh);
  bool ready(const LabelledView& oldest) const;
  void pop_first();
  void give_up(TimeNs stamp);
  bool was_given_up(TimeNs stamp) const;

  TimeNs max_latency_, tolerance_;
  int width_, height_;
  bool labels_come_;
  std::array<bool, 256> known_{};

  std::vector<LabelledView> views_;
  // Indices of views_: those that wait, oldest first; then the free ones, the one left last first, so that no more
  // slots get buffers than are ever in use at once.
  std::vector<std::size_t> order_;
  int count_ = 0;  // that wait
  LabelledView out_;
  std::vector<Kept> kept_;  // labels that came before their view
  std::optional<TimeNs> newest_view_, newest_labels_;
  std::optional<TimeNs> stopped_at_;   // views up to here wait no longer
  std::array<TimeNs, 64> given_up_{};  // ring of stamps
  std::size_t num_given_up_ = 0;
  LabelCounts counts_;
};

}  // namespace povslam
