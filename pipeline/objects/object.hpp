// One thing of the library: where it is, what it looks like, what is believed of it.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/mapping/compare.hpp"
#include "pipeline/mapping/volume.hpp"
#include "pipeline/objects/box_fit.hpp"
#include "pipeline/objects/fence.hpp"
#include "pipeline/objects/front_profile.hpp"
#include "pipeline/objects/hidden_ends.hpp"
#include "pipeline/objects/object_event.hpp"

namespace povslam {

// What a surface shows of its box: the ends of the sides seen.
struct SeenBox {
  Box box;
  std::array<int, 6> sides{};  // surface points that face along its +x, -x, +y, -y, +z, -z
};

struct MapObject {
  MapObject(std::int64_t its_id, const VolumeOptions& options) : id(its_id), volume(options) {}

  std::int64_t id;
  ObjectPhase phase = ObjectPhase::tentative;
  std::map<std::uint16_t, int> class_votes;  // by class id, observations
  bool class_binds = true;                   // see Observation
  Belief belief;

  Volume volume;
  Rigid3 T_world_volume;              // upright: turned about z only
  std::vector<SurfacePoint> surface;  // of the volume as it is, in the volume's frame
  std::vector<std::uint8_t> missed;   // by surface point: views in a row that saw through it (part_change)
  std::optional<Belief>
      part_belief;  // that the part seen through is still there; none: it all stands, or all is missed
  std::optional<TimeNs> part_first_absent;
  SeenBox seen;  // of the surface, in the volume's frame
  HiddenEnds hidden;
  std::optional<FrontProfile> profile;  // while it is wider than its kind
  Box box;                              // the same with what is assumed of the sides not seen

  TimeNs first_seen = 0, last_seen = 0;
  std::int64_t keyframe = -1;  // of the tracker's map, that the view hung on which saw it last; -1: not in this session
  std::optional<TimeNs> first_absent, last_absent;  // since it was last seen in its place
  int observations = 0;
  double looks = 0.0;  // sum over its views of a look's weight at its depth (kGoodSigma_m)
  std::vector<ObjectFence> fences;
  bool announced = false;  // an event told that it is here, or it was here first

  std::uint16_t class_id() const;  // the most voted, the lower id of equals
  Box box_world() const { return moved(box, T_world_volume); }
  static Box moved(const Box& box, const Rigid3& T);  // T: upright
};

double yaw_of(const Rigid3& T);  // of an upright motion
Rigid3 upright(const Eigen::Vector3d& position, double yaw);

double shape_weight(const MapObject& object);  // looks that make a point of its surface count
inline constexpr double kDeepest_m = 1.0;      // that is assumed of anything

// The box of such a surface, in its frame, one point to a voxel of voxel_m; nothing of fewer than 3 points.
std::optional<SeenBox> seen_box(std::span<const SurfacePoint> surface, double voxel_m);
// Too little of a side to say where it lies. side: as SeenBox::sides.
bool hardly_seen(const SeenBox& seen, int side);
// Its front goes on beyond its ends, as far as it may and no wider or higher in all than that.
SeenBox grown(const SeenBox& seen, const HiddenReach& reach, double width_m, double height_m);
// Of what was seen from one side only the depth is assumed: as much as its smaller visible extent, at most deepest_m.
Box with_depth(const SeenBox& seen, double deepest_m);
// The same with a depth that is known, but for its ends.
Box with_known_depth(const SeenBox& seen, double depth_m);
std::optional<Box> box_of_surface(std::span<const SurfacePoint> surface, double voxel_m, double deepest_m);

// How deep it is at least; nothing unless two of its upright sides that meet were seen.
std::optional<double> depth_seen(const SeenBox& seen);

// Two of its upright sides that meet were seen, and nothing is added to how long and how wide it looks.
bool seen_whole(const MapObject& object);

// Surface and box anew, after the volume changed.
void refresh_shape(MapObject& object, double min_weight, double deepest_m);

}  // namespace povslam
