// The faces of boxes as a pinhole camera sees them.
//
// A point of a face is P = corner + s across + t down, s and t in [0, 1]. On the ray of a pixel P = z r, so
// [s, t, 1]^T / z = [across down corner]^-1 r: s/z, t/z and w = 1/z are affine in the pixel. A ray meets the face
// where w > 0 and 0 <= s/z <= w, 0 <= t/z <= w; the largest w along a ray is what the pixel sees.
#pragma once

#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <vector>

#include "drivers/synthetic/scene.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam::synthetic {

inline constexpr int kFacesPerPart = 6;

struct FaceShape {  // object frame; order +x -x +y -y +z -z
  Eigen::Vector3d corner, across, down, normal;
};
std::array<FaceShape, kFacesPerPart> faces_of(const Part& part);

struct Affine {  // value = x * px + y * py + constant
  double x = 0.0, y = 0.0, constant = 0.0;
  double at(double px, double py) const { return x * px + y * py + constant; }
};

struct Plane {
  Affine w;                 // inverse depth [1/m]
  double distance_m = 0.0;  // from the camera
};

struct ProjectedFace {
  Affine s, t;  // over z
  Plane plane;
  int row_begin = 0, row_end = 0;
  int object = 0;   // index into Scene::objects
  int surface = 0;  // 6 * part + face, within the object
  double light = 1.0;
};

// A camera somewhere: turns world geometry into faces on its image.
class View {
 public:
  View(const PinholeCamera& camera, const Rigid3& T_world_camera);  // distortion is not looked at

  // Appends the faces of the object that look at the camera and may reach into the image.
  void add_faces(const Object& object, int object_index, const Placement& placement,
                 std::vector<ProjectedFace>& faces) const;
  Plane floor() const;
  bool may_see(const Eigen::Vector3d& center_world, double radius_m) const;
  const PinholeCamera& camera() const { return camera_; }

 private:
  void find_rows(const std::array<Eigen::Vector3d, 4>& corners_camera, ProjectedFace& face) const;
  Affine over_pixels(const Eigen::Vector3d& over_ray) const;

  PinholeCamera camera_;
  Rigid3 T_camera_world_;
  Eigen::Vector3d p_world_;
  std::array<Eigen::Vector3d, 4> sides_;  // inward normals of the frustum's sides, camera frame
};

// All faces in view at that time; the buffer is kept between calls.
void find_faces(const Scene& scene, double time_s, const View& view, std::vector<ProjectedFace>& faces);

}  // namespace povslam::synthetic
