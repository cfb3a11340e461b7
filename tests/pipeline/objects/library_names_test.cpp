// Stories of things that geometry tells apart and a network names now and then.
#include <gtest/gtest.h>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/library.hpp"
#include "tests/support/small_world.hpp"

namespace povslam {
namespace {

constexpr std::uint16_t kChair = 7, kCouch = 8, kPerson = 9;

ClassTable names() {
  return with_unnamed_things(
      {"names",
       {make_class(kChair, "chair", ClassKind::semi_static), make_class(kCouch, "couch", ClassKind::semi_static),
        make_class(kPerson, "person", ClassKind::dynamic)}});
}

class NamedStory : public testing::Test {
 protected:
  // One view from a step further along an arc about (2.5, 0); the thing there is called so.
  void look(SegmentClass name) {
    now += kNsPerSecond / 5;
    const double angle = -0.5 + 0.05 * static_cast<double>(views++ % 20);
    const Eigen::Vector2d eye = Eigen::Vector2d(2.5, 0.0) - 3.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
    world.look(SmallWorld::looking(eye, {2.5, 0.0}), now, view, labels);
    ImageU16 instances(labels.width(), labels.height());
    for (std::size_t i = 0; i < labels.size(); ++i) {
      instances.data()[i] = labels.data()[i] >= SmallWorld::kCarton ? kFirstInstance : kStructure;
    }
    library.observe(extractor.from_instances(instances, {name}, view), empty, view, step);
    events.insert(events.end(), step.events.begin(), step.events.end());
    empty.observe(view);
  }
  std::vector<const MapObject*> confirmed() const {
    std::vector<const MapObject*> out;
    for (const auto& object : library.objects()) {
      if (object->phase == ObjectPhase::confirmed) out.push_back(object.get());
    }
    return out;
  }

  SmallWorld world;
  int views = 0;
  TimeNs now = 0;
  DepthView view;
  ImageU8 labels;
  Extractor extractor{ExtractOptions{}, 0.0025};
  EmptySpace empty{EmptySpaceOptions{}};
  ObjectLibrary library{ObjectOptions{}, VolumeOptions{0.05, 0.2, 400}, IntegrateOptions{}, names()};
  LibraryStep step;
  std::vector<ObjectEvent> events;
};

const SmallWorld::Thing kThing{{{2.5, 0.0, 0.35}, {0.8, 0.6, 0.7}, 0.4}};
constexpr SegmentClass kNotAsked{kUnnamedThing, 0}, kNoName{kUnnamedThing, 1};
constexpr SegmentClass called(std::uint16_t id) {
  return {id, kVotesOfName};
}

TEST_F(NamedStory, AThingNamedInSomeViewsAndNotInOthersIsOneThing) {
  world.things = {kThing};
  for (int i = 0; i < 20; ++i) look(i % 4 == 0 ? called(kChair) : i % 2 == 0 ? kNoName : kNotAsked);
  EXPECT_EQ(library.objects().size(), 1U);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(library.record_of(*confirmed()[0]).class_name, "chair");
  EXPECT_TRUE(events.empty());
}

TEST_F(NamedStory, OneWrongNameNeitherSplitsNorRenamesAThing) {
  world.things = {kThing};
  for (int i = 0; i < 20; ++i) look(called(i == 6 ? kCouch : kChair));
  ASSERT_EQ(library.objects().size(), 1U);
  EXPECT_EQ(confirmed()[0]->class_id(), kChair);
}

TEST_F(NamedStory, AThingThatNobodyNamesStaysAThing) {
  world.things = {kThing};
  for (int i = 0; i < 20; ++i) look(i == 9 ? called(kChair) : kNoName);
  ASSERT_EQ(confirmed().size(), 1U);
  EXPECT_EQ(library.record_of(*confirmed()[0]).class_name, "object");
}

TEST_F(NamedStory, WhatIsNamedAPersonIsNoObject) {
  world.things = {kThing};
  look(kNotAsked);
  look(called(kPerson));
  for (int i = 0; i < 10; ++i) look(i % 3 == 0 ? called(kPerson) : kNotAsked);
  EXPECT_TRUE(confirmed().empty());
}

TEST_F(NamedStory, AnObjectThatTurnsOutToBeAPersonGoesWithoutAWord) {
  world.things = {kThing};
  for (int i = 0; i < 6; ++i) look(kNoName);
  ASSERT_EQ(confirmed().size(), 1U);
  for (int i = 0; i < 6; ++i) look(called(kPerson));
  EXPECT_TRUE(confirmed().empty());
  library.finish(step);
  EXPECT_TRUE(step.events.empty());
  EXPECT_TRUE(events.empty());
}

}  // namespace
}  // namespace povslam
