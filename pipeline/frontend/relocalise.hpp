// Finding the camera in the map without a prediction: places that look like the frame, each verified; the best is
// believed only if no other place explains the frame nearly as well from elsewhere. Identical racks: no answer.
//
// To be found again once lost, in each frame:
//   const Relocaliser::Answer answer = relocaliser.search(map, index, frame);
//   if (agreement.add(answer, frame.stamp)) …start tracking from answer.fit.T_camera_world…
// index holds the words of the map's keyframes: PlaceIndex::add(slot, words) as one comes, remove(slot) as one goes.
#pragma once

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/frontend/place_index.hpp"
#include "pipeline/frontend/verify_place.hpp"

namespace povslam {

// The keyframe and those that share most landmarks with it, at most kMaxPlaceKeyframes.
class PlaceAround {
 public:
  PlaceAround(const Map& map, std::int32_t keyframe);
  std::span<const std::int32_t> keyframes() const { return {keyframes_.data(), size_}; }

 private:
  std::array<std::int32_t, kMaxPlaceKeyframes> keyframes_{};
  std::size_t size_ = 0;
};

class Relocaliser {
 public:
  Relocaliser(const PinholeCamera& camera, const FrontendOptions& options);

  enum class Verdict {
    unknown,    // no place fits
    ambiguous,  // one fits, but another does nearly as well: which, the frame alone cannot tell
    found
  };
  struct Answer {
    Verdict verdict = Verdict::unknown;
    std::int32_t keyframe = kNone;  // slot: of the best place, the one that looks most like the frame
    PlaceFit fit;                   // of the best place, also when it is not believed
    int places_tried = 0;
  };
  // Bounded work: a query of the index and at most kMaxPlaces verifications (see PlaceVerifier).
  Answer search(const Map& map, PlaceIndex& index, const Frame& frame);
  static constexpr int kMaxPlaces = 5;

  struct Found {
    Rigid3 T_camera_world;
    int num_inliers = 0;
  };
  // Tries one keyframe.
  std::optional<Found> against(const Map& map, std::int32_t keyframe, const Frame& frame);

 private:
  PlaceVerifier verifier_;
  std::vector<std::uint32_t> words_;
};

// Asks for the same answer from successive frames before it is believed.
class Agreement {
 public:
  // True once kFrames answers in a row (an unknown in between is forgiven) agree within what a robot can move.
  bool add(const Relocaliser::Answer& answer, TimeNs stamp);
  void forget() { agreeing_ = 0; }

 private:
  static constexpr int kFrames = 3;
  int agreeing_ = 0, missed_ = 0;
  TimeNs stamp_ = 0;
  Rigid3 T_camera_world_;
};

}  // namespace povslam
