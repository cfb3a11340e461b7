// What a replay learned of objects: objects.json, events.jsonl, map.ply.
#pragma once

#include <filesystem>

#include "tools/povslam/replay_run.hpp"

namespace povslam {

Status write_objects(const std::filesystem::path& out, const ReplayRecord& record);

}  // namespace povslam
