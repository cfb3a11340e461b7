#include <gtest/gtest.h>

#include "tools/povslam/scores/event_score.hpp"
#include "tools/povslam/scores/object_score.hpp"
#include "tools/povslam/scores/scene_report.hpp"

namespace povslam::scores {
namespace {

OrientedBox box_at(double x, double y) {
  return {{x, y, 0.5}, {1.0, 0.6, 1.0}, 0.0};
}

PlaceChange gone(double x, double y) {
  return {Fate::gone, "box", box_at(x, y)};
}
PlaceChange came(double x, double y) {
  return {Fate::came, "box", box_at(x, y)};
}

// One box that moves, one that goes, one that comes, one that stays.
SceneTruth small_scene() {
  SceneTruth truth;
  truth.objects.push_back({1, "box", true, 10, box_at(0.0, 0.0), box_at(5.0, 0.0)});
  truth.objects.push_back({2, "box", true, 10, box_at(0.0, 5.0), std::nullopt});
  truth.objects.push_back({3, "box", true, 10, std::nullopt, box_at(5.0, 5.0)});
  truth.objects.push_back({4, "box", false, 0, box_at(9.0, 9.0), box_at(9.0, 9.0)});
  return truth;
}

std::vector<ReportedEvent> right_report() {
  return {{EventType::moved, "box", box_at(5.1, 0.0), box_at(0.1, 0.0)},
          {EventType::removed, "box", box_at(0.0, 5.2), std::nullopt},
          {EventType::appeared, "box", box_at(5.0, 5.0), std::nullopt}};
}

}  // namespace

TEST(EventScore, AMoveIsOneGoneAndOneCame) {
  const auto json = report_events(small_scene(), nullptr, right_report(), Rigid3{}, {});
  EXPECT_EQ(json.at("truth"), 4);
  EXPECT_EQ(json.at("reported"), 4);
  EXPECT_EQ(json.at("matched"), 4);
  EXPECT_NEAR(json.at("mean_distance_m").get<double>(), (0.1 + 0.1 + 0.2) / 4.0, 1e-12);
}

TEST(EventScore, OldAndNewPlaceSwappedMatchNothing) {
  std::vector<ReportedEvent> events = right_report();
  std::swap(events[0].box, *events[0].from);
  const auto json = report_events(small_scene(), nullptr, events, Rigid3{}, {});
  EXPECT_EQ(json.at("matched"), 2);
  EXPECT_NEAR(json.at("precision").get<double>(), 0.5, 1e-12);
  EXPECT_NEAR(json.at("recall").get<double>(), 0.5, 1e-12);
}

TEST(EventScore, AMissingEventCostsRecallAndADuplicateCostsPrecision) {
  std::vector<ReportedEvent> events = right_report();
  events.pop_back();
  events.push_back(events.back());
  events.back().class_name = "pallet";  // of another class, so that the two are not joined
  const auto json = report_events(small_scene(), nullptr, events, Rigid3{}, {});
  EXPECT_NEAR(json.at("precision").get<double>(), 3.0 / 4.0, 1e-12);
  EXPECT_NEAR(json.at("recall").get<double>(), 3.0 / 4.0, 1e-12);
}

TEST(EventScore, ARunInAnotherWorldIsBroughtOntoTheTruthFirst) {
  const Rigid3 T_truth_estimate{Eigen::Quaterniond(Eigen::AngleAxisd(1.0, Eigen::Vector3d::UnitZ())), {4.0, 5.0, 1.0}};
  std::vector<ReportedEvent> events = right_report();
  for (ReportedEvent& event : events) {
    event.box.center_world = T_truth_estimate.inverse() * event.box.center_world;
    if (event.from) event.from->center_world = T_truth_estimate.inverse() * event.from->center_world;
  }
  EXPECT_EQ(report_events(small_scene(), nullptr, events, T_truth_estimate, {}).at("matched"), 4);
  EXPECT_EQ(report_events(small_scene(), nullptr, events, Rigid3{}, {}).at("matched"), 0);
}

TEST(EventScore, TheHorizontalDistanceDecidesAndIsLimited) {
  const std::vector<PlaceChange> truth{came(0.0, 0.0)};
  std::vector<PlaceChange> report{came(0.3, 0.39)};
  report[0].box.center_world.z() += 3.0;
  EXPECT_EQ(score_events(truth, report, 0.5).matched.size(), 1u);
  report[0].box.center_world.y() = 0.41;
  EXPECT_EQ(score_events(truth, report, 0.5).matched.size(), 0u);
}

TEST(EventScore, MatchingGivesUpANearPairWhereThatSavesAnother) {
  // Only the second report reaches the first truth's neighbour; taking the nearest pair first would leave one alone.
  const std::vector<PlaceChange> truth{came(0.0, 0.0), came(0.6, 0.0)};
  const std::vector<PlaceChange> report{came(0.29, 0.0), came(-0.4, 0.0)};
  EXPECT_EQ(score_events(truth, report, 0.5).matched.size(), 2u);
}

TEST(EventScore, AChangeThatWasHardlySeenIsNeitherAskedForNorHeldAgainstTheReport) {
  const SceneTruth truth = small_scene();
  Sightings sightings;
  sightings.have_instances = true;
  sightings.objects.assign(4, {10, 10, 10, 10});
  sightings.objects[1].old_place_after = 9;
  const auto json = report_events(truth, &sightings, right_report(), Rigid3{}, {});
  EXPECT_EQ(json.at("truth"), 3);
  EXPECT_EQ(json.at("reported"), 3);
  EXPECT_EQ(json.at("excused"), 1);
  EXPECT_EQ(json.at("precision"), 1.0);
  std::vector<ReportedEvent> events = right_report();
  events.erase(events.begin() + 1);
  EXPECT_EQ(report_events(truth, &sightings, events, Rigid3{}, {}).at("recall"), 1.0);
}

TEST(EventScore, WhatNobodyCanKnowIsCountedApart) {
  SceneTruth truth;
  truth.objects = {{1, "box", true, 0, box_at(0.0, 0.0), box_at(2.0, 0.0)},
                   {2, "box", true, 0, box_at(9.0, 0.0), box_at(9.0, 3.0)},
                   {3, "box", true, 0, std::nullopt, box_at(20.0, 0.0)}};
  Sightings sightings;
  sightings.have_instances = true;
  sightings.objects = {{.object_ever = 50, .object_after = 10, .object_before = 10, .old_place_after = 10},
                       {.object_ever = 10, .object_after = 10, .object_before = 9, .old_place_after = 10},
                       {.object_ever = 10, .object_after = 10, .new_place_before = 10}};
  const auto json = report_events(truth, &sightings, {}, Rigid3{}, {});
  EXPECT_EQ(json.at("truth"), 5);
  EXPECT_EQ(json.at("knowable").at("truth"), 3) << "the first's going and coming, the third's coming";
  sightings.objects[1].new_place_before = 10;
  EXPECT_EQ(report_events(truth, &sightings, {}, Rigid3{}, {}).at("knowable").at("truth"), 4);
}

TEST(EventScore, TouchingBoxesOfOneClassAndFateCountAsOne) {
  const std::vector<PlaceChange> joint =
      join_touching({came(0.0, 0.0), came(0.0, 0.61), gone(0.0, 1.22), came(0.0, 9.0)}, 0.02);
  ASSERT_EQ(joint.size(), 3u);
  EXPECT_NEAR(joint[0].box.center_world.y(), 0.305, 1e-12);
  EXPECT_NEAR(joint[0].box.size_m.y(), 1.21, 1e-12);
}

TEST(EventScore, NothingChangedAndNothingReportedHasNoRatio) {
  const auto json = report_events(SceneTruth{}, nullptr, {}, Rigid3{}, {});
  EXPECT_TRUE(json.at("precision").is_null());
  EXPECT_TRUE(json.at("recall").is_null());
}

TEST(ObjectScore, OneLibraryObjectPerTrueBoxAndTheRestIsWrong) {
  const std::vector<ReportedObject> library{
      {"box", box_at(5.1, 0.0)}, {"box", box_at(5.0, 5.0)}, {"box", box_at(0.0, 0.0)}};
  const auto json = report_objects(small_scene(), nullptr, library, Rigid3{}, {});
  EXPECT_EQ(json.at("truth"), 3);  // after the change
  EXPECT_EQ(json.at("matched"), 2);
  EXPECT_NEAR(json.at("precision").get<double>(), 2.0 / 3.0, 1e-12);
  SceneReportOptions before;
  before.arrangement = Arrangement::before;
  EXPECT_EQ(report_objects(small_scene(), nullptr, library, Rigid3{}, before).at("matched"), 1);
}

TEST(ObjectScore, BoxesThatTouchAreOneAndAreCountedByThemselvesAsWell) {
  const std::vector<ReportedObject> library{
      {"box", box_at(5.0, 0.0)}, {"box", box_at(5.0, 0.61)}, {"box", box_at(5.0, 5.0)}};
  const auto json = report_objects(small_scene(), nullptr, library, Rigid3{}, {});
  EXPECT_EQ(json.at("reported"), 2);
  EXPECT_EQ(json.at("matched"), 1);
  EXPECT_EQ(json.at("each_box").at("reported"), 3);
  EXPECT_EQ(json.at("each_box").at("matched"), 2);
}

TEST(ObjectScore, HalfTheUnionIsEnoughAndLessIsNot) {
  const std::vector<ScoredObject> truth{{"box", box_at(0.0, 0.0)}};
  EXPECT_EQ(score_objects(truth, std::vector<ScoredObject>{{"box", box_at(0.33, 0.0)}}, 0.5).matched.size(), 1u);
  EXPECT_EQ(score_objects(truth, std::vector<ScoredObject>{{"box", box_at(0.34, 0.0)}}, 0.5).matched.size(), 0u);
}

}  // namespace povslam::scores
