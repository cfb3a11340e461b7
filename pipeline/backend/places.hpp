// Poses and objects of an estimate as the kernels read them. Lives for one pass.
#pragma once

#include <cmath>
#include <vector>

#include "pipeline/backend/kernels/dispatch.hpp"
#include "pipeline/backend/window_sheet.hpp"

namespace povslam {

class Places {
 public:
  explicit Places(const VemEstimate& estimate) : estimate_(estimate), R_p_(12 * estimate.poses.size()) {
    for (std::size_t t = 0; t < estimate.poses.size(); ++t) {
      using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;
      Eigen::Map<RowMajor>{&R_p_[12 * t]} = estimate.poses[t].matrix3();
      Eigen::Map<Eigen::Vector3d>{&R_p_[12 * t + 9]} = estimate.poses[t].translation;
    }
  }
  const VemPlaces& of(std::size_t object) {  // until the next call
    const VemEstimate::Object& at = estimate_.objects[object];
    places_ = {R_p_.data(), std::cos(at.yaw), std::sin(at.yaw), {at.position.x(), at.position.y(), at.position.z()}};
    return places_;
  }
  static Quad* landmarks(const WindowSheet& sheet, std::size_t object, VemEstimate& estimate) {
    return estimate.landmarks.data() + 3 * static_cast<std::size_t>(sheet.objects()[object].first_block);
  }

 private:
  const VemEstimate& estimate_;
  std::vector<double> R_p_;
  VemPlaces places_{};
};

}  // namespace povslam
