// What became of each try, against the truth: the words the tables use.
//
// A claim is a pose published OK or DEGRADED. Right after a teleport the tracker may hold its last pose for some
// frames, DEGRADED and with growing covariance, before it says LOST: such a held pose is counted apart from what is
// claimed from the first LOST on, or from the frame on by which it should have been said.
#pragma once

#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "tools/bench/journey.hpp"
#include "tools/bench/kidnap_tries.hpp"
#include "tools/bench/seen_surfaces.hpp"

namespace povslam {

// What a view lets anybody know, by truth.
enum class Known {
  mapped,     // at least a fifth of the image, at the beginning and at the end, shows surfaces that the drive saw
  partly,     // less, or not all the time
  unmapped,   // never more than a fiftieth
  ambiguous,  // all the time the same image, but for one percent of its pixels, is had from another place
};
inline constexpr const char* kKnownNames[] = {"mapped", "partly", "unmapped", "ambiguous"};

struct Step {  // one frame of a try
  TrackState state = TrackState::lost;
  int landmarks = 0;
  bool keyframe = false;
  PoseError error;
};

struct Try {
  Place place = Place::lap;
  Known known = Known::mapped;
  Drift drift;
  SeenSurfaces::Share share;     // at the beginning
  double twin_difference = 1.0;  // the most over the try of the least of any twin
  int frames = 0;
  int first_right = -1;  // frame of the first right claim
  PoseError right;       // of that claim
  int claims = 0, wrong = 0;
  PoseError worst;  // of the claims
  Rigid3 T_world_body_worst;
  int held = 0, held_wrong = 0, held_uncovered = 0;  // uncovered: further off than three sigma say
  TrackState last = TrackState::lost;
  std::vector<Step> steps;

  bool found() const { return first_right >= 0; }
  bool any_wrong() const { return wrong > 0; }
};

class TryScore {
 public:
  TryScore(Try& tried, int frames_to_lost, bool was_tracking)
      : try_(tried), frames_to_lost_(frames_to_lost), holding_(was_tracking) {}

  void add(const PoseEstimate& pose, const Rigid3& T_world_camera) {
    const int frame = try_.frames++;
    try_.last = pose.state;
    const PoseError error = error_of(pose.T_world_camera, T_world_camera);
    try_.steps.push_back({pose.state, pose.num_landmarks, pose.keyframe, error});
    if (!has_pose(pose)) {
      holding_ = false;
      return;
    }
    if (frame >= frames_to_lost_) holding_ = false;
    if (holding_ && error.wrong()) return add_held(pose, error);
    ++try_.claims;
    if (!error.wrong() && !try_.found()) {
      try_.first_right = frame;
      try_.right = error;
    }
    try_.wrong += error.wrong();
    if (error.m + error.deg / 20.0 < try_.worst.m + try_.worst.deg / 20.0) return;
    try_.worst = error;
    try_.T_world_body_worst = pose.T_world_body;
  }

 private:
  void add_held(const PoseEstimate& pose, const PoseError& error) {
    const double sigma_m = std::sqrt(pose.covariance.topLeftCorner<3, 3>().trace());
    ++try_.held_wrong;
    try_.held_uncovered += error.m > 3.0 * sigma_m;
  }

  Try& try_;
  int frames_to_lost_;
  bool holding_;
};

// Tries of one kind added up.
struct Tally {
  int tries = 0, found = 0, silent = 0, wrong = 0, held_wrong = 0;
  std::vector<double> frames, m, deg;

  void add(const Try& tried) {
    ++tries;
    found += tried.found();
    silent += tried.claims == 0;
    wrong += tried.any_wrong();
    held_wrong += tried.held_wrong > 0;
    if (!tried.found()) return;
    frames.push_back(tried.first_right + 1);
    m.push_back(tried.right.m);
    deg.push_back(tried.right.deg);
  }
  static void print_head() {
    std::printf("%-24s %5s %6s %7s %6s %5s %10s %5s %8s %8s %8s\n", "place, view", "tries", "found", "%", "silent",
                "WRONG", "frames p50", "p95", "m p50", "p95", "deg p50");
  }
  void print(const std::string& name) const {
    std::printf("%-24s %5d %6d %7.1f %6d %5d %10.0f %5.0f %8.4f %8.4f %8.3f\n", name.c_str(), tries, found,
                tries == 0 ? 0.0 : 100.0 * found / tries, silent, wrong, quantile(frames, 0.5), quantile(frames, 0.95),
                quantile(m, 0.5), quantile(m, 0.95), quantile(deg, 0.5));
  }
};

// The steps only of tries that went wrong.
inline nlohmann::ordered_json to_json(const Try& t) {
  nlohmann::ordered_json json{{"place", kPlaceNames[static_cast<int>(t.place)]},
                              {"known", kKnownNames[static_cast<int>(t.known)]},
                              {"x", t.drift.x},
                              {"y", t.drift.y},
                              {"yaw", t.drift.yaw},
                              {"surfaces", t.share.surfaces},
                              {"seen", t.share.seen},
                              {"alike", t.share.alike},
                              {"twin_difference", t.twin_difference},
                              {"first_right_frame", t.first_right},
                              {"error_m", t.right.m},
                              {"error_deg", t.right.deg},
                              {"claims", t.claims},
                              {"wrong", t.wrong},
                              {"worst_m", t.worst.m},
                              {"worst_deg", t.worst.deg},
                              {"held_wrong", t.held_wrong},
                              {"held_uncovered", t.held_uncovered},
                              {"last_state", to_string(t.last)}};
  if (!t.any_wrong()) return json;
  for (const Step& step : t.steps) {
    json["steps"].push_back({{"state", to_string(step.state)},
                             {"landmarks", step.landmarks},
                             {"keyframe", step.keyframe},
                             {"m", step.error.m},
                             {"deg", step.error.deg}});
  }
  return json;
}

}  // namespace povslam
