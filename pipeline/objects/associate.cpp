#include "pipeline/objects/associate.hpp"

#include <algorithm>
#include <cmath>

#include "pipeline/objects/assign.hpp"

namespace povslam {
namespace {

struct Claim {
  bool in_place = false;  // on known surface, hardly moved
  double cost = kForbidden;
  Registration registration;
};

bool near(const Observation& observation, const MapObject& object, const AssociateOptions& options) {
  const Box a = object.box_world();
  const double reach = options.max_distance_m + 0.5 * (a.size_m.norm() + observation.box.size_m.norm());
  return (a.center - observation.box.center).norm() <= reach;
}

// Beside what the object shows so far: another side of it.
double cost_of_another_side(const Observation& observation, const MapObject& object) {
  constexpr double kGrow_m = 0.10, kEnough = 0.3;
  Box grown = object.box_world();
  grown.size_m += Eigen::Vector3d::Constant(kGrow_m);
  Box seen = observation.box;
  seen.size_m += Eigen::Vector3d::Constant(kGrow_m);
  const double share = overlap(grown, seen).of_smaller;
  return share < kEnough ? kForbidden : 1.0 + (1.0 - share);
}

// A narrow part seen from afar turns by much with the noise of its depth, and does not go anywhere by it.
bool in_place(const Registration& fit, const AssociateOptions& options) {
  const bool turned = fit.turn_rad > options.max_turn_rad && fit.most_turned_m > 0.5 * options.max_shift_m;
  return !turned && fit.shift_m <= options.max_shift_m;
}

Claim claim(const Observation& observation, const MapObject& object, Standing standing,
            const AssociateOptions& options) {
  Claim out;
  if (standing == Standing::gone) return out;
  if (!near(observation, object, options)) return out;
  const bool other_class = observation.class_binds && observation.class_id != object.class_id();
  if (other_class) return out;  // POCD: cost 1000, which is a veto
  if (fenced_off(object, observation)) return out;
  out.registration = register_points(observation, object.volume, object.T_world_volume, options.inlier_m);
  const Registration& fit = out.registration;
  const double known = static_cast<double>(fit.known), inliers = static_cast<double>(fit.inliers);
  if (known < options.min_known_share * fit.points) {
    if (standing == Standing::whole) out.cost = cost_of_another_side(observation, object);
    return out;
  }
  if (inliers < (1.0 - options.max_outlier_share) * known) return out;
  if (!in_place(fit, options)) return out;
  out.in_place = true;
  out.cost = fit.shift_m * fit.shift_m + fit.turn_rad + (1.0 - inliers / fit.points);
  return out;
}

// A side met for the first time lies behind the surfaces known from elsewhere, so that it fits none of them.
bool is_side(const Claim& claim, const Observation& observation, const MapObject& object,
             const AssociateOptions& options) {
  const Registration& fit = claim.registration;
  const bool alike = !observation.class_binds || observation.class_id == object.class_id();
  return alike && fit.points > 0 && observation.fences.empty() &&
         fit.before <= options.max_outlier_share * fit.points && lies_within(observation, object.box_world());
}

void claim_sides(const std::vector<Claim>& claims, std::span<const Observation> observations,
                 std::span<const MapObject* const> objects, std::span<const Standing> standing,
                 const AssociateOptions& options, Association& out) {
  std::erase_if(out.unclaimed, [&](int i) {
    for (std::size_t j = 0; j < objects.size(); ++j) {
      const Claim& claim = claims[static_cast<std::size_t>(i) * objects.size() + j];
      if (standing[j] != Standing::whole ||
          !is_side(claim, observations[static_cast<std::size_t>(i)], *objects[j], options))
        continue;
      const auto known = std::ranges::find(out.matches, static_cast<int>(j), &Match::object);
      if (known != out.matches.end()) {
        known->sides.push_back(i);
      } else {
        out.matches.push_back({static_cast<int>(j), {i}, {}, claim.registration, false, kNobody});
      }
      return true;
    }
    return false;
  });
}

}  // namespace

bool lies_within(const Observation& observation, const Box& box_world) {
  constexpr double kGrow_m = 0.05;
  std::size_t inside = 0;
  for (const Eigen::Vector3f& p : observation.points_world) {
    inside += box_world.contains(p.cast<double>(), kGrow_m) ? 1 : 0;
  }
  return 2 * inside > observation.points_world.size();
}

Association associate(std::span<const Observation> observations, std::span<const MapObject* const> objects,
                      std::span<const Standing> standing, const AssociateOptions& options) {
  const std::size_t n = observations.size(), m = objects.size();
  std::vector<Claim> claims(n * m);
  Eigen::MatrixXd cost(static_cast<Eigen::Index>(n), static_cast<Eigen::Index>(m));
  for (std::size_t i = 0; i < n; ++i) {
    for (std::size_t j = 0; j < m; ++j) {
      claims[i * m + j] = claim(observations[i], *objects[j], standing[j], options);
      cost(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) = claims[i * m + j].cost;
    }
  }
  const std::vector<int> object_of = assign(cost);

  Association out;
  std::vector<int> match_of(m, -1);
  const auto match = [&](std::size_t i, std::size_t j) {
    match_of[j] = static_cast<int>(out.matches.size());
    const Claim& made = claims[i * m + j];
    out.matches.push_back({static_cast<int>(j), {static_cast<int>(i)}, {}, made.registration, made.in_place, kNobody});
  };
  for (std::size_t i = 0; i < n; ++i) {
    if (object_of[i] >= 0) match(i, static_cast<std::size_t>(object_of[i]));
  }
  for (std::size_t i = 0; i < n; ++i) {
    std::vector<int> all;  // objects whose known surface this observation lies on
    int beside = -1;       // the matched one that it most likely is another side of
    for (std::size_t j = 0; j < m; ++j) {
      const Claim& made = claims[i * m + j];
      if (made.in_place) all.push_back(static_cast<int>(j));
      if (made.in_place || made.cost >= kForbidden || match_of[j] < 0) continue;
      if (beside < 0 || made.cost < claims[i * m + static_cast<std::size_t>(beside)].cost) beside = static_cast<int>(j);
    }
    for (std::size_t a = 0; a < all.size(); ++a) {
      for (std::size_t b = a + 1; b < all.size(); ++b) out.one_seen_as.emplace_back(all[a], all[b]);
    }
    if (object_of[i] < 0 && all.empty()) {
      if (beside < 0) {
        out.unclaimed.push_back(static_cast<int>(i));
      } else {
        out.matches[static_cast<std::size_t>(match_of[static_cast<std::size_t>(beside)])].observations.push_back(
            static_cast<int>(i));
      }
    }
    for (const int j : all) {
      if (j == object_of[i]) continue;
      const auto object = static_cast<std::size_t>(j);
      if (match_of[object] < 0) {
        match(i, object);
      } else if (object_of[i] < 0) {  // one more part of it
        out.matches[static_cast<std::size_t>(match_of[object])].observations.push_back(static_cast<int>(i));
      }
    }
  }
  claim_sides(claims, observations, objects, standing, options, out);
  return out;
}

void mark_owners(Association& association, std::span<const Observation> observations,
                 std::span<const MapObject* const> objects, DepthView& view) {
  std::vector<std::vector<std::size_t>> matches_of(observations.size());
  std::vector<std::uint16_t> single(observations.size(), kNobody);
  auto next = kFirstInstance;
  for (std::size_t k = 0; k < association.matches.size(); ++k) {
    association.matches[k].owner = next++;
    for (const int i : association.matches[k].observations) matches_of[static_cast<std::size_t>(i)].push_back(k);
    for (const int i : association.matches[k].sides) matches_of[static_cast<std::size_t>(i)].push_back(k);
  }
  for (const int i : association.unclaimed) {
    association.unclaimed_owner.push_back(next);
    single[static_cast<std::size_t>(i)] = next++;
  }
  const Rigid3& T_world_camera = view.T_world_camera;
  std::vector<Rigid3> T_volume_camera;
  std::vector<std::vector<FencePlane>> fences;
  for (const Match& match : association.matches) {
    const MapObject& object = *objects[static_cast<std::size_t>(match.object)];
    T_volume_camera.push_back(object.T_world_volume.inverse() * T_world_camera);
    fences.push_back(known_fences(object));
  }
  const auto fenced = [&](std::size_t k, const Eigen::Vector3d& p_camera) {
    if (fences[k].empty()) return false;
    const Eigen::Vector3d p_volume = T_volume_camera[k] * p_camera;
    return std::ranges::any_of(fences[k], [&](const FencePlane& plane) { return plane.distance_m(p_volume) > 0.0; });
  };
  const auto nearest = [&](const std::vector<std::size_t>& among, const Eigen::Vector3d& p_camera) {
    std::uint16_t best = kNobody;
    double least = 1e9;
    for (const std::size_t k : among) {
      if (fenced(k, p_camera)) continue;
      const MapObject& object = *objects[static_cast<std::size_t>(association.matches[k].object)];
      const auto sample = among.size() > 1 ? object.volume.sample(T_volume_camera[k] * p_camera) : std::nullopt;
      const double distance = sample ? std::abs(sample->distance_m) : 1e6;
      if (distance < least) least = distance, best = association.matches[k].owner;
    }
    return best;
  };
  for (int y = 0; y < view.camera.height; ++y) {
    for (int x = 0; x < view.camera.width; ++x) {
      std::uint16_t& owner = view.owner.at(x, y);
      if (owner < kFirstInstance) continue;
      const auto i = static_cast<std::size_t>(owner - kFirstInstance);
      const std::vector<std::size_t>& among = matches_of[i];
      if (among.empty()) {
        owner = single[i];
      } else {
        const double z = static_cast<double>(view.depth_m.at(x, y));
        owner =
            nearest(among, {(x - view.camera.cx) / view.camera.fx * z, (y - view.camera.cy) / view.camera.fy * z, z});
      }
    }
  }
}

}  // namespace povslam
