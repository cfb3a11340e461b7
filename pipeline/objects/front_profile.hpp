// What the front of an object that is wider than its kind shows, along it, over many views: two things side by side
// taken for one part where the front lies behind both sides, by less than one view can tell from noise.
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "pipeline/mapping/depth_view.hpp"
#include "pipeline/objects/hidden_ends.hpp"

namespace povslam {

class FrontProfile {
 public:
  // seen: whose front it is, in the frame of the object's volume, which stays that of the profile.
  FrontProfile(const SeenBox& seen, const FrontSide& side);

  // The owner's pixels of a view. sigma_quadratic_per_m: of the depth.
  void add(const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume, double sigma_quadratic_per_m);

  // Where a groove runs up half of the front (one side of it may be lower); horizontal, volume's frame.
  std::optional<Eigen::Vector2d> groove() const;
  Eigen::Vector2d along() const { return along_.head<2>(); }

 private:
  static constexpr int kBands = 4;  // of height
  struct Bin {
    double weight = 0.0, sum = 0.0;  // 1/m^2; of distances before the front's plane
  };
  struct Mean {
    double value_m = 0.0, variance_m2 = 0.0;
  };
  std::optional<Mean> mean(int band, int from, int to) const;
  std::optional<double> dip_m(int band, int bin) const;  // how far it lies behind both sides; none: not clearly

  Eigen::Vector3d origin_, normal_, along_;  // of the front's middle, volume's frame
  double low_m_, height_m_, half_m_;
  int bins_;
  std::array<std::vector<Bin>, kBands> profile_;
};

}  // namespace povslam
