// The documented default file, written from the table.
#include <spdlog/fmt/fmt.h>

#include <type_traits>

#include "daemon/config_class_keys.hpp"
#include "daemon/config_keys.hpp"

namespace povslam {
namespace {

constexpr const char* kHeader =
    "# povslamd's configuration. Every key stands here with its default; `povslamd --print-config` prints this file.\n"
    "# A key left out keeps its default; an unknown key or a bad value stops the daemon with file and line.\n"
    "# Keys end in their unit. Each can be set on the command line too: --set track.search_radius_px=20\n";

constexpr const char* kSensor = R"(
# The camera. `name` is its role on the robot, `driver` its kind; every key but these two and the mount belongs to
# the driver. The default is a simulated camera, so that the daemon runs out of the box: a robot names its own here.
# Mount (T_body_sensor; body x forward, y left, z up): translation_m = [x, y, z] and one of
#   rpy_deg = [roll, pitch, yaw] of the housing (x out of the lens, z up; pitch > 0 looks down)
#   q_xyzw = [x, y, z, w] of the camera itself (x right, y down, z forward)
# Without these: as the driver's own calibration says, else at the body's origin, level, looking forward.
# On the command line: --set sensor.front.KEY=VALUE (setting `driver` drops the options of the one before).
[[sensor]]
name = "front"
driver = "synthetic"
scene = "aisle"
)";

std::string format_value(bool value) {
  return value ? "true" : "false";
}
std::string format_value(int value) {
  return fmt::format("{}", value);
}
std::string format_value(double value) {
  std::string text = fmt::format("{}", value);
  return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
}
std::string format_value(const std::string& value) {
  return '"' + value + '"';
}
template <std::size_t N>
std::string format_value(const std::array<double, N>& values) {
  std::string text;
  for (const double value : values) text += (text.empty() ? "[" : ", ") + format_value(value);
  return text + "]";
}
template <class T>
std::string format_value(const std::optional<T>& value) {
  return value ? format_value(*value) : "";
}

// Of an enumeration, its name.
std::string format_value(const std::uint8_t value, const std::vector<std::string>& choices) {
  return format_value(choices.at(value));
}
template <class T>
std::string format_value(const T& value, const std::vector<std::string>&) {
  return format_value(value);
}

std::string section_of(const std::string& path) {
  return path.substr(0, path.find('.'));
}

std::string describe_array(std::size_t size, double min, double max) {
  return fmt::format("{} numbers from {} to {}", size, min, max);
}

}  // namespace

template <class Config>
std::string describe(const Key<Config>& key) {
  const auto for_type = [&key]<class Value>(Value& (*)(Config&)) -> std::string {
    if constexpr (std::is_same_v<Value, bool>) return "true or false";
    if constexpr (std::is_same_v<Value, int>) return fmt::format("an integer from {} to {}", key.min, key.max);
    if constexpr (std::is_same_v<Value, double>) return fmt::format("a number from {} to {}", key.min, key.max);
    if constexpr (std::is_same_v<Value, std::string> || std::is_same_v<Value, std::uint8_t>) {
      if (!key.choices.empty()) return fmt::format("one of \"{}\"", fmt::join(key.choices, "\", \""));
      return fmt::format("text of {} to {} letters", key.min, key.max);
    }
    if constexpr (requires(Value v) { v.has_value(); }) {
      return describe_array(typename Value::value_type{}.size(), key.min, key.max);
    } else if constexpr (requires(Value v) { v.front() = 0.0; }) {
      return describe_array(Value{}.size(), key.min, key.max);
    }
  };
  return std::visit(for_type, key.member);
}
template std::string describe(const Key<AppConfig>& key);
template std::string describe(const Key<SensorConfig>& key);
template std::string describe(const Key<ClassEntry>& key);

std::string default_config_text() {
  AppConfig defaults;
  std::string text = kHeader;
  std::string section;
  for (const Key<AppConfig>& key : config_keys()) {
    if (section_of(key.path) != section) {
      section = section_of(key.path);
      text += "\n[" + section + "]\n";
    }
    const std::string value =
        std::visit([&](auto member) { return format_value(member(defaults), key.choices); }, key.member);
    text += fmt::format("# {}; {}\n{} = {}\n", key.doc, describe(key), key.path.substr(section.size() + 1), value);
  }
  return text + kSensor;
}

}  // namespace povslam
