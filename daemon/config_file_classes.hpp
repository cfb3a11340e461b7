// Class tables from TOML files and from what a driver says of its labels. The format, with all keys, is in
// docs/labels.md:
//
//   name = "warehouse"
//   class = [
//     {id = 0, name = "unlabelled", kind = "ignore"},
//     {id = 1, name = "floor", kind = "structure"},
//     {id = 2, name = "pallet", kind = "semi_static", max_extent_m = 1.5},
//   ]
//
// Read strictly: an unknown key, a bad value, an id or name that comes twice is an error that begins with file:line.
#pragma once

#include <optional>
#include <string>
#include <string_view>

#include "daemon/config.hpp"
#include "drivers/label_table.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/objects/class_table.hpp"

namespace povslam {

// A built-in table (synthetic, torwic, coco, geometric), else a file.
Result<ClassTable> load_class_table(const std::string& name_or_file);

// The same from text; `file` names it in messages.
Result<ClassTable> parse_class_table(std::string_view text, const std::string& file);

// A driver's rows, or the built-in table that it names.
Result<ClassTable> class_table_of(const LabelTable& table);

// The table that labels.classes means. "auto": what the driver told; when it told nothing, that of geometric
// segmentation, unless labels come from elsewhere (labels.socket, labels.lcm_channel): then it must be named.
Result<ClassTable> choose_class_table(const LabelConfig& config, const std::optional<LabelTable>& told);

}  // namespace povslam
