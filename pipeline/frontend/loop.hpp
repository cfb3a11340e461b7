// Loop closing beside tracking: a keyframe that looks like an old one from which nothing was followed here is verified,
// believed when its successors say the same, and closed in pieces, each bounded: the pose graph is solved elsewhere,
// its answer moves the map at once, then landmarks of both visits are joined, a keyframe a frame, and what is around
// is named for smoothing. A loop that is not closed is only lost work; a wrong one is lost trust.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/frontend/fuse.hpp"
#include "pipeline/frontend/loop_counts.hpp"
#include "pipeline/frontend/loop_exchange.hpp"
#include "pipeline/frontend/place_index.hpp"
#include "pipeline/frontend/relocalise.hpp"
#include "pipeline/frontend/verify_place.hpp"

namespace povslam {

class LoopCloser {
 public:
  LoopCloser(const PinholeCamera& camera, const FrontendOptions& options);

  // A keyframe just made and indexed. May prepare a problem.
  void look(Map& map, PlaceIndex& index, std::int32_t keyframe, std::int64_t frame_index);

  // One is out at a time.
  LoopProblem* take();
  void give_back(LoopProblem* problem);

  // A frame begins: an answer that was given back enters. Returns how keyframe `follow` was moved (T_new * T_old^-1 in
  // the world), nullopt when the map stayed.
  std::optional<Rigid3> apply(Map& map, std::int64_t follow_id);
  // One keyframe's worth of joining; false: nothing to do.
  bool join_some(Map& map);
  // A keyframe to smooth around, after a loop; kNone.
  std::int32_t next_to_smooth(const Map& map);

  const LoopCounts& counts() const { return counts_; }

 private:
  struct Suspicion {  // what the last keyframes said
    int agreeing = 0, missed = 0;
    Rigid3 T_new_old;                         // how the world around us would have to move
    double spread_m = 0.0, spread_rad = 0.0;  // by how much they differ about it, at most
  };
  std::optional<LoopFound> recognise(Map& map, PlaceIndex& index, std::int32_t keyframe);
  void leave_out_connected(const Map& map, PlaceIndex& index, std::int32_t keyframe);
  bool plausible(const Map& map, std::int32_t now, std::int32_t then, const Rigid3& T_world_now) const;
  bool rivalled(const Map& map, PlaceIndex& index, const FeatureView& view, const PlaceFit& best);
  bool agrees(const Rigid3& T_world_old, const Rigid3& T_world_new);
  void begin_joining(const Map& map, const LoopFound& found);

  PlaceVerifier verifier_;
  LoopExchange exchange_;
  LandmarkFuser fuser_;
  std::size_t max_old_landmarks_;
  Suspicion suspicion_;
  LoopFound found_;
  LoopProblem problem_;
  enum class State { idle, offered, out, answered } state_ = State::idle;
  std::vector<std::int64_t> to_join_;        // keyframe ids of this visit, last first
  std::vector<std::int32_t> old_landmarks_;  // slots of the old one…
  std::vector<std::uint32_t> generations_;   // …and what they were then
  std::vector<std::int64_t> to_smooth_;      // keyframe ids, last first
  LoopCounts counts_;
};

}  // namespace povslam
