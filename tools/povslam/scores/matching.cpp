#include "tools/povslam/scores/matching.hpp"

#include <algorithm>
#include <optional>

namespace povslam::scores {
namespace {

class Matcher {
 public:
  Matcher(const std::vector<MatchedPair>& candidates, std::size_t num_truth, std::size_t num_reported)
      : of_truth_(num_truth), taken_by_(num_reported) {
    for (const MatchedPair& candidate : candidates) of_truth_[candidate.truth].push_back(candidate);
  }

  // Gives `truth` a partner, moving others aside where that loses none.
  bool place(std::size_t truth, std::vector<char>& tried) {
    for (const MatchedPair& candidate : of_truth_[truth]) {
      if (tried[candidate.reported]) continue;
      tried[candidate.reported] = 1;
      std::optional<MatchedPair>& holder = taken_by_[candidate.reported];
      if (!holder || place(holder->truth, tried)) {
        holder = candidate;
        return true;
      }
    }
    return false;
  }

  std::vector<MatchedPair> matches() const {
    std::vector<MatchedPair> found;
    for (const std::optional<MatchedPair>& match : taken_by_) {
      if (match) found.push_back(*match);
    }
    std::sort(found.begin(), found.end(), [](const MatchedPair& x, const MatchedPair& y) { return x.truth < y.truth; });
    return found;
  }

 private:
  std::vector<std::vector<MatchedPair>> of_truth_;  // cheapest first
  std::vector<std::optional<MatchedPair>> taken_by_;
};

}  // namespace

std::vector<MatchedPair> match_one_to_one(std::vector<MatchedPair> candidates, std::size_t num_truth,
                                          std::size_t num_reported) {
  std::stable_sort(candidates.begin(), candidates.end(),
                   [](const MatchedPair& x, const MatchedPair& y) { return x.cost < y.cost; });
  Matcher matcher(candidates, num_truth, num_reported);
  std::vector<char> seen(num_truth, 0);
  for (const MatchedPair& candidate : candidates) {  // the truth with the cheapest candidate is served first
    if (seen[candidate.truth]) continue;
    seen[candidate.truth] = 1;
    std::vector<char> tried(num_reported, 0);
    matcher.place(candidate.truth, tried);
  }
  return matcher.matches();
}

Verdict judge(const std::vector<char>& required, std::size_t num_reported,
              const std::function<std::optional<double>(std::size_t, std::size_t)>& cost) {
  std::vector<MatchedPair> wanted, tolerated;
  Verdict verdict;
  for (std::size_t i = 0; i < required.size(); ++i) {
    verdict.truth += required[i] ? 1 : 0;
    for (std::size_t j = 0; j < num_reported; ++j) {
      if (const std::optional<double> price = cost(i, j)) (required[i] ? wanted : tolerated).push_back({i, j, *price});
    }
  }
  verdict.matched = match_one_to_one(wanted, required.size(), num_reported);
  std::vector<char> used(num_reported, 0);
  for (const MatchedPair& pair : verdict.matched) used[pair.reported] = 1;
  std::erase_if(tolerated, [&used](const MatchedPair& pair) { return used[pair.reported] != 0; });
  verdict.excused = match_one_to_one(tolerated, required.size(), num_reported).size();
  verdict.reported = num_reported - verdict.excused;
  return verdict;
}

}  // namespace povslam::scores
