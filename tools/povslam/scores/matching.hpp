// One-to-one matching of what is true with what was reported.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <vector>

namespace povslam::scores {

struct MatchedPair {
  std::size_t truth = 0, reported = 0;  // indices
  double cost = 0.0;                    // lower is better
};

// As many pairs as possible (augmenting paths, Kuhn 1955 / Berge 1957); cheap candidates are served first.
// By truth's index.
std::vector<MatchedPair> match_one_to_one(std::vector<MatchedPair> candidates, std::size_t num_truth,
                                          std::size_t num_reported);

struct Verdict {
  std::vector<MatchedPair> matched;  // of required truths
  std::size_t truth = 0;             // required ones
  std::size_t reported = 0;          // without the excused
  std::size_t excused = 0;  // reports left over that match a truth which is not required: neither right nor wrong
};

// required: one flag per truth. cost(truth, reported): nothing where the two cannot be one thing.
Verdict judge(const std::vector<char>& required, std::size_t num_reported,
              const std::function<std::optional<double>(std::size_t, std::size_t)>& cost);

}  // namespace povslam::scores
