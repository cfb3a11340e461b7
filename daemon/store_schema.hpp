// The form of a store and how it came about: each version of the schema is a step from the one before, and an old store
// is brought forward by the steps it lacks. A newer store than we know is left alone.
#pragma once

#include "daemon/store_table.hpp"

namespace povslam {

inline constexpr int kSchemaVersion = 3;

// Of a store that is one: damage when the file is something else or its form is not that of its version; a fault that
// is none when it is newer than kSchemaVersion.
int checked_version(Database& database);

// Brings an empty database (version 0) or an older store to `version`, in one transaction.
void migrate(Database& database, int from, int version = kSchemaVersion);

}  // namespace povslam
