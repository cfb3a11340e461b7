// How deep things without a sure class are taken to be: as those that stand in a row with them show it.
#include "tests/pipeline/objects/library_story.hpp"

namespace povslam {
namespace {

class RowStory : public LibraryStory {
 protected:
  RowStory() : LibraryStory({}, with_unnamed_things({})) {}

  void look(const Rigid3& T_world_camera) {
    now += kNsPerSecond / 5;
    world.look(T_world_camera, now, view, labels);
    ImageU16 instances(labels.width(), labels.height());
    for (std::size_t i = 0; i < labels.size(); ++i) {
      instances.data()[i] = labels.data()[i] >= SmallWorld::kCarton ? kFirstInstance : kStructure;
    }
    library.observe(extractor.from_instances(instances, {{kUnnamedThing, 1}}, view), empty, view, step);
    empty.observe(view);
  }
  // A row of six along y, and 40 views that pass it slantingly.
  void see_row(double x, double deep_m) {
    for (int i = 0; i < 6; ++i) world.things.push_back({{{x, 1.2 * i, 0.4}, {deep_m, 0.7, 0.8}, 0.0}});
    for (int i = 0; i < 40; ++i) look(SmallWorld::looking({0.0, -2.5 + 0.2 * i}, {x, -0.6 + 0.2 * i}));
  }
  const MapObject* object_at(double x, double y) const {
    for (const auto& object : library.objects()) {
      if ((object->box_world().center.head<2>() - Eigen::Vector2d(x, y)).norm() < 0.5) return object.get();
    }
    return nullptr;
  }
};

TEST_F(RowStory, AThingSeenFromOneSideIsAsDeepAsThoseOfItsRow) {
  see_row(2.5, 0.3);
  see_row(-2.5, 0.8);
  world.things.push_back({{{2.5, -4.0, 0.4}, {0.3, 0.7, 0.8}, 0.0}});
  for (int i = 0; i < 8; ++i) look(SmallWorld::looking({0.0, -4.05 + 0.02 * i}, {2.5, -4.0}));
  const MapObject* frontal = object_at(2.5, -4.0);
  ASSERT_NE(frontal, nullptr);
  EXPECT_LT(frontal->box.size_m.head<2>().minCoeff(), 0.45) << "as deep as those across the aisle";
}

}  // namespace
}  // namespace povslam
