#include "drivers/synthetic/renderer.hpp"

#include "drivers/synthetic/random.hpp"

namespace povslam::synthetic {

namespace {

constexpr int kBlurExposures = 4;
constexpr double kExposure_s = 0.008;

std::uint64_t noise_seed(const SyntheticOptions& options) {
  return options.noise_seed != 0 ? mix(options.seed, options.noise_seed) : options.seed;
}

}  // namespace

Renderer::Renderer(const World& world)
    : world_(world), noise_(noise_seed(world.options()), world.options().noise), shader_(world) {}

void Renderer::expose(const Rigid3& T_world_camera, double time_s, ImageU8& color) {
  const View view(world_.options().camera, T_world_camera);
  find_faces(world_.scene(), time_s, view, faces_);
  raster_.cast(view, faces_);
  shader_.shade(view, faces_, raster_, noise_.exposure(time_s), color);
}

void Renderer::render(const Rigid3& T_world_camera, double time_s, RgbdFrame& frame) {
  const PinholeCamera& camera = world_.options().camera;
  if (world_.options().blur) {
    sum_.resize(camera.width, camera.height, 3);
    sum_.fill(0);
    const Rigid3 T_camera_planned = T_world_camera * world_.T_world_camera(time_s).inverse();
    for (int i = 0; i < kBlurExposures; ++i) {
      const double t = time_s + kExposure_s * ((i + 0.5) / kBlurExposures - 0.5);
      expose(T_camera_planned * world_.T_world_camera(t), t, exposure_);
      for (std::size_t p = 0; p < sum_.size(); ++p)
        sum_.data()[p] = static_cast<std::uint16_t>(sum_.data()[p] + exposure_.data()[p]);
    }
  }
  expose(T_world_camera, time_s, frame.color);
  if (world_.options().blur) {
    for (std::size_t p = 0; p < sum_.size(); ++p) {
      frame.color.data()[p] = static_cast<std::uint8_t>((sum_.data()[p] + kBlurExposures / 2) / kBlurExposures);
    }
  }
  plane_distance_m_.assign(Raster::kFirstFace, static_cast<float>(T_world_camera.translation.z()));
  for (const ProjectedFace& face : faces_) plane_distance_m_.push_back(static_cast<float>(face.plane.distance_m));
  const auto draw = static_cast<std::uint64_t>(static_cast<std::int64_t>(time_s * 1e6 + 0.5));
  noise_.add_to_color(frame.color.data(), 3 * camera.width, camera.height, draw);
  frame.depth_scale = 1000.0F;
  noise_.measure_depth(raster_, camera, plane_distance_m_, world_.options().max_depth_m, frame.depth_scale, draw,
                       frame.depth);
}

void Renderer::label(LabelFrame& labels) const {
  const Image<std::int32_t>& hit = raster_.hit();
  labels.classes.resize(hit.width(), hit.height());
  labels.instances.resize(hit.width(), hit.height());
  labels.table_name = "synthetic";
  for (std::size_t p = 0; p < hit.size(); ++p) {
    const std::int32_t id = hit.data()[p];
    ClassId class_id = id == Raster::kSky ? ClassId::none : ClassId::floor;
    std::uint16_t instance = 0;
    if (id >= Raster::kFirstFace) {
      const ProjectedFace& face = faces_[static_cast<std::size_t>(id - Raster::kFirstFace)];
      const Object& object = world_.scene().objects[static_cast<std::size_t>(face.object)];
      class_id = object.class_id;
      instance = object.id;
    }
    labels.classes.data()[p] = static_cast<std::uint8_t>(class_id);
    labels.instances.data()[p] = instance;
  }
}

}  // namespace povslam::synthetic
