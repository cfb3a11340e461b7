// What faces look like: printed cartons with labels, tape, text and marks at several scales, and plainer materials.
#pragma once

#include <cstdint>

#include "drivers/synthetic/texture.hpp"

namespace povslam::synthetic {

enum class Paint : std::uint8_t { carton, goods, wood, steel, wall, concrete, truck, cloth };

// A picture of a face of the given size, its first row at the face's upper edge. Every seed gives another one.
Texture paint_face(Paint paint, double width_m, double height_m, std::uint64_t seed);

}  // namespace povslam::synthetic
