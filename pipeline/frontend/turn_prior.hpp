// How the camera turned between two images, from the images alone: thumbnails aligned by a pure rotation
// (inverse-compositional Gauss-Newton on brightness, coarse to fine). Survives blur and jerks that leave feature
// matching without a usable prediction; translation shows up as the turn that explains the picture's shift best.
#pragma once

#include <Eigen/Geometry>
#include <vector>

#include "pipeline/frontend/orb.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class TurnPrior {
 public:
  explicit TurnPrior(const PinholeCamera& camera);

  void look(const OrbExtractor& image);  // each frame: keeps this image's thumbnails and the previous ones

  // R_now_before: rotates directions of the previous camera into the present one. start: where to begin.
  // `agreement` is the correlation of the thumbnails after alignment: 1 = identical, below 0.5 not to be believed.
  struct Turn {
    Eigen::Quaterniond R_now_before = Eigen::Quaterniond::Identity();
    double agreement = 0.0;
  };
  Turn estimate(const Eigen::Quaterniond& start) const;

 private:
  struct Thumbnail {
    int width = 0, height = 0;
    double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;
    std::vector<float> now, before;
  };
  static void align(const Thumbnail& image, int iterations, Turn& turn);

  std::vector<Thumbnail> thumbnails_;  // coarse first
};

}  // namespace povslam
