// Whether two maps are the same to the last bit.
#pragma once

#include <gtest/gtest.h>

#include <map>
#include <string>

#include "daemon/store_rows.hpp"

namespace povslam {

// Every row under its name.
inline std::map<std::string, Bytes> rows_of(const MapContent& map) {
  std::map<std::string, Bytes> rows;
  const auto add = [&rows](const std::string& name, const auto& row) {
    EXPECT_FALSE(rows.contains(name)) << name << " twice";
    write_row(row, rows[name]);
  };
  add("meta", StoredMeta{.map = map.meta});
  for (const auto& row : map.features) add("features " + std::to_string(row.keyframe), row);
  for (const auto& row : map.keyframes) add("keyframe " + std::to_string(row.keyframe), row);
  for (const auto& row : map.landmarks) add("landmark " + std::to_string(row.landmark), row);
  for (const auto& row : map.looks) add("look " + std::to_string(row.landmark), row);
  return rows;
}

inline testing::AssertionResult same_map(const MapContent& a, const MapContent& b) {
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
