#include "drivers/synthetic/shader.hpp"

#include <algorithm>
#include <array>
#include <bit>

namespace povslam::synthetic {

namespace {

constexpr int kSkyGrey = 76, kFloorGrey = 122;
constexpr float kFade_per_m = 0.12F;  // the floor fades into the sky with distance: no horizon line to track

int background_grey(std::int32_t hit, float w) {
  if (hit == Raster::kSky) return kSkyGrey;
  return kSkyGrey + static_cast<int>(static_cast<float>(kFloorGrey - kSkyGrey) * (w / (w + kFade_per_m)));
}

Rgb lit(Lanes lanes, int light_256) {
  const Rgb rgb = from_lanes(lanes);
  const auto scaled = [light_256](int value) { return std::min(255, value * light_256 >> 8); };
  return {scaled(rgb.red), scaled(rgb.green), scaled(rgb.blue)};
}

void put(std::uint8_t* rgb, const Rgb& value) {
  rgb[0] = static_cast<std::uint8_t>(value.red);
  rgb[1] = static_cast<std::uint8_t>(value.green);
  rgb[2] = static_cast<std::uint8_t>(value.blue);
}

}  // namespace

// Texture coordinates, and the level at which a texel is as large as a pixel: half the base-2 logarithm of the mean
// square of texels per pixel, read off the float's exponent (mantissa taken linearly: within 0.09 / 2 of a level).
inline Shader::Coordinates Shader::coordinates(const LitFace& face, float w, float s_over_z, float t_over_z) {
  constexpr float kOne = 1 << kCoordinateBits;
  const float z = 1.0F / w;
  const float s = s_over_z * z, t = t_over_z * z;
  const float s_dx = (face.s_x - s * face.w_x) * face.width, s_dy = (face.s_y - s * face.w_y) * face.width;
  const float t_dx = (face.t_x - t * face.w_x) * face.height, t_dy = (face.t_y - t * face.w_y) * face.height;
  const float texels_2 = 0.5F * z * z * (s_dx * s_dx + s_dy * s_dy + t_dx * t_dx + t_dy * t_dy);
  return {static_cast<std::int32_t>(std::clamp(s, 0.0F, 1.0F) * kOne),
          static_cast<std::int32_t>(std::clamp(t, 0.0F, 1.0F) * kOne),
          (std::bit_cast<std::int32_t>(texels_2) - 0x3F800000) >> 16};
}

void Shader::shade(const View& view, const std::vector<ProjectedFace>& faces, const Raster& raster, double exposure,
                   ImageU8& color) {
  const int width = raster.hit().width(), height = raster.hit().height();
  color.resize(width, height, 3);
  for (auto* buffer : {&s20_, &t20_, &level_}) buffer->resize(static_cast<std::size_t>(width));
  pictures_.begin_image();
  light_faces(faces, exposure);
  for (int row = 0; row < height; ++row) shade_row(raster, row, color.row(row));
  smooth_edges(raster, view.floor(), color);
}

void Shader::light_faces(const std::vector<ProjectedFace>& faces, double exposure) {
  exposure_256_ = static_cast<int>(exposure * 256.0 + 0.5);
  lit_.clear();
  for (const ProjectedFace& face : faces) {
    const auto f = [](double value) { return static_cast<float>(value); };
    lit_.push_back({f(face.s.x), f(face.s.y), f(face.s.constant), f(face.t.x), f(face.t.y), f(face.t.constant),
                    f(face.plane.w.x), f(face.plane.w.y), f(face.plane.w.constant),
                    static_cast<int>(face.light * exposure * 256.0 + 0.5), face.object, face.surface});
  }
}

Shader::LitFace& Shader::shown(std::int32_t hit) {
  LitFace& face = lit_[static_cast<std::size_t>(hit - Raster::kFirstFace)];
  if (face.texture == nullptr) {
    face.texture = &pictures_.look_at(face.object, face.surface);
    face.width = static_cast<float>(face.texture->width());
    face.height = static_cast<float>(face.texture->height());
  }
  return face;
}

void Shader::shade_row(const Raster& raster, int row, std::uint8_t* rgb) {
  const float* w = raster.inverse_depth().row(row);
  const std::int32_t* hit = raster.hit().row(row);
  const int width = raster.hit().width();
  for (int begin = 0, end = 0; begin < width; begin = end) {
    while (end < width && hit[end] == hit[begin]) ++end;
    if (hit[begin] < Raster::kFirstFace)
      shade_background(hit[begin], w, begin, end, rgb);
    else
      shade_run(shown(hit[begin]), w, row, begin, end, rgb);
  }
}

void Shader::shade_background(std::int32_t hit, const float* w, int begin, int end, std::uint8_t* rgb) const {
  for (int x = begin; x < end; ++x) {
    const int grey = std::min(255, background_grey(hit, w[x]) * exposure_256_ >> 8);
    put(rgb + 3 * x, {grey, grey, grey});
  }
}

void Shader::shade_run(const LitFace& face, const float* w, int row, int begin, int end, std::uint8_t* rgb) {
  std::int32_t *s20 = s20_.data(), *t20 = t20_.data(), *level = level_.data();
  const auto y = static_cast<float>(row);
  const float s_row = face.s_y * y + face.s_0, t_row = face.t_y * y + face.t_0;
  for (int x = begin; x < end; ++x) {
    const auto column = static_cast<float>(x);
    const Coordinates at = coordinates(face, w[x], s_row + face.s_x * column, t_row + face.t_x * column);
    s20[x] = at.s20;
    t20[x] = at.t20;
    level[x] = at.level_256;
  }
  for (int x = begin; x < end; ++x)
    put(rgb + 3 * x, lit(sample(*face.texture, s20[x], t20[x], level[x]), face.light_256));
}

// The colour along one ray, given the few faces that it may meet.
Rgb Shader::look(const std::int32_t* candidates, int count, const Plane& floor, float x, float y) const {
  auto best_w = static_cast<float>(floor.w.at(x, y));
  const LitFace* best = nullptr;
  float best_s = 0.0F, best_t = 0.0F;
  for (int i = 0; i < count; ++i) {
    const LitFace& face = lit_[static_cast<std::size_t>(candidates[i] - Raster::kFirstFace)];
    const float w = face.w_x * x + face.w_y * y + face.w_0;
    const float s = face.s_x * x + face.s_y * y + face.s_0, t = face.t_x * x + face.t_y * y + face.t_0;
    if (w <= best_w || w <= 0.0F || s < 0.0F || s > w || t < 0.0F || t > w) continue;
    best = &face;
    best_w = w;
    best_s = s;
    best_t = t;
  }
  if (best == nullptr) {
    const int grey =
        std::min(255, background_grey(best_w > 0.0F ? Raster::kFloor : Raster::kSky, best_w) * exposure_256_ >> 8);
    return {grey, grey, grey};
  }
  const Coordinates at = coordinates(*best, best_w, best_s, best_t);
  return lit(sample(*best->texture, at.s20, at.t20, at.level_256), best->light_256);
}

void Shader::smooth_edges(const Raster& raster, const Plane& floor, ImageU8& color) const {
  constexpr std::array<std::array<float, 2>, 4> kRays = {
      {{-0.375F, -0.125F}, {0.125F, -0.375F}, {0.375F, 0.125F}, {-0.125F, 0.375F}}};
  const int width = color.width(), height = color.height();
  for (int y = 1; y + 1 < height; ++y) {
    const std::int32_t* rows[3] = {raster.hit().row(y - 1), raster.hit().row(y), raster.hit().row(y + 1)};
    for (int x = 1; x + 1 < width; ++x) {
      const std::int32_t here = rows[1][x];
      if (rows[1][x - 1] == here && rows[1][x + 1] == here && rows[0][x] == here && rows[2][x] == here) continue;
      std::int32_t candidates[9];
      int count = 0;
      for (const std::int32_t* near : rows) {
        for (int dx = -1; dx <= 1; ++dx) {
          const std::int32_t hit = near[x + dx];
          if (hit >= Raster::kFirstFace && std::find(candidates, candidates + count, hit) == candidates + count)
            candidates[count++] = hit;
        }
      }
      Rgb sum;
      for (const auto& ray : kRays) {
        const Rgb one = look(candidates, count, floor, static_cast<float>(x) + ray[0], static_cast<float>(y) + ray[1]);
        sum = {sum.red + one.red, sum.green + one.green, sum.blue + one.blue};
      }
      put(&color.at(x, y), {(sum.red + 2) / 4, (sum.green + 2) / 4, (sum.blue + 2) / 4});
    }
  }
}

}  // namespace povslam::synthetic
