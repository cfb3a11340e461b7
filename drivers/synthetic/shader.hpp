// Colour of what the rays hit: textures smoothly sampled, edges of faces smoothed by four rays a pixel.
#pragma once

#include <vector>

#include "drivers/synthetic/pictures.hpp"
#include "drivers/synthetic/raster.hpp"
#include "drivers/synthetic/world.hpp"

namespace povslam::synthetic {

class Shader {
 public:
  explicit Shader(const World& world) : pictures_(world) {}

  // Writes R, G, B of the raster of these faces; `exposure` is a factor on brightness.
  void shade(const View& view, const std::vector<ProjectedFace>& faces, const Raster& raster, double exposure,
             ImageU8& color);

 private:
  struct LitFace {  // single precision copy for the loops
    float s_x, s_y, s_0, t_x, t_y, t_0, w_x, w_y, w_0;
    int light_256;
    int object, surface;
    const Texture* texture = nullptr;   // null until a pixel shows it
    float width = 0.0F, height = 0.0F;  // of the texture
  };
  struct Coordinates {
    std::int32_t s20 = 0, t20 = 0, level_256 = 0;
  };
  LitFace& shown(std::int32_t hit);
  void light_faces(const std::vector<ProjectedFace>& faces, double exposure);
  void shade_row(const Raster& raster, int row, std::uint8_t* rgb);
  void shade_background(std::int32_t hit, const float* w, int begin, int end, std::uint8_t* rgb) const;
  void shade_run(const LitFace& face, const float* w, int row, int begin, int end, std::uint8_t* rgb);
  void smooth_edges(const Raster& raster, const Plane& floor, ImageU8& color) const;
  Rgb look(const std::int32_t* candidates, int count, const Plane& floor, float x, float y) const;
  static Coordinates coordinates(const LitFace& face, float w, float s_over_z, float t_over_z);

  Pictures pictures_;
  std::vector<LitFace> lit_;
  std::vector<std::int32_t> s20_, t20_, level_;
  int exposure_256_ = 256;
};

}  // namespace povslam::synthetic
