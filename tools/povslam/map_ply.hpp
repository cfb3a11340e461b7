// A map as a cloud of coloured points: binary little-endian PLY, for any viewer.
#pragma once

#include <filesystem>

#include "daemon/store.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

// Landmarks in the grey of their look (white without one); keyframes, if wanted, as red points behind them. World, m.
Status write_map_ply(const std::filesystem::path& file, const MapContent& map, bool keyframes);

}  // namespace povslam
