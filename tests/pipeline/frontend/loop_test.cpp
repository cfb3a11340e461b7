#include "pipeline/frontend/loop.hpp"

#include <gtest/gtest.h>

#include "pipeline/backend/close_loop.hpp"
#include "pipeline/frontend/map_places.hpp"
#include "tests/pipeline/frontend/drifted_ring.hpp"
#include "tests/pipeline/frontend/map_invariants.hpp"

namespace povslam {
namespace {

using made::DriftedRing;

struct Drive {
  explicit Drive(const Vector6d& drift) : ring(drift), places(DriftedRing::kFeatures, DriftedRing::options().map) {
    places.update(ring.map);
  }
  // Keyframes until the closer asks something, at most so many.
  LoopProblem* drive(int keyframes) {
    for (int k = 0; k < keyframes; ++k) {
      const std::int32_t slot = ring.keep();
      places.update(ring.map);
      closer.look(ring.map, places.index(), slot, k);
      if (LoopProblem* problem = closer.take()) return problem;
    }
    return nullptr;
  }
  std::int64_t newest() const { return ring.map.next_keyframe_id() - 1; }

  DriftedRing ring;
  MapPlaces places;
  LoopCloser closer{ring.camera, DriftedRing::options()};
};

}  // namespace

TEST(LoopCloser, ClosesARoundThatDrifted) {
  Drive drive(made::some_drift());
  const double before_m = drive.ring.worst_position_error_m();
  LoopProblem* problem = drive.drive(8);
  ASSERT_NE(problem, nullptr);
  close_loop(*problem, {});
  drive.closer.give_back(problem);
  const auto T_new_old = drive.closer.apply(drive.ring.map, drive.newest());
  ASSERT_TRUE(T_new_old);
  const int landmarks = drive.ring.map.num_landmarks();
  int joined = 0;
  while (drive.closer.join_some(drive.ring.map)) ++joined;
  EXPECT_GT(joined, 3);
  EXPECT_LT(drive.ring.map.num_landmarks(), landmarks - 200);
  EXPECT_LT(drive.ring.worst_position_error_m(), 0.35 * before_m);
  EXPECT_EQ(drive.closer.counts().closed, 1);
  EXPECT_NE(drive.closer.next_to_smooth(drive.ring.map), kNone);
  EXPECT_EQ(broken_sightings(drive.ring.map), "");
}

TEST(LoopCloser, OnlyJoinsARoundThatCameOutRight) {
  Drive drive(Vector6d::Zero());
  EXPECT_EQ(drive.drive(8), nullptr);
  EXPECT_GE(drive.closer.counts().joined, 1);
  EXPECT_TRUE(drive.closer.join_some(drive.ring.map));
}

TEST(LoopCloser, TakesARefusalAndGoesOn) {
  Drive drive(made::some_drift());
  LoopProblem* problem = drive.drive(8);
  ASSERT_NE(problem, nullptr);
  drive.closer.give_back(problem);  // unsolved: timed out
  EXPECT_FALSE(drive.closer.apply(drive.ring.map, drive.newest()));
  EXPECT_EQ(drive.closer.counts().refused, 1);
  EXPECT_NE(drive.drive(8), nullptr);  // asked again
}

TEST(LoopCloser, BelievesNoPlaceFartherOffThanTrackingDrifts) {
  Drive drive((Vector6d() << 0.04, 0.0, 0.01, 0.0, 0.0, 0.0).finished());
  EXPECT_EQ(drive.drive(8), nullptr);
  EXPECT_EQ(drive.closer.counts().suspected, 0);
}

}  // namespace povslam
