// Lists of stamped files (rgb.txt, depth.txt, label.txt, lidar.txt) and how two of them are paired.
#pragma once

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {

struct ListedFile {
  TimeNs stamp = 0;
  std::string file;       // as written, relative to the list's folder
  std::uint64_t seq = 0;  // which entry of the list it is, from 0, unusable lines counted
  std::string where;      // "list:line"
};

struct FileList {
  std::vector<ListedFile> files;    // stamps strictly increase
  std::vector<std::string> faults;  // lines left out: not "stamp file", or a stamp for the second time
};

// Lines "stamp file". Stamps out of order are sorted with one warning in the log. Only a list that cannot be opened is
// an error.
Result<FileList> read_file_list(const std::filesystem::path& path);

struct ListedPair {
  ListedFile color, depth;
};
struct PairList {
  std::vector<ListedPair> pairs;  // colour stamps strictly increase
  std::vector<std::string> faults;
};

// associations.txt: lines "t_color color_file t_depth depth_file".
Result<PairList> read_associations(const std::filesystem::path& path);

// One-to-one pairs of nearest stamps, closest pairs first (as the TUM benchmark's associate), none further apart than
// the tolerance. Indices into a and b, in the order of a.
std::vector<std::pair<std::size_t, std::size_t>> associate(std::span<const ListedFile> a, std::span<const ListedFile> b,
                                                           TimeNs tolerance);

}  // namespace povslam
