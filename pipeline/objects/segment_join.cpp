#include "pipeline/objects/segment_join.hpp"

#include <algorithm>
#include <cmath>
#include <map>
#include <numeric>

namespace povslam {

namespace {

constexpr int kLookAcross = 6;     // cells
constexpr float kLevel_m = 0.06F;  // heights that meet
constexpr float kFlat_m = 0.12F, kFacing = 0.8F;
constexpr float kBroader = 1.4F;  // a plinth than what it carries, at most

enum class Role { none, lid, plinth };

Role role_of(const PartMeasure& part, float thickness_m) {
  const float height = part.top_m - part.bottom_m;
  if (part.up > kFacing && height < kFlat_m) return Role::lid;
  return height < thickness_m && part.on_floor > 0 ? Role::plinth : Role::none;
}

// What lies across the part's outline: below a lid, above a plinth, without a jump between.
void look(const SegmentGrid& grid, std::size_t i, std::ptrdiff_t step, float noise, std::map<int, int>& touched) {
  const int label = grid.label[i];
  std::size_t j = i;
  for (int k = 0; k < kLookAcross; ++k) {
    j += static_cast<std::size_t>(step);
    if (grid.label[j] == label) return;
    if (grid.w[j] <= 0.0F || grid.label[j] == kNoPart) continue;
    if (std::abs(grid.w[j] - grid.w[i]) < noise + 0.03F * grid.w[i] &&
        std::abs(grid.z[j] - grid.z[i]) < 2.0F * kLevel_m)
      ++touched[grid.label[j]];
    return;
  }
}

// For each part that is a lid or a plinth: how many cells of which part it touches there.
std::vector<std::map<int, int>> find_touched(const std::vector<Role>& roles, float noise, const SegmentGrid& grid) {
  std::vector<std::map<int, int>> touched(roles.size());
  for (int y = 1; y + 1 < grid.height; ++y) {
    for (int x = 0; x < grid.width; ++x) {
      const auto i = static_cast<std::size_t>(grid.index(x, y));
      if (grid.label[i] < kFirstPart) continue;
      const auto id = static_cast<std::size_t>(grid.label[i] - kFirstPart);
      if (roles[id] == Role::none) continue;
      look(grid, i, roles[id] == Role::lid ? grid.stride : -grid.stride, noise, touched[id]);
    }
  }
  return touched;
}

// other: null for structure.
bool belongs(Role role, const PartMeasure& part, const PartMeasure* other) {
  if (role == Role::lid) return other == nullptr || std::abs(other->top_m - part.top_m) < kLevel_m;
  if (other == nullptr) return false;
  return std::abs(other->bottom_m - part.top_m) < kLevel_m && part.length_m < kBroader * other->length_m;
}

}  // namespace

bool join_parts(const std::vector<PartMeasure>& measures, const SegmentOptions& options, SegmentGrid& grid) {
  std::vector<Role> roles;
  for (const PartMeasure& part : measures)
    roles.push_back(role_of(part, static_cast<float>(options.board_thickness_m)));
  const float noise = static_cast<float>(options.jump_sigmas) * smooth_sigma(options, grid);
  const std::vector<std::map<int, int>> touched = find_touched(roles, noise, grid);
  std::vector<int> renamed(measures.size() + kFirstPart);
  std::iota(renamed.begin(), renamed.end(), 0);
  bool any = false;
  for (std::size_t id = 0; id < measures.size(); ++id) {
    if (touched[id].empty()) continue;
    const int other = std::max_element(touched[id].begin(), touched[id].end(), [](const auto& a, const auto& b) {
                        return a.second < b.second;
                      })->first;
    const PartMeasure* measure = other < kFirstPart ? nullptr : &measures[static_cast<std::size_t>(other - kFirstPart)];
    if (!belongs(roles[id], measures[id], measure)) continue;
    renamed[id + kFirstPart] = other;
    any = true;
  }
  if (!any) return false;
  constexpr int kMostHops = 3;  // a lid on a load on a plinth
  for (int& label : grid.label) {
    for (int hop = 0; hop < kMostHops; ++hop) label = renamed[static_cast<std::size_t>(label)];
  }
  return true;
}

}  // namespace povslam
