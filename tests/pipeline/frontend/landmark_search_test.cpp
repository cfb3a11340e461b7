#include "pipeline/frontend/landmark_search.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/made_frame.hpp"

namespace povslam {
namespace {

// A keyframe that sees a cloud of points, each of them a landmark, and frames that see the same cloud.
struct Room {
  Room()
      : points(made::cloud(150, 1)),
        looks(made::looks(points.size(), 2)),
        map(300, options().map, made::level_scales()),
        search(camera, options()),
        matcher(300),
        local_map(options().map),
        last(made::view_of(camera, options(), T_world_last, points, looks)) {
    map.insert_keyframe(last.frame, T_world_last, Matrix6d::Zero(), -1);
    for (std::size_t f = 0; f < last.shown.size(); ++f) {
      last.frame.landmark[f] =
          map.create_landmark(0, static_cast<int>(f), points[static_cast<std::size_t>(last.shown[f])]);
    }
  }
  static FrontendOptions options() {
    FrontendOptions options;
    options.orb.num_features = 300;
    options.map.max_keyframes = 10;
    options.map.max_landmarks = 1000;
    return options;
  }
  made::View view(const Rigid3& T_world_camera) const {
    return made::view_of(camera, options(), T_world_camera, points, looks);
  }
  void match_local(const made::View& now, const Rigid3& T_world_camera, float widening) {
    local_map.collect(map, last.frame, T_world_last);
    search.match_local(map, local_map.landmarks(), now.frame, T_world_camera.inverse(), widening, matcher);
  }
  // Matches, all checked to be right: what a feature shows is what its landmark was made of.
  int right_matches(const made::View& now) const {
    int count = 0;
    for (int i = 0; i < now.frame.size(); ++i) {
      const std::int32_t tag = matcher.tag_of(i);
      if (tag == kNone) continue;
      ++count;
      const Eigen::Vector3d& shown = points[static_cast<std::size_t>(now.shown[static_cast<std::size_t>(i)])];
      const Eigen::Vector3d p_world = tag >= kPointOfLast ? last.frame.T_camera_world.inverse() *
                                                                last.frame.point_camera(tag - kPointOfLast, camera)
                                                          : map.landmark(tag).p_world;
      EXPECT_LT((shown - p_world).norm(), 1e-4);
    }
    return count;
  }

  PinholeCamera camera = made::half_camera();
  Rigid3 T_world_last = made::looking_along_y({0.0, 0.0, 0.0});
  Rigid3 T_world_now = made::looking_along_y({0.1, 0.05, 0.02});
  std::vector<Eigen::Vector3d> points;
  std::vector<Descriptor> looks;
  Map map;
  LandmarkSearch search;
  Matcher matcher;
  LocalMap local_map;
  made::View last;
};

}  // namespace

TEST(LandmarkSearch, FindsWhatTheLastFrameSawWhereThePoseSays) {
  Room room;
  const made::View now = room.view(room.T_world_now);
  room.search.match_last(room.map, room.last.frame, now.frame, room.T_world_now.inverse(), 5.0F, room.matcher);
  EXPECT_GT(room.right_matches(now), 0.85 * now.frame.size());
  // Elsewhere it looks in vain.
  const Rigid3 wrong = room.T_world_now * Rigid3{so3_exp({0.0, 0.1, 0.0}), Eigen::Vector3d::Zero()};
  room.search.match_last(room.map, room.last.frame, now.frame, wrong.inverse(), 5.0F, room.matcher);
  EXPECT_LT(room.matcher.count(), 5);
}

TEST(LandmarkSearch, FollowsPointsOfTheLastFrameThatAreNoLandmarks) {
  Room room;
  const int n = room.last.frame.size();
  for (int f = 0; f < n; f += 2) room.last.frame.landmark[static_cast<std::size_t>(f)] = kNone;
  room.last.frame.inverse_depth[0] = 0.0F;  // neither landmark nor depth: nowhere
  const made::View now = room.view(room.T_world_now);
  room.search.match_last(room.map, room.last.frame, now.frame, room.T_world_now.inverse(), 5.0F, room.matcher);
  EXPECT_GT(room.right_matches(now), 0.85 * now.frame.size());
  int points = 0;
  for (int i = 0; i < now.frame.size(); ++i) {
    if (room.matcher.tag_of(i) >= kPointOfLast) ++points;
    EXPECT_NE(room.matcher.tag_of(i), kPointOfLast + 0);
  }
  EXPECT_GT(points, n / 3);
}

TEST(LandmarkSearch, FindsTheLocalMapAndCountsWhatItLookedFor) {
  Room room;
  const made::View now = room.view(room.T_world_now);
  room.match_local(now, room.T_world_now, 1.0F);
  const int right = room.right_matches(now);
  int looked_for = 0;
  for (std::int32_t l = 0; l < room.map.landmark_slots(); ++l) looked_for += room.map.landmark(l).visible - 1;
  EXPECT_GT(right, 0.85 * now.frame.size());
  EXPECT_GE(looked_for, right);
  EXPECT_LE(looked_for, now.frame.size());
}

TEST(LandmarkSearch, LooksFartherWhenAskedTo) {
  Room room;
  const made::View now = room.view(room.T_world_now);
  const Rigid3 off = room.T_world_now * Rigid3{so3_exp({0.0, 8.0 / 262.5, 0.0}), Eigen::Vector3d::Zero()};  // by 8 px
  room.match_local(now, off, 1.0F);
  EXPECT_LT(room.matcher.count(), 5);
  room.match_local(now, off, 4.0F);
  EXPECT_GT(room.right_matches(now), 0.7 * now.frame.size());
}

TEST(LandmarkSearch, ExpectsAPointTwiceAsNearOnACoarserLevel) {
  Room room;
  const Rigid3 near = made::looking_along_y({0.0, 1.7, 0.0});
  made::View now = room.view(near);
  // All features on level 0: what came nearer by more than 1.2 ^ 1.5 is looked for higher up only.
  room.match_local(now, near, 1.0F);
  for (int i = 0; i < now.frame.size(); ++i) {
    if (room.matcher.tag_of(i) == kNone) continue;
    const Eigen::Vector3d& p = room.map.landmark(room.matcher.tag_of(i)).p_world;
    EXPECT_LT((p - room.T_world_last.translation).norm() / (p - near.translation).norm(), 1.32);
  }
  // On the level their size says, they are found.
  for (std::size_t i = 0; i < now.shown.size(); ++i) {
    const Eigen::Vector3d& p = room.points[static_cast<std::size_t>(now.shown[i])];
    const double closer = (p - room.T_world_last.translation).norm() / (p - near.translation).norm();
    now.frame.features.level[i] = static_cast<std::uint8_t>(std::lround(std::log(closer) / std::log(1.2)));
  }
  room.match_local(now, near, 1.0F);
  int known = 0;  // of what is in view now, seen before
  for (const int shown : now.shown) {
    known += std::count(room.last.shown.begin(), room.last.shown.end(), shown) > 0 ? 1 : 0;
  }
  EXPECT_GT(room.right_matches(now), 0.8 * known);
}

TEST(LandmarkSearch, DoesNotLookForSurfacesFromBehind) {
  Room room;
  for (std::int32_t l = 0; l < room.map.landmark_slots(); ++l) room.map.landmark(l).toward_camera *= -1.0;
  const made::View now = room.view(room.T_world_now);
  room.match_local(now, room.T_world_now, 1.0F);
  EXPECT_EQ(room.matcher.count(), 0);
}

TEST(LandmarkSearch, LeavesFeaturesToTheLandmarksThatCameFirst) {
  Room room;
  const made::View now = room.view(room.T_world_now);
  room.local_map.collect(room.map, room.last.frame, room.T_world_last);
  const auto all = room.local_map.landmarks();
  const auto first = all.first(all.size() / 2), more = all.subspan(first.size());
  // The others are copies of the first, whose own looks have faded a little.
  for (std::size_t i = 0; i < first.size(); ++i) {
    Landmark &own = room.map.landmark(first[i]), &copy = room.map.landmark(more[i]);
    copy.p_world = own.p_world;
    copy.descriptor = own.descriptor;
    own.descriptor[0] ^= 0xFF;
  }
  room.search.match_local(room.map, first, now.frame, room.T_world_now.inverse(), 1.0F, room.matcher);
  const int matched = room.matcher.count();
  std::vector<std::int32_t> tags;
  for (int i = 0; i < now.frame.size(); ++i) tags.push_back(room.matcher.tag_of(i));
  room.search.match_more(room.map, more, now.frame, room.T_world_now.inverse(), 1.0F, room.matcher);
  EXPECT_GT(matched, 20);
  for (int i = 0; i < now.frame.size(); ++i) {
    const std::int32_t tag = tags[static_cast<std::size_t>(i)];
    EXPECT_TRUE(tag == kNone || room.matcher.tag_of(i) == tag) << i;
  }
}

}  // namespace povslam
