// Scores of several runs as one: counts are summed and their ratios taken again; trajectory errors get median and
// range.
#pragma once

#include <filesystem>
#include <nlohmann/json.hpp>
#include <vector>

#include "pipeline/base/result.hpp"

namespace povslam::scores {

// Files as `povslam evaluate` writes them. A section counts the runs that have it.
Result<nlohmann::ordered_json> pool_scores(const std::vector<std::string>& files);

}  // namespace povslam::scores
