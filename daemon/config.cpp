#include "daemon/config.hpp"

#include <cctype>
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

std::string store_file(const MapConfig& config, const char* state_folder) {
  if (config.store != "auto") return config.store;
  const std::string folders = state_folder == nullptr ? "" : state_folder;
  return folders.empty() ? "" : folders.substr(0, folders.find(':')) + "/map.db";
}

namespace {

// Where `word` stands alone in `text`, npos if nowhere.
std::size_t find_word(const std::string& text, const std::string& word) {
  const auto part_of_word = [&text](std::size_t i) {
    return i < text.size() && (std::isalnum(static_cast<unsigned char>(text[i])) != 0 || text[i] == '_');
  };
  for (std::size_t at = text.find(word); at != std::string::npos; at = text.find(word, at + 1)) {
    if ((at == 0 || !part_of_word(at - 1)) && !part_of_word(at + word.size())) return at;
  }
  return std::string::npos;
}

}  // namespace

std::string SensorConfig::locate(const std::string& message) const {
  std::size_t first = std::string::npos;  // the option named first is the one complained about
  std::string place = where;
  for (const auto& [option, option_place] : option_where) {
    const std::size_t at = find_word(message, option);
    if (at >= first) continue;
    first = at;
    place = option_place;
  }
  return place + ": sensor." + name + ": " + message;
}

}  // namespace povslam
