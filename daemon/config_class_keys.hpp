// The one table of the keys of a class, as config_keys.hpp is of the configuration's.
#pragma once

#include "daemon/config_keys.hpp"
#include "pipeline/objects/class_table.hpp"

namespace povslam {

struct ClassEntry {  // a class as its file says it
  int id = -1;
  std::string name, kind;
  double prior_alpha = 0.0, prior_beta = 0.0, k_inlier = 0.0, k_outlier = 0.0;
  double min_extent_m = 0.0, max_extent_m = 0.0;
  bool one_piece = false;
  std::array<double, 3> rgb{};
};

std::span<const Key<ClassEntry>> class_keys();

}  // namespace povslam
