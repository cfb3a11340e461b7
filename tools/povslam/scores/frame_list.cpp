#include "tools/povslam/scores/frame_list.hpp"

#include <algorithm>

#include "drivers/replay/text_file.hpp"

namespace povslam::scores {

Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& sequence) {
  const std::filesystem::path associations = sequence / "associations.txt";
  const Result<TextFile> file = TextFile::read(is_file(associations) ? associations : sequence / "rgb.txt");
  if (!file) return file.error();
  std::vector<ListedFrame> frames;
  for (const TextLine& line : file->lines()) {
    const std::optional<TimeNs> stamp = parse_seconds(line.words.front());
    if (!stamp || line.words.size() < 2) return Error{file->at(line) + "expected `timestamp filename`"};
    frames.push_back({*stamp, std::filesystem::path(line.words[1])});
  }
  const auto by_stamp = [](const ListedFrame& a, const ListedFrame& b) { return a.stamp < b.stamp; };
  const auto same_stamp = [](const ListedFrame& a, const ListedFrame& b) { return a.stamp == b.stamp; };
  std::stable_sort(frames.begin(), frames.end(), by_stamp);
  frames.erase(std::unique(frames.begin(), frames.end(), same_stamp), frames.end());
  return frames;
}

}  // namespace povslam::scores
