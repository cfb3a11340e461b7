#include "pipeline/backend/vem.hpp"

#include <gtest/gtest.h>

#include "tests/support/simulated_objects.hpp"

namespace povslam {

using simulated::make_objects;
using simulated::ObjectsOptions;

TEST(Vem, TellsMovedObjectsAndFindsItsPoseThoughMostHaveMoved) {
  ObjectsOptions options;
  options.start_m = 0.3;
  options.start_rad = 0.14;
  const auto made = make_objects(options);
  const VemResult result = Vem(VemOptions{}).solve(made.window);
  ASSERT_EQ(result.fault, "");
  EXPECT_TRUE(result.solved);
  EXPECT_TRUE(result.converged);
  for (std::size_t i = 0; i < made.moved.size(); ++i) EXPECT_EQ(result.objects[i].accepted, made.moved[i] == 0) << i;
  for (std::size_t t = 0; t < made.truth.size(); ++t) {
    EXPECT_LT((result.poses[t].translation - made.truth[t].translation).norm(), 0.02);
  }
  for (const auto& it : result.iterations) {
    printf("elbo %.3f cost %.3f moved %.5f %.5f acc %d flip %d err %.4f\n", it.elbo, it.cost, it.moved_m, it.moved_rad,
           it.num_accepted, it.num_flipped, (it.T_world_camera.translation - made.truth.back().translation).norm());
  }
}

}  // namespace povslam
