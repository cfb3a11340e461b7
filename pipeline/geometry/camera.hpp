// Pinhole camera with Brown-Conrady distortion (k1 k2 p1 p2 k3, as OpenCV and the TUM benchmark order them).
// Frame: x right, y down, z forward. Pixel (0, 0) is the centre of the top left pixel.
#pragma once

#include <Eigen/Core>
#include <array>
#include <optional>

namespace povslam {

struct PinholeCamera {
  int width = 0;                                  // px
  int height = 0;                                 // px
  double fx = 0.0, fy = 0.0, cx = 0.0, cy = 0.0;  // px
  std::array<double, 5> distortion{};             // k1 k2 p1 p2 k3, all zero: none

  bool distorted() const;
  bool valid() const { return width > 0 && height > 0 && fx > 0.0 && fy > 0.0; }

  // Point on the plane z = 1 before the lens -> after the lens.
  Eigen::Vector2d distort(const Eigen::Vector2d& ideal) const;
  // Inverse, by Newton's method to 1e-9. What no point is seen at (outside a barrel lens) gives some finite point.
  Eigen::Vector2d undistort(const Eigen::Vector2d& seen) const;

  // Camera point -> pixel as the sensor delivers it (distorted). Nothing for z <= 0 or where the lens model folds back
  // on itself (far outside the view, points would seem to lie inside); the image bounds are not checked.
  std::optional<Eigen::Vector2d> project(const Eigen::Vector3d& p_camera) const;
  // Pixel as delivered -> direction with z = 1.
  Eigen::Vector3d unproject(const Eigen::Vector2d& pixel) const;
  // Pixel as delivered -> where an undistorted camera of the same intrinsics would see it.
  Eigen::Vector2d rectify(const Eigen::Vector2d& pixel) const;

  bool contains(const Eigen::Vector2d& pixel) const {
    return pixel.x() >= 0.0 && pixel.y() >= 0.0 && pixel.x() <= width - 1.0 && pixel.y() <= height - 1.0;
  }
};

}  // namespace povslam
