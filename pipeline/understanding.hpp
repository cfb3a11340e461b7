// The other half of the journey, beside tracking: from chosen frames to objects, a dense map and events. One thread
// (not tracking's); no threads, files or clocks of its own.
//
//   tracking thread:        if (pipeline.view_due(frame)) pipeline.fill(view);   hand the view over
//   understanding thread:   understanding.add(labels) as they come;  understanding.add(view);
//                           while (const Understood* done = understanding.step()) …publish, store, owners to tracking…
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "pipeline/frames/calibration.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/mapping/mesh.hpp"
#include "pipeline/objects/class_table.hpp"
#include "pipeline/objects/label_join.hpp"
#include "pipeline/objects/object_event.hpp"
#include "pipeline/objects/segment_namer.hpp"
#include "pipeline/objects/view.hpp"
#include "pipeline/objects/world_rows.hpp"
#include "pipeline/options.hpp"

namespace povslam {

struct UnderstandTimes {  // CPU of the calling thread [ms]
  float segment_ms = 0.0F, name_ms = 0.0F, associate_ms = 0.0F, integrate_ms = 0.0F, total_ms = 0.0F;
  bool asked = false;  // the network for names
};

struct Understood {  // of one view
  TimeNs stamp = 0;
  std::vector<ObjectEvent> events;
  std::vector<LandmarkOwner> owners;  // that changed
  std::vector<ObjectBelief> beliefs;  // likewise
  int observations = 0;
  UnderstandTimes times;
};

class Understanding {
 public:
  // classes: of the labels that will come (unused by geometric segmentation and by names). content: an earlier
  // session's, or null. namer: with labels = "dnn", of segments; null with any other.
  Understanding(const UnderstandingOptions& options, const SensorCalibration& calibration, ClassTable classes,
                const WorldContent* content = nullptr, std::unique_ptr<SegmentNamer> namer = nullptr);
  ~Understanding();

  // Before the first view: mesh() shall have surfaces that are nobody's as well (LooseSurface; some 24 MB in a
  // warehouse aisle). Nothing else reads them.
  void keep_loose_surface();

  // Of an earlier session, for the pipeline before its first frame: whose landmarks are whose, what is believed of all.
  void tell_restored(std::vector<LandmarkOwner>& owners, std::vector<ObjectBelief>& beliefs) const;

  void add(View&& view);  // the view is left with buffers of an earlier one, for reuse
  void add(const LabelFrame& labels);

  // Understands the oldest view that is ready; null: none is. The result is valid until the next call.
  const Understood* step();
  // Views that wait for labels wait no longer (end of a recording, source gone).
  void stop_waiting();
  // End of a session: events held back until more is known are decided now. Call after the last step().
  const Understood& finish();

  const std::vector<ObjectRecord>& objects() const;  // all that are not removed, as of the last step
  const LabelCounts& labels() const;
  NamingCounts naming() const;
  std::string naming_error() const;  // the network's last; empty: none
  // Of everything that stands; slow the first time (only what changed is made anew).
  void mesh(Mesh& mesh);

  WorldChange* take_change();  // as Pipeline::take_change
  WorldChange* collect_change();
  void give_back(WorldChange* change);

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
