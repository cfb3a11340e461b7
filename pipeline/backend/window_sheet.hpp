// A window as the kernels read it: landmarks in blocks of lanes by object, matches dense over the frames.
#pragma once

#include <vector>

#include "pipeline/backend/kernels/kernels.hpp"
#include "pipeline/backend/vem_options.hpp"
#include "pipeline/backend/window.hpp"

namespace povslam {

// What is solved for. Landmarks are block, axis; errors block, frame.
struct VemEstimate {
  struct Object {
    Eigen::Vector3d position = Eigen::Vector3d::Zero();
    double yaw = 0.0;
  };
  std::vector<Rigid3> poses;
  std::vector<Object> objects;
  std::vector<Quad> landmarks;
  std::vector<Quad> error2;  // squared residual of each match [m^2]
};

class WindowSheet {
 public:
  struct Object {
    int first_block = 0, num_blocks = 0;
    bool rigid = false;     // has a pose to be solved for
    bool free_yaw = false;  // and its landmarks say how it is turned
  };

  void assign(const VemWindow& window, const VemOptions& options);  // of a window without fault
  // Sigmas of matches count as at least this.
  void set_least_sigma(double sigma_m);
  double smallest_sigma() const { return smallest_sigma_; }
  VemEstimate initial(const VemWindow& window) const;

  int num_frames() const { return num_frames_; }
  int dimension() const { return dimension_; }
  double sigma_rigid_m() const { return sigma_rigid_m_; }
  double sigma_prior_m() const { return sigma_prior_m_; }
  const std::vector<Object>& objects() const { return objects_; }
  std::size_t num_blocks() const { return prior_weight_.size(); }
  std::size_t num_slots() const { return inverse_variance_.size(); }

  VemBlocks blocks(std::size_t object, const Quad* information) const;
  VemNoise noise(std::size_t object) const;
  bool matched(std::size_t slot, int lane) const { return inverse_variance_[slot].lane[lane] > 0.0; }
  struct Noise {
    double inverse_variance, bias;  // 0: no match
  };
  Noise noise_at(std::size_t slot, int lane) const;
  std::size_t first_slot(std::size_t object) const;
  int slots_of(std::size_t object) const { return objects_[object].num_blocks * num_frames_; }

  // Places in the arrays, in lanes: of a match in one by block and frame; of a landmark's x in one by block and axis.
  std::size_t lane_of_match(const VemMatch& match) const;
  Eigen::Vector3d landmark(const std::vector<Quad>& landmarks, std::size_t index) const;
  void set_landmark(std::vector<Quad>& landmarks, std::size_t index, const Eigen::Vector3d& p) const;

 private:
  void place_landmarks(const VemWindow& window);
  void place_matches(const VemWindow& window);

  int num_frames_ = 0, dimension_ = 3;
  double log_uniform_ = 0.0, sigma_rigid_m_ = 0.0, sigma_prior_m_ = 0.0;
  double smallest_sigma_ = 0.0, most_inverse_ = 0.0, its_bias_ = 0.0;
  std::vector<Object> objects_;
  std::vector<int> lane_of_landmark_;
  std::vector<Quad> p_camera_, inverse_variance_, bias_;               // by block, frame (, axis)
  std::vector<Quad> p_object_, p_prev_, prior_weight_, rigid_weight_;  // by block (, axis)
};

}  // namespace povslam
