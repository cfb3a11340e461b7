#include "drivers/synthetic/pictures.hpp"

namespace povslam::synthetic {

void Pictures::begin_image() {
  ++image_;
  std::erase_if(used_, [this](int picture) {
    Kept& kept = kept_[static_cast<std::size_t>(picture)];
    const bool old = image_ - kept.last_image > kKeptImages;
    if (old) kept.texture.reset();
    return old;
  });
}

const Texture& Pictures::look_at(int object, int surface) {
  const int picture = world_.picture(object, surface);
  Kept& kept = kept_[static_cast<std::size_t>(picture)];
  kept.last_image = image_;
  if (!kept.texture) {
    kept.texture.emplace(world_.paint(picture));
    used_.push_back(picture);
  }
  return *kept.texture;
}

}  // namespace povslam::synthetic
