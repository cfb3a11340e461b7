// Files of a replay: trajectory.txt, trajectory_smoothed.txt, metrics.json, and trajectory.png beside ground truth.
#pragma once

#include <filesystem>

#include "tools/povslam/replay_run.hpp"

namespace povslam {

// Creates `out`. Refuses one inside the sequence or around it, so that nothing recorded is ever written over.
Status make_output_folder(const std::filesystem::path& out, const std::filesystem::path& sequence);

Status write_replay(const std::filesystem::path& out, const std::filesystem::path& sequence,
                    const ReplayRecord& record);

}  // namespace povslam
