// Keys of the half that understands: objects, dense map, events.
#include "daemon/config_keys_rows.hpp"

namespace povslam {

// An option added to these structs changes their size: give it a key below, then the new size here.
static_assert(sizeof(DepthViewOptions) == 16 && sizeof(SegmentOptions) == 64 && sizeof(VolumeOptions) == 24 &&
              sizeof(IntegrateOptions) == 32 && sizeof(UnderstandingOptions) == 208);

std::vector<Key<AppConfig>> understanding_table() {
  return {
      text("understanding.labels", AT(pipeline.understanding.labels),
           "What says which thing a pixel shows; off: no objects, no dense map; geometric: what stands apart, without "
           "any "
           "labels; replay: label frames of the driver; auto: those if it has them, else geometric",
           {"auto", "off", "geometric", "replay"}),
      key("understanding.period_s", AT(pipeline.understanding.period_s), 0.02, 60.0,
          "Between two frames that are understood"),
      key("understanding.label_max_latency_s", AT(pipeline.understanding.label_max_latency_s), 0.0, 30.0,
          "A frame waits so long for its labels"),

      key("view.min_depth_m", AT(pipeline.understanding.view.min_depth_m), 0.0, 100.0,
          "Nearer measurements make no objects and no dense map"),
      key("view.max_depth_m", AT(pipeline.understanding.view.max_depth_m), 0.1, 300.0, "Farther ones neither"),

      key("segment.min_pixels", AT(pipeline.understanding.segment.min_pixels), 1, 10000000,
          "Smaller segments of an image are nothing"),
      key("segment.normal_cosine", AT(pipeline.understanding.segment.normal_cosine), 0.0, 1.0,
          "A concave fold whose normals' cosine is below this separates"),
      key("segment.jump_share", AT(pipeline.understanding.segment.jump_share), 0.0, 1.0,
          "Share of the depth: a larger jump of depth separates"),
      key("segment.jump_sigmas", AT(pipeline.understanding.segment.jump_sigmas), 0.0, 100.0,
          "If it is also so many standard deviations of the depth noise"),
      key("segment.depth_sigma_quadratic_per_m", AT(pipeline.understanding.segment.depth_sigma_quadratic_per_m), 0.0,
          0.1, "Depth: sigma_z = this * z^2 [1/m]"),
      key("segment.wall_area_m2", AT(pipeline.understanding.segment.wall_area_m2), 0.1, 1000.0,
          "An upright plane larger than this is structure"),
      key("segment.wall_length_m", AT(pipeline.understanding.segment.wall_length_m), 0.1, 100.0,
          "And one longer than this"),
      key("segment.floor_tolerance_m", AT(pipeline.understanding.segment.floor_tolerance_m), 0.0, 1.0,
          "About the floor's height, plus three standard deviations of the depth"),

      key("structure.voxel_size_m", AT(pipeline.understanding.structure.voxel_size_m), 0.005, 1.0,
          "Dense map of floor, walls and racks"),
      key("structure.truncation_m", AT(pipeline.understanding.structure.truncation_m), 0.01, 4.0,
          "Distances to the surface are known up to this"),
      key("structure.max_blocks", AT(pipeline.understanding.structure.max_blocks), 1, 4000000,
          "Bounds the memory: blocks of 8 x 8 x 8 voxels, 3.6 kB each"),

      key("object.voxel_size_m", AT(pipeline.understanding.object.voxel_size_m), 0.005, 1.0, "The same of one object"),
      key("object.truncation_m", AT(pipeline.understanding.object.truncation_m), 0.01, 4.0,
          "Distances to the surface are known up to this"),
      key("object.max_blocks", AT(pipeline.understanding.object.max_blocks), 1, 1000000, "Bounds the memory of each"),

      key("integrate.depth_sigma_quadratic_per_m", AT(pipeline.understanding.integrate.depth_sigma_quadratic_per_m),
          0.0, 0.1, "Depth: sigma_z = this * z^2 [1/m]"),
      key("integrate.depth_sigma_floor_m", AT(pipeline.understanding.integrate.depth_sigma_floor_m), 1e-5, 1.0,
          "Depth: added in quadrature"),
      key("integrate.max_weight", AT(pipeline.understanding.integrate.max_weight), 1.0, 1000.0,
          "Looks a voxel remembers: beyond, older ones fade"),
      key("integrate.allocation_stride_px", AT(pipeline.understanding.integrate.allocation_stride_px), 1, 64,
          "Every so manyth pixel of a row and column makes blocks"),
  };
}

}  // namespace povslam
