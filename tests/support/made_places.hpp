// A map of places made by hand and the search of it, without images.
#pragma once

#include <span>
#include <vector>

#include "pipeline/frontend/relocalise.hpp"
#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam::made {

inline FrontendOptions of_600_features() {
  FrontendOptions options;
  options.orb.num_features = 600;
  return options;
}

// Points that keyframes see from several places; looks are given, so that two places can have the same.
struct Places {
  Places()
      : camera(half_camera()),
        options(of_600_features()),
        map(options.orb.num_features, options.map, level_scales()),
        index(Vocabulary::shipped(), options.map.max_keyframes, options.orb.num_features),
        relocaliser(camera, options) {}

  // Three keyframes side by side that see the points.
  void add_place(std::span<const Eigen::Vector3d> points, std::span<const Descriptor> looks,
                 const Eigen::Vector3d& place) {
    std::vector<std::int32_t> landmark_of(points.size(), kNone);
    for (const double side : {-0.2, 0.0, 0.2}) {
      const View view = look(points, looks, looking_along_y(place + Eigen::Vector3d(side, 0.0, 0.0)));
      const std::int32_t slot = map.insert_keyframe(view.frame, view.frame.T_camera_world.inverse(), {}, -1);
      for (std::size_t f = 0; f < view.shown.size(); ++f) {
        const std::size_t point = static_cast<std::size_t>(view.shown[f]);
        if (landmark_of[point] == kNone) {
          landmark_of[point] = map.create_landmark(slot, static_cast<int>(f), points[point]);
        } else if (map.add_sighting(landmark_of[point], slot, static_cast<int>(f))) {
          map.refresh_landmark(landmark_of[point]);
        }
      }
      map.update_covisibility(slot);
      Keyframe& kf = map.keyframe(slot);
      Vocabulary::shipped().words(kf.descriptor, kf.word);
      index.add(slot, kf.word);
    }
  }
  View look(std::span<const Eigen::Vector3d> points, std::span<const Descriptor> looks,
            const Rigid3& T_world_camera) const {
    return view_of(camera, options, T_world_camera, points, looks);
  }
  Relocaliser::Answer ask(const Frame& frame) { return relocaliser.search(map, index, frame); }

  PinholeCamera camera;
  FrontendOptions options;
  Map map;
  PlaceIndex index;
  Relocaliser relocaliser;
};

inline std::vector<Eigen::Vector3d> moved(std::vector<Eigen::Vector3d> points, const Eigen::Vector3d& by) {
  for (Eigen::Vector3d& p : points) p += by;
  return points;
}

}  // namespace povslam::made
