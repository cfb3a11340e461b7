// From a path to an open database that is known to be a sound map store. All throw StoreFault.
#pragma once

#include <filesystem>
#include <memory>

#include "daemon/store.hpp"
#include "daemon/store_sql.hpp"

namespace povslam {

bool has_log(const std::filesystem::path& file);  // commits may stand there that the file does not have

// Makes an empty store under another name and gives it its own when it is whole: a process that dies in between leaves
// no half store. A log without its store is set aside.
void create_if_missing(const std::filesystem::path& file);

// read_only: also on a read-only disk, if nobody writes.
std::unique_ptr<Database> open_database(const std::filesystem::path& file, StoreMode mode);

// Checks structure and form; brings an older store forward if it may. Returns the version.
int prepare(Database& database, StoreMode mode);

// Renames what there is of a store out of the way, removes the oldest of those set aside before, and says so in the
// log. Returns the new name.
std::filesystem::path set_aside(const std::filesystem::path& file, const std::string& why);

}  // namespace povslam
