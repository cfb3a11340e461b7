#include "tools/povslam/object_snapshots.hpp"

#include <algorithm>

namespace povslam {
namespace {

constexpr std::int32_t kMaxParts = 100000;  // as many as memory for a list of them is spent on

}  // namespace

std::optional<std::vector<object_t>> ObjectSnapshots::add(const object_list_t& part) {
  if (part.parts < 1 || part.parts > kMaxParts || part.part < 0 || part.part >= part.parts) return std::nullopt;
  const auto count = static_cast<std::size_t>(part.parts);
  if (part.session_id != session_ || part.snapshot > snapshot_) {
    session_ = part.session_id;
    snapshot_ = part.snapshot;
    told_ = false;
    parts_.assign(count, std::nullopt);
  }
  if (part.snapshot != snapshot_ || parts_.size() != count || told_) return std::nullopt;
  parts_[static_cast<std::size_t>(part.part)] = part;
  if (!std::all_of(parts_.begin(), parts_.end(), [](const auto& p) { return p.has_value(); })) return std::nullopt;
  std::vector<object_t> objects;
  for (const auto& p : parts_) objects.insert(objects.end(), p->objects.begin(), p->objects.end());
  if (objects.size() != static_cast<std::size_t>(part.num_total)) return std::nullopt;
  told_ = true;
  return objects;
}

}  // namespace povslam
