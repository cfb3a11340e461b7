#include "drivers/replay/camera_file.hpp"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <functional>

#include "drivers/replay/camera_presets.hpp"
#include "drivers/replay/text_file.hpp"

namespace povslam {

namespace {

constexpr std::size_t kMaxYamlBytes = std::size_t{1} << 20;
constexpr int kMaxImageSide_px = 8192;
constexpr double kMaxQuaternionLengthError = 1e-3;

// What is wrong with a value; caught in load(), which adds the file.
struct Fault {
  int line;  // from 1; 0: none
  std::string message;
};

int line_of(const YAML::Node& node) {
  return node.Mark().is_null() ? 0 : node.Mark().line + 1;
}

double number(const YAML::Node& node) {
  const std::optional<double> value = node.IsScalar() ? parse_number(node.Scalar()) : std::nullopt;
  if (!value) throw Fault{line_of(node), "a number is expected"};
  return *value;
}

double positive(const YAML::Node& node) {
  const double value = number(node);
  if (!(value > 0.0)) throw Fault{line_of(node), "a number above 0 is expected"};
  return value;
}

int pixels(const YAML::Node& node) {
  const double value = number(node);
  if (value < 1.0 || value > kMaxImageSide_px || value != std::floor(value)) {
    throw Fault{line_of(node), "a whole number from 1 to " + std::to_string(kMaxImageSide_px) + " is expected"};
  }
  return static_cast<int>(value);
}

template <std::size_t count>
std::array<double, count> numbers(const YAML::Node& node) {
  if (!node.IsSequence() || node.size() != count) {
    throw Fault{line_of(node), "a list of " + std::to_string(count) + " numbers is expected"};
  }
  std::array<double, count> values{};
  for (std::size_t i = 0; i < count; ++i) values[i] = number(node[i]);
  return values;
}

using Readers = std::map<std::string, std::function<void(const YAML::Node&)>>;

// Calls each key's reader; a key without reader or given twice is a fault.
void read_map(const YAML::Node& node, Readers readers) {
  if (!node.IsMap()) throw Fault{line_of(node), "keys with values are expected, as in 'fx: 525'"};
  for (const auto& entry : node) {
    if (!entry.first.IsScalar()) throw Fault{line_of(entry.first), "a key is expected"};
    const std::string& key = entry.first.Scalar();
    const auto reader = readers.find(key);
    if (reader == readers.end()) throw Fault{line_of(entry.first), key + ": unknown key, or given twice"};
    try {
      reader->second(entry.second);
    } catch (const Fault& fault) {
      throw Fault{fault.line > 0 ? fault.line : line_of(entry.first), key + ": " + fault.message};
    }
    readers.erase(reader);
  }
}

Rigid3 rigid(const YAML::Node& node) {
  std::optional<std::array<double, 3>> t;
  std::optional<std::array<double, 4>> q;
  read_map(node, {{"translation", [&](const YAML::Node& value) { t = numbers<3>(value); }},
                  {"q_xyzw", [&](const YAML::Node& value) { q = numbers<4>(value); }}});
  if (!t || !q) throw Fault{line_of(node), "translation and q_xyzw are expected"};
  const Eigen::Quaterniond rotation((*q)[3], (*q)[0], (*q)[1], (*q)[2]);
  if (!(std::abs(rotation.norm() - 1.0) <= kMaxQuaternionLengthError)) {
    throw Fault{line_of(node), "q_xyzw has length " + std::to_string(rotation.norm()) + ", not 1"};
  }
  return {rotation.normalized(), {(*t)[0], (*t)[1], (*t)[2]}};
}

void require_all(const std::vector<std::pair<const char*, bool>>& keys) {
  for (const auto& [key, given] : keys) {
    if (!given) throw Fault{0, std::string(key) + " is missing"};
  }
}

CameraFile camera(const YAML::Node& root) {
  CameraFile file;
  DepthCamera depth;
  bool depth_scale = false, T_color_depth = false;
  std::optional<double> cx, cy, depth_cx, depth_cy;
  const auto to = [](auto& target, auto read) {
    return [&target, read](const YAML::Node& value) { target = read(value); };
  };
  PinholeCamera& c = file.color;
  PinholeCamera& d = depth.camera;
  read_map(root,
           {{"width", to(c.width, pixels)},
            {"height", to(c.height, pixels)},
            {"fx", to(c.fx, positive)},
            {"fy", to(c.fy, positive)},
            {"cx", to(cx, number)},
            {"cy", to(cy, number)},
            {"distortion", to(c.distortion, numbers<5>)},
            {"depth_scale", [&](const YAML::Node& v) { file.depth_scale = positive(v), depth_scale = true; }},
            {"fps", to(file.fps, positive)},
            {"rolling_shutter_s", to(file.rolling_shutter_s, number)},
            {"gravity_world",
             [&](const YAML::Node& v) {
               const auto g = numbers<3>(v);
               file.gravity_world = Eigen::Vector3d(g[0], g[1], g[2]);
             }},
            {"depth_width", to(d.width, pixels)},
            {"depth_height", to(d.height, pixels)},
            {"depth_fx", to(d.fx, positive)},
            {"depth_fy", to(d.fy, positive)},
            {"depth_cx", to(depth_cx, number)},
            {"depth_cy", to(depth_cy, number)},
            {"T_color_depth", [&](const YAML::Node& v) { depth.T_color_depth = rigid(v), T_color_depth = true; }}});
  require_all({{"width", c.width > 0},
               {"height", c.height > 0},
               {"fx", c.fx > 0.0},
               {"fy", c.fy > 0.0},
               {"cx", cx.has_value()},
               {"cy", cy.has_value()},
               {"depth_scale", depth_scale}});
  c.cx = *cx, c.cy = *cy;
  const bool own_depth_camera =
      d.width > 0 || d.height > 0 || d.fx > 0.0 || d.fy > 0.0 || depth_cx || depth_cy || T_color_depth;
  if (!own_depth_camera) return file;
  require_all({{"depth_fx", d.fx > 0.0},
               {"depth_fy", d.fy > 0.0},
               {"depth_cx", depth_cx.has_value()},
               {"depth_cy", depth_cy.has_value()},
               {"T_color_depth", T_color_depth}});
  if (d.width == 0) d.width = c.width;
  if (d.height == 0) d.height = c.height;
  d.cx = *depth_cx, d.cy = *depth_cy;
  file.depth = depth;
  return file;
}

std::map<std::string, Rigid3> sensors(const YAML::Node& root) {
  constexpr std::string_view kPrefix = "T_body_";
  std::map<std::string, Rigid3> poses;
  Readers readers;
  if (root.IsMap()) {
    for (const auto& entry : root) {
      const std::string key = entry.first.IsScalar() ? entry.first.Scalar() : "";
      if (!key.starts_with(kPrefix) || key.size() == kPrefix.size()) {
        throw Fault{line_of(entry.first), key + ": unknown key; keys are T_body_<sensor>"};
      }
      readers[key] = [&poses, name = key.substr(kPrefix.size())](const YAML::Node& v) { poses[name] = rigid(v); };
    }
  }
  read_map(root, readers);
  return poses;
}

template <class Read>
auto load(const std::string& yaml, const std::string& name, Read read) -> Result<decltype(read(YAML::Node()))> {
  const auto at = [&name](int line) { return name + (line > 0 ? ":" + std::to_string(line) : "") + ": "; };
  try {
    return read(YAML::Load(yaml));
  } catch (const Fault& fault) {
    return Error{at(fault.line) + fault.message};
  } catch (const YAML::Exception& fault) {
    return Error{at(fault.mark.is_null() ? 0 : fault.mark.line + 1) + fault.msg};
  }
}

template <class Read>
auto load_file(const std::filesystem::path& path, Read read) -> Result<decltype(read(YAML::Node()))> {
  std::vector<char> text;
  if (const Status status = read_bytes(path, kMaxYamlBytes, text); !status) return status.error();
  return load(std::string(text.begin(), text.end()), path.string(), read);
}

}  // namespace

Result<CameraFile> parse_camera(const std::string& yaml, const std::string& name) {
  return load(yaml, name, camera);
}

Result<CameraFile> read_camera_file(const std::filesystem::path& path) {
  return load_file(path, camera);
}

Result<std::map<std::string, Rigid3>> read_sensors_file(const std::filesystem::path& path) {
  return load_file(path, sensors);
}

std::vector<std::string> camera_preset_names() {
  std::vector<std::string> names;
  for (const CameraPreset& preset : camera_presets()) names.emplace_back(preset.name);
  return names;
}

Result<CameraFile> find_camera(const std::string& preset_or_path) {
  std::string known;
  for (const CameraPreset& preset : camera_presets()) {
    if (preset_or_path == preset.name) return parse_camera(preset.yaml, "preset " + preset_or_path);
    known += std::string(known.empty() ? "" : ", ") + preset.name;
  }
  if (is_file(preset_or_path)) return read_camera_file(preset_or_path);
  return Error{"camera: '" + preset_or_path + "' is neither a file nor a preset (" + known + ")"};
}

}  // namespace povslam
