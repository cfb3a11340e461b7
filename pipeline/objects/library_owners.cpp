// Whose pixels, whose landmarks.
#include <algorithm>
#include <cmath>
#include <utility>

#include "pipeline/objects/library.hpp"

namespace povslam {

void ObjectLibrary::erase(std::int64_t id, std::int64_t heir, LibraryStep& step) {
  std::erase_if(objects_, [id](const auto& object) { return object->id == id; });
  std::erase_if(halves_, [id](const auto& pair) { return pair.first.first == id || pair.first.second == id; });
  std::erase(step.changed, id);
  step.removed.push_back(id);
  for (auto it = owner_of_landmark_.begin(); it != owner_of_landmark_.end();) {
    if (it->second.object != id) {
      ++it;
      continue;
    }
    step.owners.push_back({it->first, it->second.slot, heir});
    if (heir >= 0) {
      it->second.object = heir;
      ++it;
    } else {
      it = owner_of_landmark_.erase(it);
    }
  }
}

// A thing that moved is known by the id it had.
void ObjectLibrary::rename(std::int64_t came, std::int64_t gone, LibraryStep& step) {
  std::ranges::replace(step.changed, came, gone);
  step.removed.push_back(came);
  std::erase(step.removed, gone);
  for (const auto& object : objects_) {
    if (object->id == came) object->id = gone;
  }
  for (auto& [landmark, owned] : owner_of_landmark_) {
    if (owned.object != came) continue;
    owned.object = gone;
    step.owners.push_back({landmark, owned.slot, gone});
  }
  for (auto& [pixels, owner] : object_of_owner_) {
    if (owner == came) owner = gone;
  }
}

std::vector<std::uint16_t> ObjectLibrary::mapped_owners() const {
  std::vector<std::uint16_t> owners;
  for (const std::uint16_t owner : integrated_) {
    const auto id = object_of_owner_.find(owner);
    const bool confirmed = id != object_of_owner_.end() && std::ranges::any_of(objects_, [&](const auto& object) {
                             return object->id == id->second && object->phase == ObjectPhase::confirmed;
                           });
    if (confirmed) owners.push_back(owner);
  }
  std::ranges::sort(owners);
  return owners;
}

void ObjectLibrary::claim_landmarks(const std::vector<SeenLandmark>& landmarks, const DepthView& view,
                                    LibraryStep& step) {
  for (const SeenLandmark& seen : landmarks) {
    const int x = static_cast<int>(std::lround(seen.x)), y = static_cast<int>(std::lround(seen.y));
    if (x < 0 || y < 0 || x >= view.owner.width() || y >= view.owner.height()) continue;
    const std::uint16_t pixel = view.owner.at(x, y);
    if (pixel == kMoving) {
      owner_of_landmark_.erase(seen.landmark);
      step.owners.push_back({seen.landmark, seen.slot, LandmarkOwner::kGone});
      continue;
    }
    const auto object = object_of_owner_.find(pixel);
    if (pixel == kNobody || (pixel >= kFirstInstance && object == object_of_owner_.end())) continue;
    const std::int64_t id = pixel == kStructure ? LandmarkOwner::kStructure : object->second;
    const auto [entry, fresh] = owner_of_landmark_.try_emplace(seen.landmark, Owned{-1, seen.slot});
    if (entry->second.object == id && entry->second.slot == seen.slot) continue;
    entry->second.slot = seen.slot;
    entry->second.object = id;
    step.owners.push_back({seen.landmark, seen.slot, id});
  }
}

}  // namespace povslam
