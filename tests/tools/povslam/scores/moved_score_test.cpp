#include "tools/povslam/scores/moved_score.hpp"

#include <gtest/gtest.h>

#include <numbers>

#include "tools/povslam/scores/scene_report.hpp"

namespace povslam::scores {
namespace {

OrientedBox box_at(double x, double y, double yaw_rad = 0.0) {
  return {{x, y, 0.5}, {1.0, 0.6, 1.0}, yaw_rad};
}

// Two boxes that move, one that stays.
SceneTruth scene() {
  SceneTruth truth;
  truth.objects.push_back({1, "box", true, 10, box_at(0.0, 0.0), box_at(5.0, 0.0)});
  truth.objects.push_back({2, "box", true, 10, box_at(0.0, 5.0), box_at(5.0, 5.0)});
  truth.objects.push_back({3, "box", false, 0, box_at(9.0, 9.0), box_at(9.0, 9.0)});
  return truth;
}

ReportedEvent moved(const OrientedBox& from, const OrientedBox& to, int object = -1) {
  return {EventType::moved, "box", to, from, object};
}

}  // namespace

TEST(MovedScore, ABoxIsMeasuredFromCentreToCentreWhateverItsHeight) {
  OrientedBox low = box_at(5.03, 0.04, 0.1);
  low.center_world.z() = -2.0;
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.1), low)};
  const auto boxes = score_moved(scene(), events, {}, 0.5);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_EQ(boxes[0].truth, 1);
  EXPECT_NEAR(boxes[0].distance_m, 0.05, 1e-12);
  EXPECT_NEAR(boxes[0].yaw_rad, 0.1, 1e-12);
  EXPECT_TRUE(boxes[0].same_thing);
  EXPECT_FALSE(boxes[0].end_distance_m);
}

TEST(MovedScore, TwoThatSwappedTheirOldPlacesAreNotTheSameThings) {
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 5.0), box_at(5.0, 0.0)),
                                          moved(box_at(0.0, 0.0), box_at(5.0, 5.0))};
  const auto boxes = score_moved(scene(), events, {}, 0.5);
  ASSERT_EQ(boxes.size(), 2u);
  EXPECT_FALSE(boxes[0].same_thing);
  EXPECT_FALSE(boxes[1].same_thing);
}

TEST(MovedScore, WhatStayedOrWentIsNoPlaceToMoveTo) {
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.0), box_at(9.0, 9.0)),
                                          {EventType::removed, "box", box_at(5.0, 0.0), std::nullopt}};
  EXPECT_TRUE(score_moved(scene(), events, {}, 0.5).empty());
}

TEST(MovedScore, TheSidesAreTurnedHoweverTheirEdgesAreNamed) {
  OrientedBox exchanged = box_at(5.0, 0.0, std::numbers::pi / 2.0 - 0.2);
  std::swap(exchanged.size_m.x(), exchanged.size_m.y());
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.0), exchanged)};
  const auto boxes = score_moved(scene(), events, {}, 0.5);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].yaw_rad, 0.2, 1e-12);
  EXPECT_NEAR(boxes[0].edge_error_m, 0.0, 1e-12);
}

TEST(MovedScore, AnEdgeThatWasNotSeenToItsEndIsSaid) {
  OrientedBox partial = box_at(4.8, 0.0), whole = box_at(5.0, 0.0);
  partial.size_m.x() = 0.6;
  whole.size_m.y() = 0.65;
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.0), partial, 7)};
  const std::vector<ReportedObject> now{{"box", whole, 7}};
  const auto boxes = score_moved(scene(), events, now, 0.5);
  ASSERT_EQ(boxes.size(), 1u);
  EXPECT_NEAR(boxes[0].edge_error_m, 0.4, 1e-12);
  ASSERT_TRUE(boxes[0].end_edge_error_m);
  EXPECT_NEAR(*boxes[0].end_edge_error_m, 0.05, 1e-12);
}

TEST(MovedScore, WhatWasToldBadlyAndMendedLaterIsCloseAtTheEnd) {
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.0), box_at(5.3, 0.0), 7),
                                          moved(box_at(0.0, 5.0), box_at(5.0, 5.06), 8)};
  const auto json = report_moved(scene(), nullptr, events, {{"box", box_at(5.02, 0.0), 7}}, Rigid3{}, {});
  EXPECT_EQ(json.at("reported"), 2);
  EXPECT_EQ(json.at("told").at("close"), 1);
  EXPECT_NEAR(json.at("told").at("median_m").get<double>(), 0.18, 1e-12);
  EXPECT_NEAR(json.at("told").at("max_m").get<double>(), 0.3, 1e-12);
  EXPECT_EQ(json.at("end").at("count"), 1);
  EXPECT_EQ(json.at("end").at("close"), 1);
  EXPECT_NEAR(json.at("end").at("max_m").get<double>(), 0.02, 1e-12);
}

TEST(MovedScore, ThoseWhoseSidesWereSeenAreCountedByThemselves) {
  const std::vector<ReportedEvent> events{moved(box_at(0.0, 0.0), box_at(5.3, 0.0), 7),
                                          moved(box_at(0.0, 5.0), box_at(5.0, 5.06), 8)};
  Sightings sightings;
  sightings.have_instances = true;
  sightings.objects.resize(3);
  sightings.objects[0].sides_before = sightings.objects[1].sides_after = true;
  const auto json = report_moved(scene(), &sightings, events, {}, Rigid3{}, {});
  EXPECT_EQ(json.at("told").at("count"), 2);
  EXPECT_EQ(json.at("told_sides_seen").at("count"), 1);
  EXPECT_EQ(json.at("told_sides_seen").at("close"), 1);
  EXPECT_EQ(json.at("boxes").at(0).at("sides_seen"), false);
  EXPECT_EQ(json.at("boxes").at(0).at("sides_seen_before"), true);
}

TEST(MovedScore, ARunInAnotherWorldIsBroughtOntoTheTruthFirst) {
  Rigid3 T_truth_estimate;
  T_truth_estimate.translation = {5.0, 0.0, 0.0};
  const std::vector<ReportedEvent> events{moved(box_at(-5.0, 0.0), box_at(0.04, 0.0), 7)};
  const auto json = report_moved(scene(), nullptr, events, {{"box", box_at(0.01, 0.0), 7}}, T_truth_estimate, {});
  EXPECT_NEAR(json.at("told").at("max_m").get<double>(), 0.04, 1e-12);
  EXPECT_NEAR(json.at("end").at("max_m").get<double>(), 0.01, 1e-12);
  EXPECT_EQ(json.at("boxes").at(0).at("same_thing"), true);
}

}  // namespace povslam::scores
