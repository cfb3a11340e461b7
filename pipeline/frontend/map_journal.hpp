// What became of the map since it was last written down. Owned by the tracking thread; looks through the landmarks in
// slices, so that a large map costs no frame much, and takes all keyframe poses at one instant, so that what is written
// is one consistent map even when a loop was closed meanwhile (landmarks hang on keyframes: see map_rows.hpp).
#pragma once

#include <cstdint>
#include <vector>

#include "pipeline/frontend/map.hpp"
#include "pipeline/frontend/map_rows.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class MapJournal {
 public:
  MapJournal(const PinholeCamera& camera, const MapOptions& options);

  // Written is what the content says of all that is in the map now. Landmarks of the content that no keyframe sees (a
  // session that ended in the middle of a sentence) are removed with the next change.
  void assume_written(const Map& map, const MapContent& content);

  // One slice a call. The change is complete, and not null, once `now` has come period_s after the last one and every
  // landmark was looked at; then it is the caller's until given back. Null while one is out.
  MapChange* advance(const Map& map, const MapMeta& meta, TimeNs now);
  // All that is left, at once. Null when nothing is, or one is out.
  MapChange* collect(const Map& map, const MapMeta& meta);
  void give_back(MapChange* change);

 private:
  struct WrittenKeyframe {  // by slot
    std::int64_t id = -1;
    std::int64_t parent_id = -1;
    Rigid3 T_world_camera;
    std::uint32_t joined = 0;
  };
  struct WrittenLandmark {  // by slot
    std::int64_t id = -1;
    std::int64_t anchor = -1;  // keyframe
    Eigen::Vector3f p_anchor = Eigen::Vector3f::Zero();
  };
  void look_at_landmarks(const Map& map, std::int32_t first, std::int32_t last);
  void look_at_landmark(const Map& map, std::int32_t slot);
  void look_at_keyframes(const Map& map);
  void write_keyframe(const Map& map, const Keyframe& kf, WrittenKeyframe& written);
  MapChange* finish(const Map& map, const MapMeta& meta);

  PinholeCamera camera_;
  TimeNs period_;
  std::vector<WrittenKeyframe> keyframes_;
  std::vector<WrittenLandmark> landmarks_;
  MapChange change_;
  bool out_ = false;
  std::int32_t cursor_ = 0;  // next landmark slot of this round
  TimeNs last_finished_ = 0;
  bool started_ = false;
};

}  // namespace povslam
