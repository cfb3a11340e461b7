// The object library before a small world that the test changes while a robot drives by.
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/objects/library.hpp"
#include "tests/support/small_world.hpp"

namespace povslam {

class LibraryStory : public testing::Test {
 protected:
  explicit LibraryStory(const ObjectOptions& options = {}, ClassTable classes = SmallWorld::classes())
      : library(options, VolumeOptions{0.05, 0.2, 400}, IntegrateOptions{}, std::move(classes)) {}

  // `count` views from an arc about (2.5, 0), 0.2 s apart.
  void drive(int count, bool labelled = true) {
    for (int i = 0; i < count; ++i) {
      const double angle = -0.5 + 1.0 * (i + 0.5) / count;
      const Eigen::Vector2d eye = Eigen::Vector2d(2.5, 0.0) - 3.0 * Eigen::Vector2d(std::cos(angle), std::sin(angle));
      look(SmallWorld::looking(eye, {2.5, 0.0}), labelled);
    }
  }
  void look(const Rigid3& T_world_camera, bool labelled = true) {
    now += kNsPerSecond / 5;
    world.look(T_world_camera, now, view, labels);
    if (!labelled) {
      for (std::uint8_t& id : labels.pixels()) id = id >= SmallWorld::kCarton ? std::uint8_t{0} : id;
    }
    const Extraction& extraction = extractor.from_classes(labels, library.classes(), view);
    library.observe(extraction, empty, view, step);
    events.insert(events.end(), step.events.begin(), step.events.end());
    empty.observe(view);
  }
  void finish() {
    library.finish(step);
    events.insert(events.end(), step.events.begin(), step.events.end());
  }
  std::vector<const MapObject*> confirmed() const {
    std::vector<const MapObject*> out;
    for (const auto& object : library.objects()) {
      if (object->phase == ObjectPhase::confirmed) out.push_back(object.get());
    }
    return out;
  }
  void see_ten_around() {  // cartons 0.6 m wide and deep, but none ahead
    for (int i = 0; i < 10; ++i) {
      const double angle = 0.5 + 0.5 * i;
      world.things.push_back({{{2.2 * std::cos(angle), 2.2 * std::sin(angle), 0.35}, {0.6, 0.6, 0.7}, angle}});
    }
    for (int i = 0; i < 40; ++i) {
      const double angle = 0.5 + 0.125 * i;
      look(SmallWorld::looking({0.0, 0.0}, {std::cos(angle), std::sin(angle)}));
    }
  }
  static Box carton(double x, double y, double yaw = 0.4) { return {{x, y, 0.35}, {0.8, 0.6, 0.7}, yaw}; }

  SmallWorld world;
  TimeNs now = 0;
  DepthView view;
  ImageU8 labels;
  Extractor extractor{ExtractOptions{}, 0.0025};
  EmptySpace empty{EmptySpaceOptions{}};
  ObjectLibrary library;
  LibraryStep step;
  std::vector<ObjectEvent> events;
};

}  // namespace povslam
