// The library from above: the map's surface in grey, the boxes coloured by consistency (red 0 … green 1), events.
#pragma once

#include <filesystem>

#include "tools/povslam/replay_run.hpp"

namespace povslam {

Status draw_objects(const std::filesystem::path& file, const ReplayRecord& record);

}  // namespace povslam
