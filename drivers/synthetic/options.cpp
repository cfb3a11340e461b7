#include "drivers/synthetic/options.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <functional>

namespace povslam::synthetic {

namespace {

Error bad(const std::string& key, const std::string& what) {
  return Error{"synthetic: '" + key + "' " + what};
}

template <class Number>
bool read_number(const std::string& text, Number& value) {
  const char* end = text.data() + text.size();
  const auto [stop, error] = std::from_chars(text.data(), end, value);
  return error == std::errc{} && stop == end;
}

bool read_bool(const std::string& text, bool& value) {
  if (text != "true" && text != "false") return false;
  value = text == "true";
  return true;
}

std::string quoted(const std::string& text) {
  return "is '" + text + "'";
}

Status check_range(const char* key, double value, double low, double high) {
  if (std::isfinite(value) && value >= low && value <= high) return Done{};
  const auto text = [](double number) {
    std::string digits = std::to_string(number);
    digits.erase(digits.find_last_not_of('0') + 1);
    if (digits.back() == '.') digits.pop_back();
    return digits;
  };
  return bad(key, "is " + text(value) + "; it must lie in " + text(low) + " … " + text(high));
}

// Intrinsics that were not given follow the image size, so that the angle of view stays.
void scale_intrinsics(const DriverOptions& given, PinholeCamera& camera) {
  const PinholeCamera standard = SyntheticOptions{}.camera;
  if (!given.contains("fx")) camera.fx = standard.fx * camera.width / standard.width;
  if (!given.contains("fy")) camera.fy = given.contains("fx") ? camera.fx : standard.fy * camera.width / standard.width;
  if (!given.contains("cx")) camera.cx = 0.5 * (camera.width - 1);
  if (!given.contains("cy")) camera.cy = 0.5 * (camera.height - 1);
}

}  // namespace

std::vector<std::string> scene_names() {
  return {"boxsim", "static", "aisle", "majority", "adversarial", "twins", "rooms", "hall"};
}

Status validate(const SyntheticOptions& options) {
  const std::vector<std::string> scenes = scene_names();
  if (std::find(scenes.begin(), scenes.end(), options.scene) == scenes.end()) {
    std::string known;
    for (const std::string& name : scenes) known += (known.empty() ? "" : ", ") + name;
    return bad("scene", quoted(options.scene) + "; known scenes: " + known);
  }
  const struct {
    const char* key;
    double value, low, high;
  } ranges[] = {{"laps", options.laps, 0.01, 1e6},
                {"width", static_cast<double>(options.camera.width), 16, 4096},
                {"height", static_cast<double>(options.camera.height), 16, 4096},
                {"fx", options.camera.fx, 1, 1e5},
                {"fy", options.camera.fy, 1, 1e5},
                {"cx", options.camera.cx, -1e4, 1e4},
                {"cy", options.camera.cy, -1e4, 1e4},
                {"fps", options.fps, 1, 1000},
                {"speed_mps", options.speed_mps, 0.01, 5},
                {"noise", options.noise, 0, 10},
                {"max_depth_m", options.max_depth_m, 0.5, 65},
                {"movers", static_cast<double>(options.movers), 0, 20},
                {"start_time_s", options.start_time_s, 0, 4e9}};
  for (const auto& range : ranges) {
    const Status status = check_range(range.key, range.value, range.low, range.high);
    if (!status) return status;
  }
  return Done{};
}

Result<SyntheticOptions> parse_options(const DriverOptions& given) {
  SyntheticOptions options;
  PinholeCamera& camera = options.camera;
  const auto number = [](auto& value) {
    return std::function([&value](const std::string& text) { return read_number(text, value); });
  };
  const auto flag = [](bool& value) {
    return std::function([&value](const std::string& text) { return read_bool(text, value); });
  };
  const std::map<std::string, std::function<bool(const std::string&)>> keys = {
      {"scene", [&options](const std::string& text) { return options.scene = text, true; }},
      {"seed", number(options.seed)},
      {"laps", number(options.laps)},
      {"width", number(camera.width)},
      {"height", number(camera.height)},
      {"fx", number(camera.fx)},
      {"fy", number(camera.fy)},
      {"cx", number(camera.cx)},
      {"cy", number(camera.cy)},
      {"fps", number(options.fps)},
      {"speed_mps", number(options.speed_mps)},
      {"noise", number(options.noise)},
      {"noise_seed", number(options.noise_seed)},
      {"blur", flag(options.blur)},
      {"max_depth_m", number(options.max_depth_m)},
      {"labels", flag(options.labels)},
      {"lidar", flag(options.lidar)},
      {"changes", flag(options.changes)},
      {"movers", number(options.movers)},
      {"realtime", flag(options.realtime)},
      {"start_time_s", number(options.start_time_s)},
      {"frames", number(options.frames)}};
  for (const auto& [key, text] : given) {
    const auto entry = keys.find(key);
    if (entry == keys.end()) {
      std::string known;
      for (const auto& [name, read] : keys) known += (known.empty() ? "" : ", ") + name;
      return bad(key, "is not a key of this driver; known keys: " + known);
    }
    if (!entry->second(text)) return bad(key, quoted(text) + ", which cannot be read as a value of it");
  }
  scale_intrinsics(given, camera);
  const Status status = validate(options);
  if (!status) return status.error();
  return options;
}

}  // namespace povslam::synthetic
