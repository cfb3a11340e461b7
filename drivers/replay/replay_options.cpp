#include "drivers/replay/replay_options.hpp"

#include <charconv>

#include "drivers/replay/text_file.hpp"

namespace povslam {

namespace {

Error bad_value(const std::string& key, const std::string& value, const std::string& allowed) {
  return Error{"replay: " + key + " = '" + value + "': " + allowed + " is expected"};
}

bool parse_index(std::string_view text, std::optional<std::int64_t>& index) {
  index.reset();
  if (text.empty()) return true;
  std::int64_t value = 0;
  const auto [end, fault] = std::from_chars(text.begin(), text.end(), value);
  if (fault != std::errc{} || end != text.end() || std::abs(value) > 1'000'000'000'000) return false;
  index = value;
  return true;
}

bool parse_range(std::string_view text, FrameRange& range) {
  const std::size_t colon = text.find(':');
  return colon != std::string_view::npos && parse_index(text.substr(0, colon), range.begin) &&
         parse_index(text.substr(colon + 1), range.end);
}

std::optional<LabelChoice> parse_labels(const std::string& value) {
  if (value == "true") return LabelChoice::on;
  if (value == "false") return LabelChoice::off;
  if (value == "auto") return LabelChoice::automatic;
  return std::nullopt;
}

}  // namespace

Result<ReplayOptions> parse_replay_options(const DriverOptions& options) {
  ReplayOptions parsed;
  for (const auto& [key, value] : options) {
    if (key == "path") {
      parsed.sequence.folder = value;
    } else if (key == "camera") {
      parsed.sequence.camera = value;
    } else if (key == "frames") {
      if (!parse_range(value, parsed.frames))
        return bad_value(key, value, "A:B with whole numbers or nothing on either side");
    } else if (key == "realtime") {
      if (value != "true" && value != "false") return bad_value(key, value, "true or false");
      parsed.realtime = value == "true";
    } else if (key == "labels") {
      const std::optional<LabelChoice> labels = parse_labels(value);
      if (!labels) return bad_value(key, value, "true, false or auto");
      parsed.sequence.labels = *labels;
    } else if (key == "association_tolerance_s") {
      const std::optional<double> tolerance_s = parse_number(value);
      if (!tolerance_s || *tolerance_s < 0.0 || *tolerance_s > 10.0)
        return bad_value(key, value, "a number from 0 to 10");
      parsed.sequence.association_tolerance_s = *tolerance_s;
    } else {
      return Error{"replay: unknown key '" + key +
                   "'; known are path, camera, frames, realtime, labels, association_tolerance_s"};
    }
  }
  if (parsed.sequence.folder.empty())
    return Error{"replay: path is missing; it names the folder of a recorded sequence"};
  return parsed;
}

}  // namespace povslam
