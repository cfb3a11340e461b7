// What is printed on the faces that are looked at. A picture is painted when it is first seen, and again when it comes
// back into sight later: a warehouse has ten times as many as a camera sees at once.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "drivers/synthetic/world.hpp"

namespace povslam::synthetic {

class Pictures {
 public:
  explicit Pictures(const World& world) : world_(world), kept_(static_cast<std::size_t>(world.num_pictures())) {}

  // Before each image: forgets what none of the last kKeptImages looked at.
  void begin_image();
  // surface as in ProjectedFace. The texture is valid until the next begin_image().
  const Texture& look_at(int object, int surface);
  int num_kept() const { return static_cast<int>(used_.size()); }

  static constexpr std::int64_t kKeptImages = 60;  // things that a shelf or a turn of the path hides for a moment stay

 private:
  struct Kept {
    std::optional<Texture> texture;
    std::int64_t last_image = -1;
  };

  const World& world_;
  std::vector<Kept> kept_;  // by picture
  std::vector<int> used_;   // pictures that have their texture
  std::int64_t image_ = 0;
};

}  // namespace povslam::synthetic
