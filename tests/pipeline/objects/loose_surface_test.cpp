#include "pipeline/objects/loose_surface.hpp"

#include <gtest/gtest.h>

#include "pipeline/base/time.hpp"
#include "tests/support/small_world.hpp"

namespace povslam {
namespace {

class LooseSurfaceStory : public testing::Test {
 protected:
  void look(int count, bool labelled) {
    for (int i = 0; i < count; ++i) {
      now += kNsPerSecond / 5;
      world.look(SmallWorld::looking({0.3, 0.05 * i}, {2.5, 0.0}), now, view, labels);
      if (!labelled) {
        for (std::uint8_t& id : labels.pixels()) id = id >= SmallWorld::kCarton ? std::uint8_t{0} : id;
      }
      const Extraction& extraction = extractor.from_classes(labels, library.classes(), view);
      library.observe(extraction, empty, view, step);
      loose.observe(view, library);
    }
  }
  std::size_t triangles() {
    Mesh mesh;
    loose.append_to(mesh, {.min_weight = 0.1});
    return mesh.triangles.size();
  }

  SmallWorld world;
  TimeNs now = 0;
  DepthView view;
  ImageU8 labels;
  Extractor extractor{ExtractOptions{}, 0.0025};
  EmptySpace empty{EmptySpaceOptions{}};
  ObjectLibrary library{ObjectOptions{}, VolumeOptions{0.05, 0.2, 400}, IntegrateOptions{}, SmallWorld::classes()};
  LooseSurface loose{VolumeOptions{0.05, 0.2, 4000}, IntegrateOptions{}};
  LibraryStep step;
};

TEST_F(LooseSurfaceStory, WhatNobodyKnowsIsInTheMapUntilItIsAnObject) {
  world.things = {{{{2.5, 0.0, 0.35}, {0.8, 0.8, 0.7}, 0.0}}};
  look(5, false);
  const std::size_t unknown = triangles();
  EXPECT_GT(unknown, 300U);
  look(6, true);
  EXPECT_LT(10 * triangles(), unknown) << "it is the object's now";
}

TEST_F(LooseSurfaceStory, WhatWentIsEmptiedThoughNobodyKnewIt) {
  world.things = {{{{2.5, 0.0, 0.35}, {0.8, 0.8, 0.7}, 0.0}}};
  look(5, false);
  const std::size_t there = triangles();
  world.things.clear();
  look(12, false);
  EXPECT_LT(5 * triangles(), there);
}

TEST_F(LooseSurfaceStory, WhoWalksIsInNoMap) {
  look(5, true);
  const std::size_t without = triangles();
  world.things = {{{{2.5, 0.0, 0.85}, {0.3, 0.5, 1.7}, 0.0}, SmallWorld::kPerson}};
  look(10, true);
  EXPECT_LE(triangles(), without + 30);
  EXPECT_TRUE(library.objects().empty());
}

}  // namespace
}  // namespace povslam
