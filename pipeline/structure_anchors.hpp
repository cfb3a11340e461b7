// Which keyframe each block of the structure's volume was last looked at from, so that the volume can follow a
// corrected map piece by piece.
#pragma once

#include <map>
#include <span>
#include <tuple>

#include "pipeline/mapping/volume.hpp"
#include "pipeline/objects/keyframe_motion.hpp"

namespace povslam {

class StructureAnchors {
 public:
  // After a view was integrated: the blocks it changed hang on its keyframe.
  void note(const Volume& volume, std::int64_t keyframe);
  // Blocks whose keyframe moved them by more than a voxel are carried along, each as a rigid piece, to the nearest
  // voxels; where pieces meet or fall on others, looks are averaged. Between pieces that part a seam stays open until
  // it is seen again. Returns how many were carried.
  int carry(Volume& volume, std::span<const KeyframeMotion> motions);

 private:
  using Place = std::tuple<std::int32_t, std::int32_t, std::int32_t>;
  std::map<Place, std::int64_t> keyframe_of_;
  std::uint32_t newest_change_ = 0;  // of the volume, noted
};

}  // namespace povslam
