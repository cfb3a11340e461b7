// classes.csv of a recording: a header line, then a class a line. Columns by name, in any order: id (0 to 255), name,
// and kind (ignore, structure, static_object, semi_static, dynamic); older recordings have movable instead (0 =
// structure, 1 = semi_static). Further columns are left alone. '#' comments and blank lines are skipped.
#pragma once

#include <filesystem>

#include "drivers/label_table.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

// The table is named after the path. An error names the line and what is allowed there.
Result<LabelTable> read_classes_file(const std::filesystem::path& path);

}  // namespace povslam
