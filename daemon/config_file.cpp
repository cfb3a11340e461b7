#include "daemon/config_file.hpp"

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <type_traits>

#include "daemon/config_file_assign.hpp"
#include "daemon/config_keys.hpp"

namespace povslam {
namespace {

std::string place_of(const std::string& file, const toml::node& node) {
  return file + ":" + std::to_string(node.source().begin.line);
}

template <class Config>
const Key<Config>* find_key(std::span<const Key<Config>> keys, std::string_view path) {
  for (const Key<Config>& key : keys) {
    if (key.path == path) return &key;
  }
  return nullptr;
}

std::vector<std::string> known_paths() {
  std::vector<std::string> paths;
  for (const auto& key : config_keys()) paths.push_back(key.path);
  return paths;
}

std::vector<std::string> known_sections() {
  std::set<std::string> sections{"sensor"};
  for (const auto& key : config_keys()) sections.insert(key.path.substr(0, key.path.find('.')));
  return {sections.begin(), sections.end()};
}

Error unknown(const std::string& place, const std::string& name, std::span<const std::string> known) {
  const std::string meant = nearest_name(name, known);
  return Error{place + ": " + name + ": unknown key" +
               (meant.empty() ? "; `povslamd --print-config` lists all" : ", did you mean " + meant + "?")};
}

// Fills an AppConfig from a document and overrides, remembering where each key was set for the checks between keys.
class Reader {
 public:
  explicit Reader(std::string file) : file_(std::move(file)) {}

  Status read(const toml::table& document) {
    for (const auto& [name, node] : document) {
      const Status status = read_section(std::string(name.str()), node);
      if (!status) return status;
    }
    return Done{};
  }

  Status override_with(const std::string& text) {
    const std::size_t equals = text.find('=');
    if (equals == std::string::npos) return Error{"--set " + text + ": expected key=value"};
    const std::string path = trimmed(text.substr(0, equals));
    const std::string value = trimmed(text.substr(equals + 1));
    if (path.starts_with("sensor.")) return override_sensor(path, value);
    const Key<AppConfig>* key = find_key(config_keys(), path);
    if (key == nullptr) return unknown("--set", path, known_paths());
    set_at_[path] = "--set";
    return with_value(*key, value, [&](const toml::node& node) { return assign(*key, config_, node, "--set"); });
  }

  Result<AppConfig> finish() {
    for (const OrderRule& rule : order_rules()) {
      const double low = number(rule.low), high = number(rule.high);
      if (low <= high) continue;
      const std::string& key = set_at_.contains(rule.low) ? rule.low : rule.high;
      std::ostringstream text;
      text << set_at_[key] << ": " << key << ": " << rule.low << " (" << low << ") must not exceed " << rule.high
           << " (" << high << ")";
      return Error{text.str()};
    }
    if (config_.sensors.empty())
      return Error{file_ + ": sensor: no [[sensor]] table; `povslamd --print-config` shows one"};
    if (config_.sensors.size() > 1) {
      return Error{config_.sensors[1].where +
                   ": sensor: one camera is used for tracking; remove this [[sensor]] table"};
    }
    return config_;
  }

 private:
  static std::string trimmed(const std::string& text) {
    const std::size_t begin = text.find_first_not_of(" \t");
    if (begin == std::string::npos) return "";
    return text.substr(begin, text.find_last_not_of(" \t") - begin + 1);
  }

  Status read_section(const std::string& section, const toml::node& node) {
    if (section == "sensor") return read_sensors(node);
    const std::vector<std::string> sections = known_sections();
    const std::string place = place_of(file_, node);
    if (std::find(sections.begin(), sections.end(), section) == sections.end())
      return unknown(place, section, sections);
    const toml::table* table = node.as_table();
    if (table == nullptr)
      return Error{place + ": " + section + ": expected a [" + section + "] table, got " + shown(node)};
    for (const auto& [name, value] : *table) {
      const std::string path = section + "." + std::string(name.str());
      const std::string at = place_of(file_, value);
      const Key<AppConfig>* key = find_key(config_keys(), path);
      if (key == nullptr) return unknown(at, path, known_paths());
      set_at_[path] = at;
      const Status status = assign(*key, config_, value, at);
      if (!status) return status;
    }
    return Done{};
  }

  Status read_sensors(const toml::node& node) {
    const toml::array* tables = node.as_array();
    if (tables == nullptr || !tables->is_homogeneous(toml::node_type::table)) {
      return Error{place_of(file_, node) + ": sensor: expected [[sensor]] tables, got " + shown(node)};
    }
    for (const toml::node& element : *tables) {
      SensorConfig sensor;
      sensor.where = place_of(file_, element);
      for (const auto& [name, value] : *element.as_table()) {
        const Status status = set_in(sensor, std::string(name.str()), value, place_of(file_, value));
        if (!status) return status;
      }
      if (sensor.driver.empty()) return Error{sensor.where + ": sensor.driver: missing; it names the kind of sensor"};
      config_.sensors.push_back(std::move(sensor));
    }
    return Done{};
  }

  Status set_in(SensorConfig& sensor, const std::string& name, const toml::node& value, const std::string& place) {
    if (const Key<SensorConfig>* key = find_key(sensor_keys(), name)) {
      sensor.has_mount = sensor.has_mount || (name != "name" && name != "driver");
      if (name == "driver") sensor.option_where[name] = place;
      const Status status = assign(*key, sensor, value, place);
      if (status && sensor.q_xyzw && sensor.rpy_deg)
        return Error{place + ": " + name + ": give q_xyzw or rpy_deg, not both"};
      return status;
    }
    if (!value.is_value())
      return Error{place + ": " + name + ": expected text, a number or true or false, got " + shown(value)};
    sensor.options[name] = value.is_string() ? **value.as_string() : shown(value);
    sensor.option_where[name] = place;
    return Done{};
  }

  Status override_sensor(const std::string& path, const std::string& value) {
    const std::size_t dot = path.find('.', 7);
    const std::string name = path.substr(7, dot == std::string::npos ? dot : dot - 7);
    const std::string option = dot == std::string::npos ? "" : path.substr(dot + 1);
    for (SensorConfig& sensor : config_.sensors) {
      if (sensor.name != name || option.empty()) continue;
      if (option == "driver" && value != sensor.driver) {
        sensor.options.clear();
        sensor.option_where.clear();
      }
      const Key<SensorConfig>* key = find_key(sensor_keys(), option);
      const Key<SensorConfig> any{.path = option, .member = sensor_keys()[0].member, .doc = ""};
      return with_value(key != nullptr ? *key : any, value,
                        [&](const toml::node& node) { return set_in(sensor, option, node, "--set"); });
    }
    return Error{"--set: " + path + ": expected sensor.NAME.KEY with the name of a [[sensor]]"};
  }

  // Calls `use` with the text read as TOML; text that is no TOML value, or is meant for a text key, is a string.
  template <class Config, class Use>
  static Status with_value(const Key<Config>& key, const std::string& text, Use&& use) {
    const bool takes_text = std::holds_alternative<std::string& (*)(Config&)>(key.member);
    if (!takes_text || text.starts_with('"') || text.starts_with('\'')) {
      try {
        const toml::table table = toml::parse("value = " + text);
        if (table.size() == 1) return use(*table.get("value"));
      } catch (const toml::parse_error&) {  // then it is plain text
      }
    }
    return use(toml::value<std::string>(text));
  }

  double number(const std::string& path) {
    const Key<AppConfig>* key = find_key(config_keys(), path);
    EXPECTS(key != nullptr);
    const auto value = [this]<class Value>(Value& (*member)(AppConfig&)) -> double {
      if constexpr (std::is_arithmetic_v<Value>) return static_cast<double>(member(config_));
      EXPECTS(std::is_arithmetic_v<Value>);
      return 0.0;
    };
    return std::visit(value, key->member);
  }

  std::string file_;
  AppConfig config_;
  std::map<std::string, std::string> set_at_;
};

}  // namespace

Result<AppConfig> parse_config(std::string_view text, const std::string& file, std::span<const std::string> overrides) {
  Reader reader(file);
  try {
    const Status status = reader.read(toml::parse(text, file));
    if (!status) return status.error();
  } catch (const toml::parse_error& error) {
    return Error{file + ":" + std::to_string(error.source().begin.line) + ": " + std::string(error.description())};
  }
  for (const std::string& text_override : overrides) {
    const Status status = reader.override_with(text_override);
    if (!status) return status.error();
  }
  return reader.finish();
}

Result<AppConfig> load_config(const std::string& file, std::span<const std::string> overrides) {
  if (file.empty()) return parse_config(default_config_text(), "(defaults)", overrides);
  std::ifstream stream(file, std::ios::binary);
  std::ostringstream text;
  if (!(stream && text << stream.rdbuf())) {
    return Error{file + ": cannot be read; `povslamd --print-config > " + file + "` writes one with all defaults"};
  }
  return parse_config(text.str(), file, overrides);
}

Result<Rigid3> parse_pose(const std::string& text) {
  std::istringstream stream(text);
  std::array<double, 7> v{};
  for (double& value : v) stream >> value;
  std::string rest;
  const Eigen::Quaterniond q(v[6], v[3], v[4], v[5]);
  if (!stream || stream >> rest || !std::isfinite(v[0] + v[1] + v[2]) || !(std::abs(q.norm() - 1.0) < 1e-2)) {
    return Error{"\"" + text + "\": expected \"x y z qx qy qz qw\", metres and a unit quaternion"};
  }
  return Rigid3{q.normalized(), {v[0], v[1], v[2]}};
}

}  // namespace povslam
