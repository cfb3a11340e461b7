// Variational EM beside tracking: which points of the last frames were matched to which landmarks of which objects goes
// out as a window; what comes back says which objects still are where they were (their landmarks' trust, by which
// tracking weighs them), and corrects the pose where tracking followed what had moved. One window is out at a time.
#pragma once

#include <cstdint>
#include <optional>
#include <unordered_map>
#include <vector>

#include "pipeline/frontend/landmark_search.hpp"
#include "pipeline/frontend/local_map.hpp"
#include "pipeline/frontend/map.hpp"
#include "pipeline/objects/view.hpp"
#include "pipeline/vem_counts.hpp"
#include "pipeline/vem_problem.hpp"
#include "pipeline/window_options.hpp"

namespace povslam {

class VemExchange {
 public:
  VemExchange(const PinholeCamera& camera, const FrontendOptions& frontend, const WindowOptions& options,
              const BeliefOptions& belief);

  // From Understanding.
  void know(const ObjectBelief& belief, ObjectTrust& trust);

  // A frame was tracked: takes it into the window. input: it as it came. T_odom_camera: continuous.
  void look(const Map& map, const LocalMap& around, const RgbdFrame& input, const Frame& frame,
            const Rigid3& T_odom_camera);
  void forget() { frames_.clear(), due_ = false; }  // no pose: no odometry either

  // The window up to the frame looked at last; null: none is due, it holds no object, or one is out.
  VemProblem* take(const Map& map);
  void give_back(VemProblem* problem);

  // A frame begins: what was given back enters. Returns how the world as tracking sees it would have to move
  // (T_new_old), when that is certain.
  std::optional<Rigid3> apply(ObjectTrust& trust);
  // The map was moved under the window that is out: its answer says nothing of the pose any more.
  void map_moved() { outdated_ = true; }

  void doubted(std::vector<std::int64_t>& objects) const;  // those in the last window that are not believed
  const VemCounts& counts() const { return counts_; }

 private:
  struct Known {
    ObjectBelief belief;
    double consistency = 1.0;  // E[v] of the last window that held it, else as stored
    int streak = 0;            // windows that said the same: accepted > 0, rejected < 0
    bool doubted = false;
    int standing = 0, missing = 0;  // landmarks in the frame at hand: something is where they are, nothing is
    double trust() const { return doubted ? 0.0 : consistency; }
  };
  struct Seen {
    std::int32_t landmark = kNone;
    std::uint32_t generation = 0;
    Eigen::Vector3d p_camera = Eigen::Vector3d::Zero();
    double sigma_m = 0.0;
  };
  struct WindowFrame {
    Rigid3 T_world_camera, T_odom_camera;
    std::vector<Seen> seen;
  };

  void see(const Map& map, const Frame& frame, int feature, std::int32_t landmark, WindowFrame& into);
  void find_missing(const Map& map, const LocalMap& around, const RgbdFrame& input, const Frame& frame);
  void look_elsewhere(const Map& map, const Frame& frame, WindowFrame& into);
  void note_elsewhere(const Map& map, const Frame& frame, int feature, std::int32_t slot, const WindowFrame& into);
  void keep_agreeing(const Map& map, const Frame& frame, WindowFrame& into);
  void share_out(const Map& map, WindowFrame& frame);
  bool fill(const Map& map);
  VemObject as_object(std::int64_t id) const;
  void add_motion();
  void add_objects(const Map& map);
  void add_matches(const Map& map);
  void judge(std::size_t object, ObjectTrust& trust);
  int num_in_place(const Rigid3& T_world_camera) const;
  std::optional<Rigid3> correction() const;

  PinholeCamera camera_;
  WindowOptions options_;
  double match_variance_, depth_noise_;  // m^2; sigma_z = this * z^2
  LandmarkSearch search_;
  Matcher matcher_;
  std::unordered_map<std::int64_t, Known> known_;
  std::vector<WindowFrame> frames_;  // oldest first
  std::vector<WindowFrame> spare_;
  std::int64_t frame_index_ = 0, last_taken_ = -1;
  bool due_ = false;

  enum class State { idle, out, answered } state_ = State::idle;
  bool outdated_ = false;
  int correcting_ = 0;  // windows in a row that said tracking is elsewhere
  VemProblem problem_;
  VemCounts counts_;

  struct Entry {  // of a landmark in the window
    std::int64_t object = -1;
    std::int32_t slot = kNone;
  };
  struct Elsewhere {  // a landmark's look, found not where it should be
    std::int64_t object = -1;
    std::int32_t slot = kNone;
    int feature = -1;
    Eigen::Vector3d moved = Eigen::Vector3d::Zero();
  };
  std::vector<Entry> entries_;
  std::vector<Elsewhere> elsewhere_;
  std::vector<std::int32_t> index_of_landmark_;  // by slot, in the window
  std::vector<std::int32_t> wanted_;             // landmarks of objects to be looked for further away
  std::vector<std::int64_t> found_at_;           // by slot: frame that found it
};

}  // namespace povslam
