// Stamps of a recording's colour frames.
#pragma once

#include <filesystem>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"

namespace povslam::scores {

struct ListedFrame {
  TimeNs stamp = 0;
  std::filesystem::path color_file;  // relative to the sequence
};

// From associations.txt if the sequence has one, else from rgb.txt; sorted by stamp, equal stamps once.
Result<std::vector<ListedFrame>> read_frame_list(const std::filesystem::path& sequence);

}  // namespace povslam::scores
