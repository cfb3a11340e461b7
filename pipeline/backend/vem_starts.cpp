#include "pipeline/backend/vem_starts.hpp"

#include <algorithm>
#include <cmath>
#include <optional>

namespace povslam {

namespace {

constexpr std::size_t kMaxObjects = 48;   // that count; the ones with most matches
constexpr std::size_t kMaxPartners = 16;  // of those, that starts are made of, alone and in pairs
constexpr std::size_t kMaxMatches = 12;   // of each object, spread over all it has
constexpr std::size_t kMinMatches = 3;
constexpr double kNear_m = 0.3;  // a match further from its landmark does not support a start
constexpr int kRefinements = 3;

struct Pair {
  Eigen::Vector3d map, seen;  // both world; seen by the window's poses as they are
};
using Thing = std::vector<Pair>;

// Turn about z and shift with the least squares, from sums over pairs.
class Alignment {
 public:
  void add(const Pair& pair, double weight) {
    weight_ += weight;
    map_ += weight * pair.map;
    seen_ += weight * pair.seen;
    cos_ += weight * (pair.map.x() * pair.seen.x() + pair.map.y() * pair.seen.y());
    sin_ += weight * (pair.map.y() * pair.seen.x() - pair.map.x() * pair.seen.y());
  }
  Rigid3 best() const {
    const Eigen::Vector3d a = map_ / weight_, b = seen_ / weight_;
    const double c = cos_ - weight_ * (a.x() * b.x() + a.y() * b.y());
    const double s = sin_ - weight_ * (a.y() * b.x() - a.x() * b.y());
    const Eigen::Quaterniond turn(Eigen::AngleAxisd(std::atan2(s, c), Eigen::Vector3d::UnitZ()));
    return {turn, a - turn * b};
  }
  bool enough() const { return weight_ > 0.0; }

 private:
  double weight_ = 0.0, cos_ = 0.0, sin_ = 0.0;
  Eigen::Vector3d map_ = Eigen::Vector3d::Zero(), seen_ = Eigen::Vector3d::Zero();
};

std::vector<Thing> things_of(const VemWindow& window) {
  std::vector<std::size_t> owner;
  for (std::size_t i = 0; i < window.objects.size(); ++i) {
    owner.insert(owner.end(), static_cast<std::size_t>(window.objects[i].num_landmarks), i);
  }
  std::vector<Thing> things(window.objects.size());
  for (const VemMatch& match : window.matches) {
    const auto landmark = static_cast<std::size_t>(match.landmark);
    const Eigen::Vector3d seen = window.poses[static_cast<std::size_t>(match.frame)] * match.p_camera;
    things[owner[landmark]].push_back({window.landmarks[landmark].p_prev, seen});
  }
  std::erase_if(things, [](const Thing& thing) { return thing.size() < kMinMatches; });
  std::ranges::stable_sort(things, [](const Thing& a, const Thing& b) { return a.size() > b.size(); });
  if (things.size() > kMaxObjects) things.resize(kMaxObjects);
  for (Thing& thing : things) {
    const std::size_t all = thing.size(), kept = std::min(all, kMaxMatches);
    for (std::size_t i = 0; i < kept; ++i) thing[i] = thing[i * all / kept];
    thing.resize(kept);
  }
  return things;
}

double closeness(const Pair& pair, const Rigid3& T) {  // 1 to 0
  const double share = (pair.map - T * pair.seen).squaredNorm() / (kNear_m * kNear_m);
  return share < 1.0 ? (1.0 - share) * (1.0 - share) : 0.0;
}

double support_of(const std::vector<Thing>& things, const Rigid3& T) {
  double sum = 0.0;
  for (const Thing& thing : things) {
    for (const Pair& pair : thing) sum += closeness(pair, T);
  }
  return sum;
}

// Where all matches that are near would rather have it, each counting by how near it is.
Rigid3 refined(const std::vector<Thing>& things, Rigid3 T) {
  for (int i = 0; i < kRefinements; ++i) {
    Alignment all;
    for (const Thing& thing : things) {
      for (const Pair& pair : thing) all.add(pair, std::sqrt(closeness(pair, T)));
    }
    if (!all.enough()) break;
    T = all.best();
  }
  return T;
}

std::vector<VemStart> candidates(const std::vector<Thing>& things) {
  std::vector<VemStart> all;
  const std::size_t partners = std::min(things.size(), kMaxPartners);
  for (std::size_t i = 0; i < partners; ++i) {
    for (std::size_t k = i; k < partners; ++k) {
      Alignment both;
      for (const Pair& pair : things[i]) both.add(pair, 1.0);
      if (k != i) {
        for (const Pair& pair : things[k]) both.add(pair, 1.0);
      }
      const Rigid3 T = both.best();
      all.push_back({T, support_of(things, T)});
    }
  }
  std::ranges::stable_sort(all, [](const VemStart& a, const VemStart& b) { return a.support > b.support; });
  return all;
}

// By how far the matches would lie apart, in the median over all that is seen: metres and turns in one measure.
double apart_m(const std::vector<Thing>& things, const Rigid3& a, const Rigid3& b) {
  std::vector<double> ways;
  for (const Thing& thing : things) ways.push_back((a * thing.front().seen - b * thing.front().seen).norm());
  std::ranges::nth_element(ways, ways.begin() + std::ssize(ways) / 2);
  return ways[ways.size() / 2];
}

}  // namespace

std::vector<VemStart> other_starts(const VemWindow& window, std::span<const Rigid3> solved, int count) {
  constexpr double kSame_m = 0.1;
  constexpr std::size_t kMaxRefined = 64;
  const std::vector<Thing> things = things_of(window);
  std::vector<VemStart> starts;
  if (things.size() < 2) return starts;
  const Rigid3 T_own = solved.back() * window.poses.back().inverse();
  std::vector<VemStart> some = candidates(things);
  some.resize(std::min(some.size(), kMaxRefined));
  for (VemStart& start : some) {
    start.T_start_window = refined(things, start.T_start_window);
    start.support = support_of(things, start.T_start_window);
  }
  std::ranges::stable_sort(some, [](const VemStart& a, const VemStart& b) { return a.support > b.support; });
  for (const VemStart& start : some) {
    if (std::ssize(starts) == count) break;
    const auto same = [&](const Rigid3& T) { return apart_m(things, T, start.T_start_window) < kSame_m; };
    if (same(T_own)) continue;
    if (std::ranges::any_of(starts, [&](const VemStart& other) { return same(other.T_start_window); })) continue;
    starts.push_back(start);
  }
  return starts;
}

}  // namespace povslam
