#include "pipeline/objects/front_profile.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/objects/object.hpp"

namespace povslam {
namespace {

constexpr double kBin_m = 0.02;
constexpr double kBehind_m = 0.2, kBefore_m = 0.06;       // the plane: neither the front nor a groove in it
constexpr int kInner = 2, kNear = 3, kFar = 6, kEnd = 8;  // bins: the groove's, of either side, left at the ends

}  // namespace

FrontProfile::FrontProfile(const SeenBox& seen, const FrontSide& side) {
  const Eigen::AngleAxisd turn(seen.box.yaw, Eigen::Vector3d::UnitZ());
  normal_ = turn * ((side.plus ? 1.0 : -1.0) * Eigen::Vector3d::Unit(side.across));
  along_ = turn * Eigen::Vector3d::Unit(side.along());
  origin_ = seen.box.center + 0.5 * seen.box.size_m[side.across] * normal_;
  height_m_ = seen.box.size_m.z();
  low_m_ = seen.box.center.z() - 0.5 * height_m_;
  half_m_ = 0.5 * seen.box.size_m[side.along()];
  bins_ = std::max(1, static_cast<int>(2.0 * half_m_ / kBin_m));
  for (std::vector<Bin>& band : profile_) band.resize(static_cast<std::size_t>(bins_));
}

// A point lies where its ray meets the plane: the ray is known to a pixel, the depth is not.
void FrontProfile::add(const DepthView& view, std::uint16_t owner, const Rigid3& T_world_volume,
                       double sigma_quadratic_per_m) {
  const Rigid3 T_volume_camera = T_world_volume.inverse() * view.T_world_camera;
  const Eigen::Vector3d camera = T_volume_camera.translation;
  const double away_m = normal_.dot(camera - origin_);
  if (away_m <= 0.0) return;
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      const std::uint16_t of = view.owner.at(x, y);
      if (of != owner && of != kNobody) continue;  // a view's own grooves are nobody's
      const double z = static_cast<double>(view.depth_m.at(x, y));
      const Eigen::Vector3d ray =
          T_volume_camera.rotation *
          Eigen::Vector3d((x - view.camera.cx) / view.camera.fx, (y - view.camera.cy) / view.camera.fy, 1.0);
      const double toward = -normal_.dot(ray);
      if (!(z > 0.0) || toward <= 0.0) continue;
      const double before_m = away_m - z * toward;
      const Eigen::Vector3d on_plane = camera + away_m / toward * ray;
      const auto bin = static_cast<int>(std::floor((along_.dot(on_plane - origin_) + half_m_) / kBin_m));
      const auto band = static_cast<int>(std::floor((on_plane.z() - low_m_) / height_m_ * kBands));
      if (before_m < -kBehind_m || before_m > kBefore_m) continue;
      if (bin < 0 || bin >= bins_ || band < 0 || band >= kBands) continue;
      const double sigma_m = sigma_quadratic_per_m * z * z * toward, weight = 1.0 / (sigma_m * sigma_m);
      Bin& into = profile_[static_cast<std::size_t>(band)][static_cast<std::size_t>(bin)];
      into.weight += weight;
      into.sum += weight * before_m;
    }
  }
}

std::optional<FrontProfile::Mean> FrontProfile::mean(int band, int from, int to) const {
  constexpr double kKnown_m = 0.004;
  if (from < 0 || to > bins_) return std::nullopt;
  Bin all;
  for (int i = from; i < to; ++i) {
    const Bin& bin = profile_[static_cast<std::size_t>(band)][static_cast<std::size_t>(i)];
    all.weight += bin.weight;
    all.sum += bin.sum;
  }
  if (all.weight * kKnown_m * kKnown_m < 1.0) return std::nullopt;
  return Mean{all.sum / all.weight, 1.0 / all.weight};
}

std::optional<double> FrontProfile::dip_m(int band, int bin) const {
  constexpr double kLeast_m = 0.004, kSigmas = 4.0;
  const auto left = mean(band, bin - kFar, bin - kNear + 1),
             right = mean(band, bin + kInner + kNear - 1, bin + kInner + kFar), inner = mean(band, bin, bin + kInner);
  if (!left || !right || !inner) return std::nullopt;
  const double dip_m = std::min(left->value_m, right->value_m) - inner->value_m;
  const double variance_m2 = inner->variance_m2 + std::max(left->variance_m2, right->variance_m2);
  return dip_m > kLeast_m && dip_m > kSigmas * std::sqrt(variance_m2) ? std::optional(dip_m) : std::nullopt;
}

std::optional<Eigen::Vector2d> FrontProfile::groove() const {
  double deepest_m = 0.0;
  int at = -1;
  for (int band = 0; band + 1 < kBands; ++band) {
    for (int bin = kEnd; bin + kInner + kEnd <= bins_; ++bin) {
      const auto lower = dip_m(band, bin), upper = dip_m(band + 1, bin);
      if (!lower || !upper || *lower + *upper <= deepest_m) continue;
      deepest_m = *lower + *upper;
      at = bin;
    }
  }
  if (at < 0) return std::nullopt;
  const double u_m = (at + 0.5 * kInner) * kBin_m - half_m_;
  return (origin_ + u_m * along_).head<2>();
}

}  // namespace povslam
