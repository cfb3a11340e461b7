// Keys of the half that understands: objects, dense map, events.
#include "daemon/config_keys_rows.hpp"

namespace povslam {

// An option added to these structs changes their size: give it a key below, then the new size here.
static_assert(sizeof(DepthViewOptions) == 16 && sizeof(SegmentOptions) == 112 && sizeof(VolumeOptions) == 24 &&
              sizeof(IntegrateOptions) == 32 && sizeof(EmptySpaceOptions) == 16 && sizeof(ExtractOptions) == 56 &&
              sizeof(BeliefOptions) == 48 && sizeof(AssociateOptions) == 48 && sizeof(LifeOptions) == 80 &&
              sizeof(NamingOptions) == 40 && sizeof(UnderstandingOptions) == 560);

std::vector<Key<AppConfig>> understanding_table() {
  return {
      text("understanding.labels", AT(pipeline.understanding.labels),
           "What says which thing a pixel shows; off: no objects, no dense map; geometric: what stands apart, without "
           "any labels; dnn: the same, and a network names it ([network]); replay: label frames of the driver or of a "
           "source ([labels]); auto: those if any are set up, else "
           "geometric",
           {"auto", "off", "geometric", "dnn", "replay"}),
      key("understanding.period_s", AT(pipeline.understanding.period_s), 0.02, 60.0,
          "Between two frames that are understood"),
      key("understanding.answer_delay_s", AT(pipeline.understanding.answer_delay_s), 0.0, 60.0,
          "What a frame tells tracking of objects enters so long after it was taken; what is late, when it comes"),
      key("understanding.label_max_latency_s", AT(pipeline.understanding.label_max_latency_s), 0.0, 30.0,
          "A frame waits so long for its labels"),

      key("understanding.change_period_s", AT(pipeline.understanding.change_period_s), 0.1, 60.0,
          "So often what changed of objects and dense map is stored"),
      key("view.min_depth_m", AT(pipeline.understanding.view.min_depth_m), 0.0, 100.0,
          "Nearer measurements make no objects and no dense map"),
      key("view.max_depth_m", AT(pipeline.understanding.view.max_depth_m), 0.1, 300.0, "Farther ones neither"),

      key("segment.min_pixels", AT(pipeline.understanding.segment.min_pixels), 1, 10000000,
          "Smaller segments of an image are nothing"),
      key("segment.max_depth_m", AT(pipeline.understanding.segment.max_depth_m), 0.1, 300.0,
          "What is farther is not looked at, and things that reach it are cut off there"),
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
      key("segment.tall_m", AT(pipeline.understanding.segment.tall_m), 0.1, 100.0,
          "What rises more than this is structure"),
      key("segment.pole_width_m", AT(pipeline.understanding.segment.pole_width_m), 0.0, 10.0,
          "What is thinner, and much higher, is a post: structure"),
      key("segment.board_length_m", AT(pipeline.understanding.segment.board_length_m), 0.1, 100.0,
          "A level strip longer than this"),
      key("segment.board_thickness_m", AT(pipeline.understanding.segment.board_thickness_m), 0.01, 10.0,
          "And not higher than this is a shelf: structure"),
      key("segment.own_outline", AT(pipeline.understanding.segment.own_outline), 0.0, 1.0,
          "A flat thing with a smaller share of outline of its own is the background"),

      text("network.file", AT(network.file),
           "Weights of the network that names segments: a YOLOX in ONNX without decoding; its classes are those of "
           "labels.classes, the first of them id 1"),
      key("network.input_px", AT(pipeline.understanding.naming.input_px), 32, 2048,
          "Edge of the square image it takes, a multiple of 32"),
      key("network.every_nth_view", AT(pipeline.understanding.naming.every_nth_view), 1, 1000,
          "It looks at one of so many frames that are understood"),
      key("network.min_score", AT(pipeline.understanding.naming.boxes.min_score), 0.0, 1.0,
          "What it is less sure of is nothing"),
      key("network.max_overlap", AT(pipeline.understanding.naming.boxes.max_overlap), 0.0, 1.0,
          "Of two boxes of one class (intersection over union): the weaker is a double"),
      key("network.inside", AT(pipeline.understanding.naming.names.inside), 0.0, 1.0,
          "A box names a segment that has this share of its pixels in it"),
      key("network.filled", AT(pipeline.understanding.naming.names.filled), 0.0, 1.0,
          "And that covers this share of what was measured in the box"),

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

      key("empty.cell_size_m", AT(pipeline.understanding.empty.cell_size_m), 0.02, 2.0,
          "Memory of where space was seen empty"),
      key("empty.max_cells", AT(pipeline.understanding.empty.max_cells), 1000, 100000000,
          "Bounds the memory: cells looked at longest ago go first"),

      key("extract.erode_px", AT(pipeline.understanding.objects.extract.erode_px), 0, 50,
          "Of a thing in the image: depth is mixed at its border"),
      key("extract.max_depth_m", AT(pipeline.understanding.objects.extract.max_depth_m), 0.1, 300.0,
          "Further away things are not told apart"),
      key("extract.connect_m", AT(pipeline.understanding.objects.extract.connect_m), 0.001, 1.0,
          "Neighbouring pixels of a thing differ in depth by no more than this"),
      key("extract.connect_share", AT(pipeline.understanding.objects.extract.connect_share), 0.0, 0.5,
          "Plus this share of their depth"),
      key("extract.min_pixels", AT(pipeline.understanding.objects.extract.min_pixels), 1, 10000000,
          "Smaller parts of an image are nothing"),
      key("extract.point_spacing_m", AT(pipeline.understanding.objects.extract.point_spacing_m), 0.005, 1.0,
          "Of the points kept of a thing"),
      key("extract.min_points", AT(pipeline.understanding.objects.extract.min_points), 3, 100000,
          "A thing with fewer points is none"),

      key("belief.sigma_m", AT(pipeline.understanding.objects.belief.sigma_m), 0.001, 10.0,
          "Geometric change of a new object, one standard deviation"),
      key("belief.tau_m", AT(pipeline.understanding.objects.belief.tau_m), 0.001, 10.0, "Of its measurement"),
      key("belief.max_change_m", AT(pipeline.understanding.objects.belief.max_change_m), 0.1, 100.0,
          "Largest change measured; also what an object that is missing changed by"),
      key("belief.lambda_diff", AT(pipeline.understanding.objects.belief.lambda_diff), 0.1, 10.0,
          "Factor from distance between surfaces to change"),
      key("belief.max_count", AT(pipeline.understanding.objects.belief.max_count), 1.0, 1000.0,
          "Evidence remembered: beyond, older evidence fades"),
      key("belief.remove_below", AT(pipeline.understanding.objects.belief.remove_below), 0.01, 0.99,
          "Consistency below which an object is removed"),

      key("associate.max_distance_m", AT(pipeline.understanding.objects.associate.max_distance_m), 0.0, 100.0,
          "Between observation and object, beyond their sizes"),
      key("associate.inlier_m", AT(pipeline.understanding.objects.associate.inlier_m), 0.001, 1.0,
          "A point no further from a surface belongs to it, plus three standard deviations"),
      key("associate.max_outlier_share", AT(pipeline.understanding.objects.associate.max_outlier_share), 0.0, 1.0,
          "Of the points the object knows something about"),
      key("associate.min_known_share", AT(pipeline.understanding.objects.associate.min_known_share), 0.0, 1.0,
          "Of the points it must know something about"),
      key("associate.max_shift_m", AT(pipeline.understanding.objects.associate.max_shift_m), 0.0, 10.0,
          "Further away it is not in its place"),
      key("associate.max_turn_rad", AT(pipeline.understanding.objects.associate.max_turn_rad), 0.0, 3.2,
          "Turned further neither"),

      key("life.confirm_views", AT(pipeline.understanding.objects.life.confirm_views), 1, 1000,
          "Views that make an object"),
      key("life.forget_tentative_s", AT(pipeline.understanding.objects.life.forget_tentative_s), 0.1, 86400.0,
          "A thing seen less often and not again for so long was none"),
      key("life.new_within_m", AT(pipeline.understanding.objects.life.new_within_m), 0.1, 300.0,
          "Things further away make no new objects"),
      key("life.visible_share", AT(pipeline.understanding.objects.life.visible_share), 0.01, 1.0,
          "Share of an object that is seen through before it counts as missing"),
      key("life.visible_points", AT(pipeline.understanding.objects.life.visible_points), 1, 100000,
          "And so many points of its surface"),
      key("life.margin_m", AT(pipeline.understanding.objects.life.margin_m), 0.0, 10.0,
          "Clearly behind, clearly before: by this plus three standard deviations"),
      key("life.empty_share", AT(pipeline.understanding.objects.life.empty_share), 0.0, 1.0,
          "Of a new object whose place was seen empty before: it came"),
      key("life.hold_s", AT(pipeline.understanding.objects.life.hold_s), 0.0, 3600.0,
          "What went waits so long for being found elsewhere before it is told"),
      key("life.merge_overlap", AT(pipeline.understanding.objects.life.merge_overlap), 0.0, 1.0,
          "Objects that share so much of the smaller are one"),
      key("life.part_min_m", AT(pipeline.understanding.objects.life.part_min_m), 0.0, 100.0,
          "A part of an object that went while the rest stands is told as removed if it is so large in two directions; "
          "0: none is"),
  };
}

}  // namespace povslam
