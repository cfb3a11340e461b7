// The one table of configuration keys. Parsing, range checks, unknown-key errors, --set and the documented default
// file all come from it.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <variant>
#include <vector>

#include "daemon/config.hpp"

namespace povslam {

// Where a key's value lives in Config; the alternative is the key's type.
template <class Config>
using Member = std::variant<bool& (*)(Config&), int& (*)(Config&), double& (*)(Config&), std::string& (*)(Config&),
                            std::uint8_t& (*)(Config&),  // an enumeration: which of the choices
                            std::array<double, 3>& (*)(Config&), std::array<double, 4>& (*)(Config&),
                            std::optional<std::array<double, 3>>& (*)(Config&),
                            std::optional<std::array<double, 4>>& (*)(Config&)>;

template <class Config>
struct Key {
  std::string path;  // "section.name", ends in the unit
  Member<Config> member;
  std::string doc;
  double min = 0.0, max = 1.0;            // of numbers, of each element of an array, of a text's length
  std::vector<std::string> choices = {};  // of text, empty: any; of an enumeration, in its order
};

// Two keys whose order matters: value of `low` must not exceed that of `high`.
struct OrderRule {
  std::string low, high;
};

std::span<const Key<AppConfig>> config_keys();
std::span<const Key<SensorConfig>> sensor_keys();  // of a [[sensor]] table; its other keys go to the driver
std::span<const OrderRule> order_rules();

// What a key takes, for messages and the documentation: "an integer from 1 to 12".
template <class Config>
std::string describe(const Key<Config>& key);

// The known name that `unknown` most likely meant; empty when nothing is near.
std::string nearest_name(std::string_view unknown, std::span<const std::string> known);

// The documented file with all defaults: config/povslam.toml is this text.
std::string default_config_text();

}  // namespace povslam
