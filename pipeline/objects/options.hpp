// Options of the object library: plain values with defaults, validated once where they enter (daemon/config_file).
#pragma once

namespace povslam {

struct ExtractOptions {
  double max_depth_m = 6.0;       // further away things are not told apart
  int erode_px = 2;               // of the full image: depth is mixed at the borders of things
  double connect_m = 0.04;        // neighbouring pixels of a thing lie no further apart in depth than this…
  double connect_share = 0.015;   // …plus this share of their depth
  int min_pixels = 150;           // of the full image
  double point_spacing_m = 0.03;  // of the cloud kept of a thing
  int min_points = 25;
};

struct BeliefOptions {         // POCD's numbers, see the design's method 1.9 and 2.2
  double sigma_m = 0.1;        // of the geometric change, at first
  double tau_m = 0.1;          // of its measurement
  double max_change_m = 4.0;   // Dmax
  double lambda_diff = 1.6;    // factor from mean difference of distance fields to change
  double max_count = 10.0;     // of alpha and beta: both are scaled down to it, so that belief can turn
  double remove_below = 0.40;  // theta_stat, theta_consist
};

struct AssociateOptions {
  double max_distance_m = 0.9;      // theta_dist, between box centres, beyond the boxes' own size
  double inlier_m = 0.10;           // a point belongs to a surface no further than this (plus 3 sigma of its depth)…
  double max_outlier_share = 0.35;  // …of those the model says anything about
  double min_known_share = 0.10;    // of the observation's points that must fall where the model knows the surface
  double max_shift_m = 0.12;        // registered further than this from where it stood, it is not in its place…
  double max_turn_rad = 0.15;       // …likewise
};

struct LifeOptions {
  int confirm_views = 3;             // accepted ones that make an object
  double forget_tentative_s = 10.0;  // not seen again for so long, it was none
  double new_within_m = 6.0;         // things further away make no new object; as far as they are extracted
  double visible_share = 0.20;       // theta_vis: of its surface seen through…
  int visible_points = 30;           // …and at least so many points, before absence is believed
  double margin_m = 0.10;            // clearly behind, clearly before
  double empty_share = 0.25;         // of a new object's surface, standing where it was seen empty before: it came
  double hold_s = 8.0;               // an event waits so long for its other half (gone and came make moved)
  double settle_s = 4.0;             // what came is looked at so long, while it is seen, before its place is told
  double merge_overlap = 0.5;        // of the smaller box
  double part_min_m = 0.2;           // a part this large in two directions that went is a change of its own; 0: none is
};

struct ObjectOptions {
  ExtractOptions extract;
  BeliefOptions belief;
  AssociateOptions associate;
  LifeOptions life;
};

}  // namespace povslam
