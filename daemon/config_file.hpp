// The configuration file (TOML) and the command line's --set. toml++'s door.
// Every message reads `file:line: key: what is wrong and what is allowed`.
#pragma once

#include <span>
#include <string>
#include <string_view>

#include "daemon/config.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

// `file` empty: the documented defaults. Overrides are "key=value" with the file's keys and checks, and
// "sensor.NAME.key=value"; later ones win.
Result<AppConfig> load_config(const std::string& file, std::span<const std::string> overrides);

// The same from text; `file` names it in messages.
Result<AppConfig> parse_config(std::string_view text, const std::string& file, std::span<const std::string> overrides);

// "x y z qx qy qz qw" -> pose; the quaternion is normalised.
Result<Rigid3> parse_pose(const std::string& text);

}  // namespace povslam
