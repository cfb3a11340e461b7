// Fills an empty map with what an earlier session learned.
#pragma once

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/map_rows.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class MapLoader {
 public:
  // The map must be empty. What does not fit into its capacities is left out, latest keyframes first. Features seen by
  // a camera of other intrinsics are carried over to this one; both are rectified, so nothing is lost.
  // Words are taken as they are, 0 where the content has none.
  static void load(const MapContent& content, const PinholeCamera& camera, Map& map);

 private:
  MapLoader(const MapContent& content, const PinholeCamera& camera, Map& map);
  void add_keyframe(const KeyframeRow& row, const KeyframeFeatures& seen);
  void add_landmarks();
  void add_looks();

  const MapContent& content_;
  PinholeCamera camera_;
  Map& map_;
  PinholeCamera made_by_;
  double zoom_x_ = 1.0, zoom_y_ = 1.0;  // from its pixels to ours
  double levels_ = 1.0;                 // from its pyramid levels to ours
};

}  // namespace povslam
