// The object library and its life cycle (POV-SLAM, Qian et al., RSS 2023, section III-F; POCD): what is seen again is
// believed more and grows, what should be seen and is not is believed less and goes, what is new becomes an object once
// it was seen often enough. Each change is told once.
#pragma once

#include <map>
#include <memory>
#include <unordered_map>
#include <vector>

#include "pipeline/mapping/empty_space.hpp"
#include "pipeline/mapping/integrate.hpp"
#include "pipeline/objects/associate.hpp"
#include "pipeline/objects/event_desk.hpp"
#include "pipeline/objects/extract.hpp"
#include "pipeline/objects/keyframe_motion.hpp"
#include "pipeline/objects/row.hpp"
#include "pipeline/objects/view.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

struct LibraryStep {  // what one view did
  std::vector<ObjectEvent> events;
  std::vector<LandmarkOwner> owners;  // that changed
  std::vector<std::int64_t> changed;  // objects whose belief, place or shape changed
  std::vector<std::int64_t> removed;
};

class ObjectLibrary {
 public:
  ObjectLibrary(const ObjectOptions& options, const VolumeOptions& volume, const IntegrateOptions& integrate,
                ClassTable classes);

  // Matches the view's observations and renames the owners of its pixels; integrates them into the objects' volumes.
  // empty: where space was seen empty before this view. The view's pose is trusted.
  void observe(const Extraction& extraction, const EmptySpace& empty, DepthView& view, LibraryStep& step);
  // What is believed of objects, for tracking: of those that the step changed, or removed.
  std::vector<ObjectBelief> beliefs(const LibraryStep& step) const;
  // Of an earlier session: whose landmarks are whose, and what is believed of all.
  void tell_restored(std::vector<LandmarkOwner>& owners, std::vector<ObjectBelief>& beliefs) const;
  // Of the view observed last: owners whose pixels are in a confirmed object's volume, sorted.
  std::vector<std::uint16_t> mapped_owners() const;
  // The landmarks seen on the objects of the view observed last.
  void claim_landmarks(const std::vector<SeenLandmark>& landmarks, const DepthView& view, LibraryStep& step);
  // Objects that tracking sees and does not believe where they were: their shapes are left alone until it does again.
  void doubt(const std::vector<std::int64_t>& objects) { doubted_ = objects; }
  // What the view of this stamp saw hangs on this keyframe from now on.
  void hang_on(std::int64_t keyframe, TimeNs stamp);
  // Keyframes were moved (a loop was closed): what hangs on them moves along in x, y, z and yaw. Tells nothing.
  void correct(std::span<const KeyframeMotion> motions);
  // Decides what was held back (end of a session).
  void finish(LibraryStep& step);

  const std::vector<std::unique_ptr<MapObject>>& objects() const { return objects_; }
  const ClassTable& classes() const { return classes_; }
  std::int64_t next_id() const { return next_id_; }
  std::int64_t next_event_seq() const { return desk_.next_seq(); }
  bool undecided(std::int64_t id) const { return desk_.holds_gone(id); }  // it went, no event tells so yet

  // An earlier session's object, before the first view. Ids and numbers of events go on from the meta's.
  void restore(const ObjectRow& row, std::span<const VoxelBlockRow* const> blocks);
  void restore(const WorldMeta& meta);
  ObjectRecord record_of(const MapObject& object) const;
  std::vector<ObjectRecord> standing() const;  // of all that are confirmed, but for posts

 private:
  std::vector<MapObject*> in_reach(const DepthView& view) const;
  void take(const Match& match, MapObject& object, const Extraction& extraction, const DepthView& view,
            const SurfaceLook& look);
  void doubt_part(const Match& match, MapObject& object, const Extraction& extraction, const DepthView& view);
  void miss(MapObject& object, const SurfaceLook& look, TimeNs now);
  bool inside_known(const Observation& observation, const std::vector<MapObject*>& reach,
                    std::span<const Standing> standing) const;
  bool stands_in_old_place(const MapObject& object) const;
  double share_that_came(const MapObject& object, const EmptySpace& empty, Evidence& evidence) const;
  void start(const Observation& observation, std::uint16_t owner, const DepthView& view);
  void confirm(MapObject& object, const EmptySpace& empty);
  void join_halves(const Association& association, const std::vector<MapObject*>& reach, const DepthView& view,
                   LibraryStep& step);
  void absorb_fragments(TimeNs now, LibraryStep& step);
  bool are_halves(const MapObject& a, const MapObject& b, const DepthView& view, int views);
  double widest_m(const MapObject& object) const;
  void look_for_groove(MapObject& object, std::uint16_t owner, const DepthView& view);
  void divide(const std::vector<MapObject*>& reach, LibraryStep& step);
  std::unique_ptr<MapObject> cut_at(const FencePlane& plane, MapObject& object);
  void merge_duplicates(const Association& association, const std::vector<MapObject*>& reach, LibraryStep& step);
  const MapObject* same_thing_better_known(const MapObject& object) const;
  void drop_unbelieved(TimeNs now, LibraryStep& step);
  // heir: the object its landmarks belong to from now on, LandmarkOwner::kNobody, or kGone.
  void erase(std::int64_t id, std::int64_t heir, LibraryStep& step);
  ObjectBelief belief_of(const MapObject& object) const;
  void rename(std::int64_t came, std::int64_t gone, LibraryStep& step);
  void remember_place(const MapObject& object);
  ObjectRecord record_without_landmarks(const MapObject& object) const;
  void refresh_waiting(TimeNs now);
  Standing standing(const SurfaceLook& look, const MapObject& object) const;
  bool contradicted(const SurfaceLook& look, const MapObject& object) const;
  const ObjectClass& class_of(const MapObject& object) const;
  double deepest_m(const MapObject& object) const;  // that a thing of its class is taken to be where it was not seen
  void learn_depths(const std::vector<MapObject*>& reach);
  void learn_extents();
  void learn_rows();
  void reshape(MapObject& object) const;  // after its volume changed
  void keep_apart(const MapObject& object, int along, std::array<double, 2>& reach_m) const;
  Box box_in_row(const MapObject& object, const RowHabits& row) const;
  void settle(MapObject& object) const;  // its box: what was seen, what is assumed, between its neighbours
  PlaceChange change_of(const MapObject& object, TimeNs now) const;

  ObjectOptions options_;
  VolumeOptions volume_options_;
  IntegrateOptions integrate_options_;
  ClassTable classes_;
  ObjectClass unknown_class_;
  std::vector<std::unique_ptr<MapObject>> objects_;
  std::int64_t next_id_ = 1;
  std::map<std::uint16_t, double> deepest_m_;  // by class, of those that showed enough
  struct Extents {                             // that fronts of a class are wont to have; 0: not known
    double width_m = 0.0, height_m = 0.0;
  };
  std::map<std::uint16_t, Extents> extents_;                     // by class
  std::map<std::pair<std::int64_t, std::int64_t>, int> halves_;  // by ids: views that hid what is between them
  EventDesk desk_;
  std::unordered_map<std::uint16_t, std::int64_t> object_of_owner_;  // of the last view
  std::vector<std::uint16_t> integrated_;                            // owners, of the last view
  struct Owned {
    std::int64_t object = -1;
    std::int32_t slot = -1;
  };
  std::unordered_map<std::int64_t, Owned> owner_of_landmark_;
  struct KnownDepth {
    std::int64_t object;
    std::uint16_t class_id;
    Eigen::Vector3d at;  // world
    double depth_m;
  };
  std::vector<KnownDepth> known_depths_;
  std::vector<RowMember> row_members_;  // all that have no sure class
  struct OldPlace {                     // of an object that went
    Box box;
    TimeNs last_present = 0;
    std::int64_t keyframe = -1;  // MapObject's
  };
  std::vector<OldPlace> old_places_;  // the latest
  std::vector<std::int64_t> doubted_;
  std::vector<std::pair<std::int64_t, std::int64_t>> renamed_;  // came, gone: by the desk, in this step
};

}  // namespace povslam
