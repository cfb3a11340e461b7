// Puts one TOML value into the option that its key names: type, range and choices are checked here, nowhere else.
#pragma once

#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>

#include "daemon/config_keys.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

// The value as it stands in the file, for messages.
inline std::string shown(const toml::node& node) {
  std::ostringstream text;
  text << toml::toml_formatter{node};
  std::string line = text.str();
  for (char& c : line) c = c == '\n' ? ' ' : c;
  return line.size() > 60 ? line.substr(0, 57) + "..." : line;
}

// One assignment per type. False: the node is not what the key takes.
template <class Config>
struct Assign {
  const Key<Config>& key;
  const toml::node& node;

  bool in_range(double value) const { return std::isfinite(value) && value >= key.min && value <= key.max; }

  bool operator()(bool& out) const {
    const auto value = node.value_exact<bool>();
    if (value) out = *value;
    return value.has_value();
  }
  bool operator()(int& out) const {
    const auto value = node.value_exact<std::int64_t>();
    if (!value || !in_range(static_cast<double>(*value))) return false;
    out = static_cast<int>(*value);
    return true;
  }
  bool operator()(double& out) const {
    if (!node.is_number() || !in_range(*node.value<double>())) return false;
    out = *node.value<double>();
    return true;
  }
  bool operator()(std::string& out) const {
    const auto value = node.value_exact<std::string>();
    if (!value || !in_range(static_cast<double>(value->size()))) return false;
    const auto& choices = key.choices;
    if (!choices.empty() && std::find(choices.begin(), choices.end(), *value) == choices.end()) return false;
    out = *value;
    return true;
  }
  bool operator()(std::uint8_t& out) const {
    const auto value = node.value_exact<std::string>();
    const auto choice = value ? std::ranges::find(key.choices, *value) : key.choices.end();
    if (choice == key.choices.end()) return false;
    out = static_cast<std::uint8_t>(choice - key.choices.begin());
    return true;
  }
  template <std::size_t N>
  bool operator()(std::array<double, N>& out) const {
    const toml::array* array = node.as_array();
    if (array == nullptr || array->size() != N) return false;
    std::array<double, N> values{};
    double squared_norm = 0.0;
    for (std::size_t i = 0; i < N; ++i) {
      if (!Assign{key, (*array)[i]}(values[i])) return false;
      squared_norm += values[i] * values[i];
    }
    if (N == 4 && std::abs(squared_norm - 1.0) > 2e-3) return false;  // four numbers are a quaternion
    out = values;
    return true;
  }
  template <class T>
  bool operator()(std::optional<T>& out) const {
    T value{};
    if (!(*this)(value)) return false;
    out = value;
    return true;
  }
};

template <class Config>
std::string wanted(const Key<Config>& key) {
  const bool quaternion = key.path.ends_with("q_xyzw");
  return describe(key) + (quaternion ? ", a unit quaternion" : "");
}

// `place` begins the message of a value that does not fit.
template <class Config>
Status assign(const Key<Config>& key, Config& config, const toml::node& node, const std::string& place) {
  const bool fits = std::visit([&](auto member) { return Assign<Config>{key, node}(member(config)); }, key.member);
  if (fits) return Done{};
  return Error{place + ": " + key.path + ": expected " + wanted(key) + ", got " + shown(node)};
}

}  // namespace povslam
