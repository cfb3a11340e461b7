// Classes of geometric segments from a detector's boxes, one look in every few: what a network is good for when
// geometry tells things apart. A name is a vote, not a label: it may be missing or wrong in any look.
#pragma once

#include <functional>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/name_segments.hpp"

namespace povslam {

struct NamingOptions {
  int every_nth_view = 3;  // the network looks at; the others are segmented only
  int input_px = 416;      // edge of the network's square input
  BoxOptions boxes;
  NameOptions names;
};

struct SegmentClass {
  std::uint16_t id = kGeometricObject;
  int votes = 1;  // for the class of the object; 0: nobody asked what it is
};
// A name counts as much as so many looks without one: detectors overlook more often than they invent.
inline constexpr int kVotesOfName = 3;

struct NamingCounts {
  std::int64_t asked = 0;   // views the network looked at
  std::int64_t failed = 0;  // of these, it gave an error
  std::int64_t named = 0;   // segments
};

// What a segment without a name is: beyond the ids of label images, so that no table of a file has it.
inline constexpr std::uint16_t kUnnamedThing = 256;
// The table of named segments: the network's classes and "object".
ClassTable with_unnamed_things(ClassTable classes);

class SegmentNamer {
 public:
  using Detector = std::function<Result<std::vector<DetectedBox>>(const ImageU8&)>;
  // classes: of the network; class index i is id i + 1 of the table, and no name if the table has no such id.
  SegmentNamer(Detector detector, ClassTable classes, const NamingOptions& options);

  // One class a segment, in their order; instances and the view's pixels as Segmenter::segment() gives them. Valid
  // until the next call.
  const std::vector<SegmentClass>& name(const DepthView& view, const ImageU16& instances, std::size_t num_segments);

  const ClassTable& classes() const { return classes_; }
  const NamingCounts& counts() const { return counts_; }
  const std::string& last_error() const { return last_error_; }  // of the network; empty: none yet

 private:
  Detector detector_;
  ClassTable classes_;
  NamingOptions options_;
  NamingCounts counts_;
  std::int64_t views_ = 0;
  std::vector<SegmentClass> result_;
  std::string last_error_;
};

}  // namespace povslam
