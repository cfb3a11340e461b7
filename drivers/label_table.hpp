// What the ids of a driver's label images mean, as plain rows: drivers know nothing of objects.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace povslam {

struct LabelClass {
  std::uint16_t id = 0;
  std::string name;
  std::string kind;   // ignore, structure, static_object, semi_static, dynamic
  std::string where;  // "file:line", for messages
};

struct LabelTable {
  std::string name;                 // as in LabelFrame::table_name
  std::vector<LabelClass> classes;  // empty: the built-in table of that name
};

}  // namespace povslam
