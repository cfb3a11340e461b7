#include "pipeline/frontend/map.hpp"

#include <gtest/gtest.h>
#include <rapidcheck/gtest.h>

#include "tests/pipeline/frontend/made_frame.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"
#include "tests/support/alloc_counter.hpp"

namespace povslam {
namespace {

constexpr int kFeatures = 40;

FrontendOptions small_options(int max_keyframes) {
  FrontendOptions options;
  options.orb.num_features = kFeatures;
  options.map.max_keyframes = max_keyframes;
  options.map.max_landmarks = 150;
  return options;
}

struct Fixture {
  explicit Fixture(int max_keyframes = 20)
      : options(small_options(max_keyframes)),
        frame(made::random_frame(made::half_camera(), options, kFeatures, 7)),
        map(kFeatures, options.map, made::level_scales()) {}
  std::int32_t insert(std::int64_t parent = -1, const Rigid3& T_world_camera = {}) {
    return map.insert_keyframe(frame, T_world_camera, Matrix6d::Identity(), parent);
  }
  FrontendOptions options;
  Frame frame;
  Map map;
};

// One random change to the map: `a`, `b`, `c` choose what it is done to.
struct Change {
  int kind = 0, a = 0, b = 0, c = 0;
};

template <class Alive>
std::int32_t choose(int number, std::int32_t slots, Alive&& alive) {
  std::vector<std::int32_t> living;
  for (std::int32_t s = 0; s < slots; ++s) {
    if (alive(s)) living.push_back(s);
  }
  return living.empty() ? kNone : living[static_cast<std::size_t>(number) % living.size()];
}

void share_some(Map& map, std::int32_t from, std::int32_t to, int first) {
  for (int f = 0, added = 0; f < kFeatures && added < 15; ++f) {
    const std::int32_t seen = map.keyframe(from).landmark[static_cast<std::size_t>((f + first) % kFeatures)];
    if (seen == kNone || map.keyframe(to).landmark[static_cast<std::size_t>(f)] != kNone) continue;
    if (map.add_sighting(seen, to, f)) ++added;
  }
}

void apply(const Change& change, Fixture& fixture) {
  Map& map = fixture.map;
  const auto keyframe = [&](int n) {
    return choose(n, map.keyframe_slots(), [&](auto s) { return map.keyframe(s).alive; });
  };
  const auto landmark = [&](int n) {
    return choose(n, map.landmark_slots(), [&](auto s) { return map.landmark(s).alive; });
  };
  const std::int32_t kf = keyframe(change.a), other = keyframe(change.b);
  const std::int32_t point = landmark(change.a), second = landmark(change.b);
  const int feature = change.c % kFeatures;
  if (change.kind <= 1 || kf == kNone) {
    fixture.insert(change.a % (map.next_keyframe_id() + 1) - 1);
  } else if (change.kind == 2) {
    map.remove_keyframe(kf);
  } else if (change.kind <= 4) {
    for (int f = feature; f < kFeatures; ++f) {
      if (map.keyframe(kf).landmark[static_cast<std::size_t>(f)] == kNone) map.create_landmark(kf, f, {0, 0, 2.0 + f});
    }
  } else if (change.kind <= 6) {
    if (kf != other) share_some(map, kf, other, feature);
    map.update_covisibility(other);
  } else if (point == kNone) {
    return;
  } else if (change.kind == 7) {
    map.remove_sighting(point, kf);
  } else if (change.kind == 8) {
    map.merge_landmarks(point, second);
  } else if (change.kind == 9) {
    map.remove_landmark(point);
  } else {
    map.refresh_landmark(point);
    map.update_covisibility(kf);
  }
}

}  // namespace

RC_GTEST_PROP(Map, KeepsItsSightingsTheSameFromBothSidesWhateverIsDone, ()) {
  Fixture fixture;
  const auto number = rc::gen::inRange(0, 1000);
  const auto changes =
      *rc::gen::container<std::vector<std::array<int, 3>>>(rc::gen::container<std::array<int, 3>>(number));
  for (const auto& [a, b, c] : changes) {
    apply({(a / 3 + b + c) % 11, a, b, c}, fixture);
    RC_ASSERT(broken_sightings(fixture.map) == "");
    RC_ASSERT(broken_covisibility(fixture.map, true) == "");
  }
}

TEST(Map, KeepsItsSightingsThroughThousandsOfChangesInAFullMap) {
  Fixture fixture;
  std::mt19937 random(3);
  int most_keyframes = 0, most_landmarks = 0, most_neighbours = 0;
  for (int i = 0; i < 6000; ++i) {
    const auto number = [&random] { return static_cast<int>(random() % 1000); };
    const int kind = number() % 11;  // removals less often, that pools fill
    const bool removal = kind == 2 || kind == 8 || kind == 9;
    const int a = number(), b = number(), c = number();
    apply({removal && a % 4 != 0 ? 5 : kind, a, b, c}, fixture);
    ASSERT_EQ(broken_sightings(fixture.map), "") << "after change " << i << ", of kind " << kind;
    ASSERT_EQ(broken_covisibility(fixture.map, true), "") << "after change " << i << ", of kind " << kind;
    most_keyframes = std::max(most_keyframes, fixture.map.num_keyframes());
    most_landmarks = std::max(most_landmarks, fixture.map.num_landmarks());
    most_neighbours = std::max(most_neighbours, fixture.map.keyframe(0).num_covisible);
  }
  EXPECT_EQ(most_keyframes, 20);  // the story was worth telling
  EXPECT_EQ(most_landmarks, 150);
  EXPECT_GT(most_neighbours, 5);
}

TEST(Map, BoundsItsListsOfSightingsAndNeighbours) {
  Fixture fixture(40);
  Map& map = fixture.map;
  for (int k = 0; k < 40; ++k) fixture.insert(k - 1);
  for (int f = 0; f < 20; ++f) map.create_landmark(0, f, {0, 0, 3});
  for (std::int32_t k = 1; k < 40; ++k) {
    for (std::int32_t l = 0; l < 20; ++l) EXPECT_TRUE(map.add_sighting(l, k, l));
    map.update_covisibility(k);
    ASSERT_EQ(broken_sightings(map), "");
    ASSERT_EQ(broken_covisibility(map, false), "");
  }
  EXPECT_EQ(map.landmark(3).num_sightings, kMaxSightings);
  EXPECT_TRUE(map.sees(0, 3));   // the first sighting stays,
  EXPECT_FALSE(map.sees(1, 3));  // the oldest after it went
  EXPECT_EQ(map.keyframe(39).num_covisible, kMaxCovisible);
  EXPECT_FALSE(map.add_sighting(4, 39, 30));  // seen by it already
  for (std::int32_t k = 39; k > 0; --k) map.remove_keyframe(k);
  EXPECT_EQ(map.keyframe(0).num_covisible, 0);
  EXPECT_EQ(broken_sightings(map), "");
}

TEST(Map, EvictsTheKeyframeLongestOutOfUse) {
  Fixture fixture(4);
  Map& map = fixture.map;
  for (int k = 0; k < 4; ++k) {
    fixture.insert();
    map.create_landmark(k, 0, {0, 0, 3});
  }
  for (const std::int32_t k : {0, 1, 3}) map.keyframe(k).mark = map.new_mark();
  EXPECT_EQ(fixture.insert(), 2);
  EXPECT_EQ(map.num_keyframes(), 4);
  EXPECT_EQ(map.num_landmarks(), 3);
  EXPECT_EQ(map.find_keyframe(2), kNone);
  EXPECT_EQ(map.find_keyframe(4), 2);
  EXPECT_EQ(broken_sightings(map), "");
}

TEST(Map, EvictsTheOldestKeyframeButTheFirstWhenAllAreInUse) {
  Fixture fixture(4);
  for (int k = 0; k < 12; ++k) fixture.insert(k - 1);
  for (std::int64_t id = 0; id < 12; ++id) EXPECT_EQ(fixture.map.find_keyframe(id) != kNone, id == 0 || id >= 9) << id;
}

TEST(Map, RefusesLandmarksBeyondItsCapacity) {
  Fixture fixture;
  Map& map = fixture.map;
  int made = 0, refused = 0;
  for (int k = 0; k < 5; ++k) {
    const std::int32_t slot = fixture.insert();
    for (int f = 0; f < kFeatures; ++f) map.create_landmark(slot, f, {0, 0, 3}) == kNone ? ++refused : ++made;
  }
  EXPECT_EQ(made, 150);
  EXPECT_EQ(refused, 50);
  const std::uint32_t generation = map.landmark(10).generation;
  map.remove_landmark(10);
  EXPECT_EQ(map.create_landmark(4, 39, {0, 0, 3}), 10);
  EXPECT_NE(map.landmark(10).generation, generation);
  EXPECT_EQ(broken_sightings(map), "");
}

TEST(Map, AllocatesNothingWhenItsPoolsAreFull) {
  if (!counting_works()) GTEST_SKIP() << "the sanitizer owns malloc";
  Fixture fixture;
  Map& map = fixture.map;
  start_counting();
  for (int k = 0; k < 60; ++k) {
    const std::int32_t slot = fixture.insert(k - 1);
    for (int f = 0; f < kFeatures; ++f) map.create_landmark(slot, f, {0, 0, 3});
    map.update_covisibility(slot);
  }
  const CallCounts calls = stop_counting();
  EXPECT_EQ(calls.allocations + calls.maps + calls.locks, 0U);
  EXPECT_EQ(map.num_keyframes(), 20);
}

TEST(Map, AnswersForARemovedKeyframeThroughItsHeir) {
  Fixture fixture;
  Map& map = fixture.map;
  const auto at = [](double x) { return Rigid3{so3_exp({0.0, 0.1 * x, 0.0}), {x, 0.0, 0.0}}; };
  for (int k = 0; k < 4; ++k) fixture.insert(k - 1, at(k));
  // Most landmarks of keyframe 1 are seen by keyframe 3: that is its heir.
  for (int f = 0; f < 20; ++f) map.create_landmark(1, f, {0, 0, 3});
  for (int f = 0; f < 12; ++f) map.add_sighting(f, 2, f);
  for (int f = 0; f < 16; ++f) map.add_sighting(f, 3, f);
  map.update_covisibility(1);
  ASSERT_EQ(map.keyframe(1).covisible[0].keyframe, 3);
  map.remove_keyframe(1);
  EXPECT_LT((map.keyframe_pose(1)->translation - at(1).translation).norm(), 1e-12);
  const Rigid3 correction{so3_exp({0.0, 0.0, 0.3}), {0.0, 5.0, 0.0}};
  map.keyframe(3).T_world_camera = correction * at(3);
  const Rigid3 expected = correction * at(1);
  EXPECT_LT(local(expected, *map.keyframe_pose(1)).norm(), 1e-12);
  // The heir goes as well, and hands on what hangs on it.
  map.update_covisibility(3);
  map.remove_keyframe(3);
  EXPECT_LT(local(expected, *map.keyframe_pose(1)).norm(), 1e-12);
  EXPECT_FALSE(map.keyframe_pose(4));
  EXPECT_FALSE(map.keyframe_pose(-1));
}

TEST(Map, AnswersForARemovedKeyframeWhoseParentIsGoneToo) {
  Fixture fixture;
  Map& map = fixture.map;
  for (int k = 0; k < 3; ++k) fixture.insert(k - 1, {Eigen::Quaterniond::Identity(), {1.0 * k, 0, 0}});
  map.remove_keyframe(1);
  map.remove_keyframe(2);  // it was tracked against 1, which hangs on 0
  map.keyframe(0).T_world_camera.translation.y() = 2.0;
  ASSERT_TRUE(map.keyframe_pose(2));
  EXPECT_LT((map.keyframe_pose(2)->translation - Eigen::Vector3d(2.0, 2.0, 0.0)).norm(), 1e-12);
}

TEST(Map, NeverMakesAKeyframeItsOwnHeir) {
  Fixture fixture;
  Map& map = fixture.map;
  for (int k = 0; k < 2; ++k) fixture.insert(k - 1);
  for (int f = 0; f < 20; ++f) map.add_sighting(map.create_landmark(0, f, {0, 0, 3}), 1, f);
  map.update_covisibility(1);
  map.remove_keyframe(0);  // hangs on 1, which was tracked against 0
  EXPECT_TRUE(map.keyframe_pose(0));
  map.update_covisibility(1);
  map.remove_keyframe(1);
  EXPECT_FALSE(map.keyframe_pose(0));
  EXPECT_FALSE(map.keyframe_pose(1));
}

TEST(Map, DescribesALandmarkByTheLookMostOthersResemble) {
  Fixture fixture;
  Map& map = fixture.map;
  for (Descriptor& d : fixture.frame.features.descriptor) d = {};
  fixture.frame.features.descriptor[0] = {0xFFFFFFFFULL, 0, 0, 0};  // an odd look
  fixture.frame.features.level[2] = 3;
  for (const double x : {-1.0, 0.0, 1.0}) fixture.insert(-1, {Eigen::Quaterniond::Identity(), {x, 0, 0}});
  map.keyframe(2).descriptor[2] = {0x1ULL, 0, 0, 0};
  const std::int32_t point = map.create_landmark(0, 0, {0.0, 0.0, 2.0});
  EXPECT_EQ(map.landmark(point).descriptor[0], 0xFFFFFFFFULL);
  map.add_sighting(point, 1, 1);
  map.add_sighting(point, 2, 2);
  map.refresh_landmark(point);
  EXPECT_LT(map.landmark(point).descriptor[0], 2U);
  EXPECT_LT((map.landmark(point).toward_camera - Eigen::Vector3d(0, 0, -1)).norm(), 1e-12);
}

TEST(Map, MergesALandmarkIntoAnother) {
  Fixture fixture;
  Map& map = fixture.map;
  for (int k = 0; k < 4; ++k) fixture.insert();
  const std::int32_t keep = map.create_landmark(0, 0, {0, 0, 2}), drop = map.create_landmark(1, 1, {0, 0, 2});
  map.add_sighting(keep, 2, 2);
  map.add_sighting(drop, 2, 3);  // the same keyframe saw both
  map.add_sighting(drop, 3, 4);
  map.landmark(drop).found = 7;
  map.merge_landmarks(keep, drop);
  EXPECT_FALSE(map.landmark(drop).alive);
  EXPECT_EQ(map.landmark(keep).num_sightings, 4);
  EXPECT_EQ(map.landmark(keep).found, 8);
  EXPECT_EQ(map.keyframe(2).landmark[3], kNone);
  EXPECT_EQ(broken_sightings(map), "");
}

}  // namespace povslam
