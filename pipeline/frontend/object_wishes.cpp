#include "pipeline/frontend/object_wishes.hpp"

#include <algorithm>

namespace povslam {
namespace {

constexpr std::size_t kMostThings = 64;
constexpr float kBelieved = 0.5F;
constexpr double kFarthest_m = 8.0;
constexpr float kGrow_px = 8.0F;       // the next frame sees it elsewhere by about so much
constexpr float kMostOfImage = 0.10F;  // what is larger has features enough by its cells

void extend(FeatureWish& extent, double x, double y) {
  const auto u = static_cast<float>(x), v = static_cast<float>(y);
  extent = {std::min(extent.x0, u), std::min(extent.y0, v), std::max(extent.x1, u), std::max(extent.y1, v)};
}

}  // namespace

ObjectWishes::ObjectWishes(const PinholeCamera& camera, int enough) : camera_(camera), enough_(enough) {
  things_.reserve(kMostThings);
  wishes_.reserve(kMostThings);
}

ObjectWishes::Thing* ObjectWishes::find(std::int64_t owner) {
  const auto thing = std::ranges::find(things_, owner, &Thing::owner);
  return thing == things_.end() ? nullptr : &*thing;
}

std::span<const FeatureWish> ObjectWishes::after(const Map& map, const LocalMap& local_map, const Frame& frame) {
  things_.clear();
  wishes_.clear();
  if (enough_ == 0) return {};
  const auto owner_of = [&](std::int32_t slot) { return slot == kNone ? -1 : map.landmark(slot).owner; };
  for (int i = 0; i < frame.size(); ++i) {
    const std::int32_t slot = frame.landmark[static_cast<std::size_t>(i)];
    const std::int64_t owner = owner_of(slot);
    if (owner <= 0 || map.trust(slot) < kBelieved) continue;
    const std::size_t k = static_cast<std::size_t>(i);
    if (Thing* thing = find(owner); thing != nullptr) {
      ++thing->seen;
    } else if (things_.size() < things_.capacity()) {
      things_.push_back({owner, 1, {frame.x[k], frame.y[k], frame.x[k], frame.y[k]}});
    }
  }
  std::erase_if(things_, [&](const Thing& thing) { return thing.seen >= enough_; });
  if (things_.empty()) return {};
  for (const std::int32_t slot : local_map.landmarks()) {
    Thing* thing = owner_of(slot) > 0 ? find(owner_of(slot)) : nullptr;
    if (thing == nullptr) continue;
    const Eigen::Vector3d p = frame.T_camera_world * map.landmark(slot).p_world;
    if (p.z() < 0.1 || p.z() > kFarthest_m) continue;
    extend(thing->extent, camera_.fx * p.x() / p.z() + camera_.cx, camera_.fy * p.y() / p.z() + camera_.cy);
  }
  const auto width = static_cast<float>(camera_.width), height = static_cast<float>(camera_.height);
  for (const Thing& thing : things_) {
    const FeatureWish& e = thing.extent;
    const FeatureWish in_image = {std::max(e.x0, 0.0F), std::max(e.y0, 0.0F), std::min(e.x1, width),
                                  std::min(e.y1, height)};
    const float area = (in_image.x1 - in_image.x0) * (in_image.y1 - in_image.y0);
    if (area < kMostOfImage * width * height) wishes_.push_back(as_delivered(in_image));
  }
  return wishes_;
}

// The corners where the lens puts them, and somewhat more.
FeatureWish ObjectWishes::as_delivered(const FeatureWish& rectified) const {
  FeatureWish wish{1e9F, 1e9F, -1e9F, -1e9F};
  for (const float x : {rectified.x0, rectified.x1}) {
    for (const float y : {rectified.y0, rectified.y1}) {
      const auto seen = camera_.project(camera_.unproject({static_cast<double>(x), static_cast<double>(y)}));
      if (seen) extend(wish, seen->x(), seen->y());
    }
  }
  return {wish.x0 - kGrow_px, wish.y0 - kGrow_px, wish.x1 + kGrow_px, wish.y1 + kGrow_px};
}

}  // namespace povslam
