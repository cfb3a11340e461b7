// The sparse map: keyframes and landmarks in pools of fixed capacity, and the sightings that join them.
// One owner thread (tracking). No allocation after construction; memory is touched as the map grows.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <vector>

#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/id_table.hpp"
#include "pipeline/frontend/keyframe.hpp"
#include "pipeline/frontend/landmark.hpp"
#include "pipeline/frontend/object_trust.hpp"
#include "pipeline/frontend/patch.hpp"

namespace povslam {

class Map {
 public:
  Map(int max_features, const MapOptions& options, std::vector<float> level_scales);

  // Keyframes. Slots are reused, ids are not.
  std::int32_t insert_keyframe(const Frame& frame, const Rigid3& T_world_camera, const Matrix6d& covariance,
                               std::int64_t parent_id);  // makes room by evicting when full
  // heir: what its pose hangs on from now on; kNone: its most covisible neighbour.
  void remove_keyframe(std::int32_t slot, std::int32_t heir = kNone);
  Keyframe& keyframe(std::int32_t slot) { return keyframes_[static_cast<std::size_t>(slot)]; }
  const Keyframe& keyframe(std::int32_t slot) const { return keyframes_[static_cast<std::size_t>(slot)]; }
  std::int32_t find_keyframe(std::int64_t id) const;           // kNone when gone
  std::optional<Rigid3> keyframe_pose(std::int64_t id) const;  // also of one removed, through what it hung on
  int num_keyframes() const { return num_keyframes_; }
  std::int32_t keyframe_slots() const { return static_cast<std::int32_t>(keyframes_.size()); }
  std::int64_t next_keyframe_id() const { return next_id_; }
  std::int64_t next_landmark_id() const { return next_landmark_id_; }

  // Landmarks.
  std::int32_t create_landmark(std::int32_t keyframe, int feature, const Eigen::Vector3d& p_world);  // kNone when full
  void remove_landmark(std::int32_t slot);
  Landmark& landmark(std::int32_t slot) { return landmarks_[static_cast<std::size_t>(slot)]; }
  const Landmark& landmark(std::int32_t slot) const { return landmarks_[static_cast<std::size_t>(slot)]; }
  Patch& patch(std::int32_t slot) { return patches_[static_cast<std::size_t>(slot)]; }
  const Patch& patch(std::int32_t slot) const { return patches_[static_cast<std::size_t>(slot)]; }
  int num_landmarks() const { return num_landmarks_; }
  // What is believed of the object a landmark is part of; poses do not hang on landmarks that are not believed.
  ObjectTrust& object_trust() { return object_trust_; }
  float trust(std::int32_t slot) const { return object_trust_.of(landmark(slot).owner); }
  bool believed(std::int32_t slot) const { return trust(slot) > 0.0F; }
  std::int32_t landmark_slots() const { return static_cast<std::int32_t>(landmarks_.size()); }

  // Sightings. A landmark is seen at most once by a keyframe; when its list is full the oldest but the first goes.
  bool add_sighting(std::int32_t landmark, std::int32_t keyframe, int feature);
  void remove_sighting(std::int32_t landmark, std::int32_t keyframe);  // removes a landmark nothing sees any more
  bool sees(std::int32_t keyframe, std::int32_t landmark) const;
  void merge_landmarks(std::int32_t keep, std::int32_t drop);
  void refresh_landmark(std::int32_t slot);  // descriptor, viewing direction, scale, after sightings or poses changed

  void update_covisibility(std::int32_t keyframe);  // of it and, symmetrically, of its neighbours

  std::int64_t new_mark() { return ++mark_; }
  float level_scale(int level) const { return level_scales_[static_cast<std::size_t>(level)]; }
  int num_levels() const { return static_cast<int>(level_scales_.size()); }

 private:
  static constexpr std::size_t kMaxTrustedObjects = 8192;
  static constexpr std::size_t kRememberedIds = 1 << 17;  // removed keyframes whose pose can still be asked for
  struct Ghost {                                          // a removed keyframe, hanging on one that stayed
    std::int64_t id = -1;
    std::int64_t parent_id = -1;
    Rigid3 T_parent_camera;
  };
  friend class MapLoader;
  std::int32_t free_keyframe_slot();
  Keyframe& take_slot(std::int32_t slot, std::size_t num_features);  // its arrays laid out, its landmarks none
  std::int32_t free_landmark_slot();                                 // kNone when full
  void join(const LandmarkSighting& sighting, std::int32_t landmark);
  Ghost& ghost(std::int64_t id) { return ghosts_[static_cast<std::size_t>(id - first_id_) % kRememberedIds]; }
  const Ghost& ghost(std::int64_t id) const {
    return ghosts_[static_cast<std::size_t>(id - first_id_) % kRememberedIds];
  }
  void leave_ghost(const Keyframe& keyframe, std::int64_t heir_id);  // the heir may be a ghost itself
  void drop_covisibility(std::int32_t keyframe);
  void link_covisible(std::int32_t keyframe, std::int32_t other, std::int32_t weight);

  int max_features_;
  MapOptions options_;
  std::vector<float> level_scales_;
  std::vector<Keyframe> keyframes_;
  std::vector<std::int32_t> free_keyframes_;
  std::vector<Landmark> landmarks_;
  std::vector<std::int32_t> free_landmarks_;
  IdTable slot_of_id_;
  ObjectTrust object_trust_{kMaxTrustedObjects};
  std::vector<Ghost> ghosts_;  // by id since the first modulo size: old ones are forgotten
  int num_keyframes_ = 0, num_landmarks_ = 0;
  std::int64_t first_id_ = 0, next_id_ = 0;  // keyframes of this session
  std::int64_t next_landmark_id_ = 0;
  std::int64_t mark_ = 0;

  // Feature slabs, max_features_ entries per keyframe slot.
  std::unique_ptr<float[]> floats_;  // x, y, inverse depth and its sigma, sigma of x and y
  std::unique_ptr<std::uint8_t[]> levels_;
  std::unique_ptr<Descriptor[]> descriptors_;
  std::unique_ptr<std::uint32_t[]> words_;
  std::unique_ptr<std::int32_t[]> landmark_of_;
  std::unique_ptr<Patch[]> patches_;  // by landmark slot
};

}  // namespace povslam
