#include "drivers/replay/file_list.hpp"

#include <algorithm>
#include <tuple>

#include "drivers/replay/text_file.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {

namespace {

constexpr std::size_t kCandidatesEachSide = 8;  // bounds the work on lists whose stamps are all alike

const ListedFile& stamped(const ListedFile& entry) {
  return entry;
}
const ListedFile& stamped(const ListedPair& entry) {
  return entry.color;
}

// Sorts by stamp, says so once if that was needed, and turns repeated stamps into faults.
template <class Entry>
void put_in_order(const std::filesystem::path& path, std::vector<Entry>& entries, std::vector<std::string>& faults) {
  const auto earlier = [](const Entry& a, const Entry& b) { return stamped(a).stamp < stamped(b).stamp; };
  if (!std::is_sorted(entries.begin(), entries.end(), earlier)) {
    log::warn("{}: lines are not in the order of their stamps; sorted", path.string());
    std::stable_sort(entries.begin(), entries.end(), earlier);
  }
  std::vector<Entry> kept;
  for (Entry& entry : entries) {
    if (!kept.empty() && stamped(kept.back()).stamp == stamped(entry).stamp) {
      faults.push_back(stamped(entry).where + ": has the stamp of " + stamped(kept.back()).where + "; left out");
    } else {
      kept.push_back(std::move(entry));
    }
  }
  entries = std::move(kept);
}

std::string where(const std::filesystem::path& path, const TextLine& line) {
  return path.string() + ":" + std::to_string(line.number);
}

}  // namespace

Result<FileList> read_file_list(const std::filesystem::path& path) {
  const Result<TextFile> text = TextFile::read(path);
  if (!text) return text.error();
  FileList list;
  std::uint64_t seq = 0;
  for (const TextLine& line : text->lines()) {
    const std::optional<TimeNs> stamp = parse_seconds(line.words[0]);
    if (line.words.size() == 2 && stamp) {
      list.files.push_back({*stamp, std::string(line.words[1]), seq, where(path, line)});
    } else {
      list.faults.push_back(text->at(line) + "not 'stamp file'; left out");
    }
    ++seq;
  }
  put_in_order(path, list.files, list.faults);
  return list;
}

Result<PairList> read_associations(const std::filesystem::path& path) {
  const Result<TextFile> text = TextFile::read(path);
  if (!text) return text.error();
  PairList list;
  std::uint64_t seq = 0;
  for (const TextLine& line : text->lines()) {
    const bool four = line.words.size() == 4;
    const std::optional<TimeNs> color = four ? parse_seconds(line.words[0]) : std::nullopt;
    const std::optional<TimeNs> depth = four ? parse_seconds(line.words[2]) : std::nullopt;
    if (color && depth) {
      const std::string at = where(path, line);
      list.pairs.push_back(
          {{*color, std::string(line.words[1]), seq, at}, {*depth, std::string(line.words[3]), seq, at}});
    } else {
      list.faults.push_back(text->at(line) + "not 't_rgb rgb_file t_depth depth_file'; left out");
    }
    ++seq;
  }
  put_in_order(path, list.pairs, list.faults);
  return list;
}

std::vector<std::pair<std::size_t, std::size_t>> associate(std::span<const ListedFile> a, std::span<const ListedFile> b,
                                                           TimeNs tolerance) {
  std::vector<std::tuple<TimeNs, std::size_t, std::size_t>> candidates;  // apart, index in a, index in b
  for (std::size_t i = 0; i < a.size(); ++i) {
    const auto nearest = std::ranges::lower_bound(b, a[i].stamp, {}, &ListedFile::stamp);
    const auto middle = static_cast<std::size_t>(nearest - b.begin());
    const std::size_t first = middle - std::min(middle, kCandidatesEachSide);
    const std::size_t last = std::min(middle + kCandidatesEachSide, b.size());
    for (std::size_t j = first; j < last; ++j) {
      const TimeNs apart = std::abs(a[i].stamp - b[j].stamp);
      if (apart <= tolerance) candidates.emplace_back(apart, i, j);
    }
  }
  std::ranges::sort(candidates);
  std::vector<bool> a_taken(a.size()), b_taken(b.size());
  std::vector<std::pair<std::size_t, std::size_t>> pairs;
  for (const auto& [apart, i, j] : candidates) {
    if (a_taken[i] || b_taken[j]) continue;
    a_taken[i] = b_taken[j] = true;
    pairs.emplace_back(i, j);
  }
  std::ranges::sort(pairs);
  return pairs;
}

}  // namespace povslam
