#include "pipeline/keyframe_anchors.hpp"

#include <gtest/gtest.h>

#include <map>

namespace povslam {
namespace {

Rigid3 at(double x) {
  return {Eigen::Quaterniond::Identity(), {x, 0.0, 0.0}};
}

class KeyframeAnchorsTest : public testing::Test {
 protected:
  void hang_on(std::int64_t keyframe) { anchors_.hang_on(keyframe, poses_.at(keyframe)); }
  const std::vector<KeyframeMotion>& collect() {
    anchors_.collect(
        [this](std::int64_t keyframe) {
          const auto pose = poses_.find(keyframe);
          return pose == poses_.end() ? std::nullopt : std::optional(pose->second);
        },
        motions_);
    return motions_;
  }
  std::map<std::int64_t, Rigid3> poses_{{3, at(3.0)}, {5, at(5.0)}, {9, at(9.0)}};
  KeyframeAnchors anchors_;
  std::vector<KeyframeMotion> motions_;
};

TEST_F(KeyframeAnchorsTest, TellWhichKeyframesMovedAndHowOnce) {
  hang_on(9);
  hang_on(3);
  hang_on(5);
  EXPECT_TRUE(collect().empty());
  poses_[3] = at(3.001);  // bundle adjustment
  poses_[5] = at(5.5);
  poses_[9] = at(8.0);
  ASSERT_EQ(collect().size(), 2U);
  EXPECT_NEAR(motion_of(motions_, 5)->translation.x(), 0.5, 1e-12);
  EXPECT_NEAR(motion_of(motions_, 9)->translation.x(), -1.0, 1e-12);
  EXPECT_EQ(motion_of(motions_, 3), nullptr);
  EXPECT_TRUE(collect().empty());
}

TEST_F(KeyframeAnchorsTest, CountFromTheFirstViewThatHungOnIt) {
  hang_on(5);
  poses_[5] = at(5.2);
  hang_on(5);
  ASSERT_EQ(collect().size(), 1U);
  EXPECT_NEAR(motions_[0].T_new_old.translation.x(), 0.2, 1e-12);
}

TEST_F(KeyframeAnchorsTest, SayNothingOfKeyframesNobodyKnowsAnyMore) {
  hang_on(5);
  poses_.clear();
  EXPECT_TRUE(collect().empty());
}

}  // namespace
}  // namespace povslam
