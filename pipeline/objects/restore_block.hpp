// A volume's block from its row.
#pragma once

#include "pipeline/mapping/volume.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

// Rows of another length than a block's are left out, as are blocks the volume has no room for.
void restore_block(const VoxelBlockRow& row, Volume& volume);

}  // namespace povslam
