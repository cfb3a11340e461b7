// Finding the camera in the map without a prediction: places that look like the frame, each verified; the best is
// believed only if no other place explains the frame nearly as well from elsewhere. Identical racks: no answer. A place
// of which the map holds a twin is believed only where the twin is known well enough to be ruled out: a rack seen from
// where its twin was mapped and it was not would else be taken for the twin.
//
// To be found again once lost, in each frame:
//   const Relocaliser::Answer answer = relocaliser.search(map, index, frame);
//   if (agreement.add(answer, frame.stamp)) …start tracking from answer.fit.T_camera_world…
// index holds the words of the map's keyframes: PlaceIndex::add(slot, words) as one comes, remove(slot) as one goes.
#pragma once

#include <array>
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
    bool twins_known = false;  // the best place was asked whether the map holds one that looks the same
  };
  // Bounded work: a query of the index and at most kMaxPlaces verifications (see PlaceVerifier), about twice that when
  // one fits. While none does, the next frame is searched for in the places that come next by their looks, and so on;
  // once one does, it is asked first.
  Answer search(const Map& map, PlaceIndex& index, const Frame& frame);
  static constexpr int kMaxPlaces = 5;
  void start_over() { page_ = 0, favourite_ = -1; }  // with the likeliest places

  struct Found {
    Rigid3 T_camera_world;
    int num_inliers = 0;
  };
  // Tries one keyframe.
  std::optional<Found> against(const Map& map, std::int32_t keyframe, const Frame& frame);

 private:
  struct Twin {                  // by keyframe slot
    std::int64_t of = -1;        // keyframe id it was looked for…
    std::int64_t among = -1;     // …among keyframes with ids below this one
    std::int64_t keyframe = -1;  // id of one elsewhere that looks the same; -1: none
    Rigid3 T_twin_world;         // carries a pose here to where it would be there
  };
  static constexpr int kPages = 4;
  struct Fits;
  using Likeliest = std::array<std::int32_t, kMaxPlaces>;
  bool verify_page(const Map& map, PlaceIndex& index, const FeatureView& view, Fits& fits, Likeliest& likeliest);
  void verify(const Map& map, std::int32_t keyframe, const FeatureView& view, Fits& fits);
  bool know_twins(const Map& map, PlaceIndex& index, const PlaceAround& place);
  void look_for_twin(const Map& map, PlaceIndex& index, std::int32_t keyframe);
  bool may_be_twin(const Map& map, const PlaceAround& place, const FeatureView& view, const PlaceFit& fit);

  PlaceVerifier verifier_;
  std::vector<std::uint32_t> words_;
  std::vector<Twin> twins_;
  int page_ = 0;                 // of kMaxPlaces places each
  std::int64_t favourite_ = -1;  // keyframe id of the last answer
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
