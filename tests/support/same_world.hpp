// Whether what stands somewhere is the same to the last bit. Beside same_map.hpp.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "daemon/store_world_rows.hpp"

namespace povslam {

// Every row under its name.
inline std::map<std::string, Bytes> rows_of(const WorldContent& world) {
  std::map<std::string, Bytes> rows;
  const auto add = [&rows](const std::string& name, std::int64_t number, const auto& row) {
    const std::string key = name + " " + std::to_string(number);
    EXPECT_FALSE(rows.contains(key)) << key << " twice";
    write_row(row, rows[key]);
  };
  add("meta", 0, world.meta);
  for (const auto& row : world.objects) add("object", row.object.id, row);
  for (const auto& row : world.blocks) add("block", number_of(row).value(), row);
  for (const auto& row : world.empty_cells) add("cell", number_of(row).value(), row);
  for (const auto& row : world.events) add("event", row.seq, row);
  return rows;
}

inline testing::AssertionResult same_world(const WorldContent& a, const WorldContent& b) {
  const auto rows_a = rows_of(a), rows_b = rows_of(b);
  if (rows_a == rows_b) return testing::AssertionSuccess();
  for (const auto& [name, row] : rows_a) {
    const auto other = rows_b.find(name);
    if (other == rows_b.end()) return testing::AssertionFailure() << name << " is only in the first";
    if (other->second != row) return testing::AssertionFailure() << name << " differs";
  }
  for (const auto& [name, row] : rows_b) {
    if (!rows_a.contains(name)) return testing::AssertionFailure() << name << " is only in the second";
  }
  return testing::AssertionFailure();
}

}  // namespace povslam
