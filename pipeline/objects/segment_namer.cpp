#include "pipeline/objects/segment_namer.hpp"

#include <utility>

#include "pipeline/base/expects.hpp"

namespace povslam {

ClassTable with_unnamed_things(ClassTable classes) {
  classes.classes.push_back(make_class(kUnnamedThing, "object", ClassKind::semi_static));
  return classes;
}

SegmentNamer::SegmentNamer(Detector detector, ClassTable classes, const NamingOptions& options)
    : detector_(std::move(detector)), classes_(std::move(classes)), options_(options) {
  EXPECTS(detector_ && options_.every_nth_view >= 1);
}

const std::vector<SegmentClass>& SegmentNamer::name(const DepthView& view, const ImageU16& instances,
                                                    std::size_t num_segments) {
  result_.assign(num_segments, {kUnnamedThing, 0});
  const bool turn = views_++ % options_.every_nth_view == 0;
  if (!turn || view.color.empty() || num_segments == 0) return result_;
  ++counts_.asked;
  const Result<std::vector<DetectedBox>> boxes = detector_(view.color);
  if (!boxes) {
    ++counts_.failed;
    last_error_ = boxes.error().message;
    return result_;
  }
  const std::vector<SegmentName> names = name_segments(*boxes, instances, num_segments, options_.names);
  for (std::size_t i = 0; i < num_segments; ++i) {
    const auto id = static_cast<std::uint16_t>(names[i].class_index + 1);
    const bool named = names[i].class_index >= 0 && classes_.find(id) != nullptr;
    result_[i] = named ? SegmentClass{id, kVotesOfName} : SegmentClass{kUnnamedThing, 1};
    counts_.named += named ? 1 : 0;
  }
  return result_;
}

}  // namespace povslam
