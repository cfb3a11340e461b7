#include "drivers/replay/sequence.hpp"

#include <algorithm>

namespace povslam {

namespace {

namespace fs = std::filesystem;

std::int64_t clamp_index(std::optional<std::int64_t> index, std::int64_t otherwise, std::int64_t count) {
  if (!index) return otherwise;
  return std::clamp<std::int64_t>(*index < 0 ? *index + count : *index, 0, count);
}

}  // namespace

Result<Sequence> read_sequence(const SequenceOptions& options) {
  std::error_code fault;
  if (!fs::is_directory(options.folder, fault)) {
    return Error{options.folder.string() + ": no such folder; path must name a recorded sequence"};
  }
  return is_torwic_folder(options.folder) ? read_torwic_folder(options) : read_tum_folder(options);
}

Status cut_sequence(Sequence& sequence, const FrameRange& range) {
  std::vector<SequenceEntry>& main = sequence.sensors.front().entries;
  const auto count = static_cast<std::int64_t>(main.size());
  const std::int64_t begin = clamp_index(range.begin, 0, count);
  const std::int64_t end = clamp_index(range.end, count, count);
  if (begin >= end) {
    return Error{"frames: the range holds none of the " + std::to_string(count) + " frames of " + sequence.description};
  }
  const std::optional<TimeNs> from =
      begin > 0 ? std::optional(main[static_cast<std::size_t>(begin)].stamp) : std::nullopt;
  const std::optional<TimeNs> until =
      end < count ? std::optional(main[static_cast<std::size_t>(end)].stamp) : std::nullopt;
  for (SequenceSensor& sensor : sequence.sensors) {
    std::erase_if(sensor.entries, [&](const SequenceEntry& entry) {
      return (from && entry.stamp < *from) || (until && entry.stamp >= *until);
    });
  }
  return Done{};
}

}  // namespace povslam
