#include "pipeline/frontend/fuse.hpp"

#include <gtest/gtest.h>

#include "tests/pipeline/frontend/drifted_ring.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"

namespace povslam {
namespace {

using made::DriftedRing;

std::vector<std::int32_t> landmarks_of(const Map& map, std::int64_t keyframe) {
  std::vector<std::int32_t> seen;
  for (const std::int32_t slot : map.keyframe(map.find_keyframe(keyframe)).landmark) {
    if (slot != kNone) seen.push_back(slot);
  }
  return seen;
}

}  // namespace

TEST(LandmarkFuser, MakesOneOfWhatTwoVisitsSaw) {
  DriftedRing ring(Vector6d::Zero());
  const std::int64_t now = DriftedRing::kRound + 2, then = 2;  // the same view
  const std::vector<std::int32_t> old = landmarks_of(ring.map, then);
  const int before = ring.map.num_landmarks();
  const std::int32_t slot = ring.map.find_keyframe(now);
  LandmarkFuser fuser(ring.camera, DriftedRing::options());
  const int gained = fuser.fuse(ring.map, slot, old);
  EXPECT_GT(gained, static_cast<int>(0.9 * static_cast<double>(old.size())));
  EXPECT_EQ(ring.map.num_landmarks(), before - gained);
  EXPECT_EQ(broken_sightings(ring.map), "");
  EXPECT_GT(weight_of(ring.map.keyframe(slot), ring.map.find_keyframe(then)), 100);
  EXPECT_EQ(fuser.fuse(ring.map, slot, old), 0);
}

TEST(LandmarkFuser, JoinsNothingThatLiesElsewhere) {
  DriftedRing ring((Vector6d() << 0.03, 0.0, 0.01, 0.0, 0.0, 0.0).finished());  // more than a metre off in the end
  const std::vector<std::int32_t> old = landmarks_of(ring.map, 2);
  LandmarkFuser fuser(ring.camera, DriftedRing::options());
  EXPECT_LT(fuser.fuse(ring.map, ring.map.find_keyframe(DriftedRing::kRound + 2), old), 10);
}

}  // namespace povslam
