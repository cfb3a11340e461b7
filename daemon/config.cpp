#include "daemon/config.hpp"

#include <numbers>

namespace povslam {

Rigid3 PoseConfig::rigid() const {
  return {Eigen::Quaterniond(q_xyzw[3], q_xyzw[0], q_xyzw[1], q_xyzw[2]).normalized(),
          {translation_m[0], translation_m[1], translation_m[2]}};
}

Rigid3 SensorConfig::T_body_sensor() const {
  if (q_xyzw) return PoseConfig{translation_m, *q_xyzw}.rigid();
  Rigid3 T_body_housing = PoseConfig{translation_m}.rigid();
  if (rpy_deg) {
    const auto turn = [this](int index, const Eigen::Vector3d& axis) {
      return Eigen::AngleAxisd((*rpy_deg)[static_cast<std::size_t>(index)] * std::numbers::pi / 180.0, axis);
    };
    T_body_housing.rotation =
        turn(2, Eigen::Vector3d::UnitZ()) * turn(1, Eigen::Vector3d::UnitY()) * turn(0, Eigen::Vector3d::UnitX());
  }
  return T_body_housing * level_forward_camera();
}

std::string SensorConfig::locate(const std::string& message) const {
  for (const auto& [option, place] : option_where) {
    if (message.find(option) != std::string::npos) return place + ": " + message;
  }
  return where + ": sensor \"" + name + "\": " + message;
}

}  // namespace povslam
