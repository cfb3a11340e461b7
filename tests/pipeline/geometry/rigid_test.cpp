#include "pipeline/geometry/rigid.hpp"

#include <gtest/gtest.h>

namespace povslam {

TEST(Rigid3, InverseUndoesTheMotion) {
  Vector6d xi;
  xi << 1.0, -2.0, 0.5, 0.3, -0.8, 2.0;
  const Rigid3 T = se3_exp(xi);
  EXPECT_LT(se3_log(T * T.inverse()).norm(), 1e-12);
  EXPECT_LT((se3_log(T) - xi).norm(), 1e-12);
}

}  // namespace povslam
