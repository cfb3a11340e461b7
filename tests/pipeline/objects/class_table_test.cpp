#include "pipeline/objects/class_table.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

TEST(ClassTable, GivesStationaryThingsTheirWeightWhenTheGeometryAgreesAndOthersWhenItDoesNot) {
  for (const ClassKind kind : {ClassKind::static_object, ClassKind::structure}) {
    const ObjectClass row = make_class(4, "rack", kind);
    EXPECT_EQ(row.k_inlier, 3.0);
    EXPECT_EQ(row.k_outlier, 0.0);
  }
  const ObjectClass box = make_class(5, "box", ClassKind::semi_static);
  EXPECT_EQ(box.k_inlier, 0.0);
  EXPECT_EQ(box.k_outlier, 3.0);
  EXPECT_NEAR(box.prior_alpha / (box.prior_alpha + box.prior_beta), 0.67, 0.01);  // POCD's initial expectation
}

TEST(ClassTable, ColoursNeighbouringIdsDifferently) {
  EXPECT_EQ(make_class(0, "unlabelled", ClassKind::ignore).rgb, (std::array<std::uint8_t, 3>{0, 0, 0}));
  for (std::uint16_t id = 1; id < 255; ++id) {
    const auto a = make_class(id, "a", ClassKind::semi_static).rgb;
    const auto b = make_class(static_cast<std::uint16_t>(id + 1), "b", ClassKind::semi_static).rgb;
    int difference = 0;
    for (std::size_t i = 0; i < 3; ++i) difference += std::abs(a[i] - b[i]);
    EXPECT_GT(difference, 100) << id;
  }
}

TEST(ClassTable, OfGeometricSegmentationKnowsStructureAndObjects) {
  const ClassTable table = geometric_classes();
  EXPECT_EQ(table.find(kGeometricStructure)->kind, ClassKind::structure);
  EXPECT_EQ(table.find(kGeometricObject)->kind, ClassKind::semi_static);
  EXPECT_EQ(table.find(3), nullptr);
}

TEST(ClassTable, ThingsMadeOfPartsAreKnownByTheEndOfAWord) {
  for (const char* name : {"pallet", "wooden_pallets", "handcart", "cart", "park benches", "pallet truck"}) {
    EXPECT_TRUE(make_class(1, name, ClassKind::semi_static).one_piece) << name;
  }
  for (const char* name : {"carton", "cartons", "box", "tablet", "goods"}) {
    EXPECT_FALSE(make_class(1, name, ClassKind::semi_static).one_piece) << name;
  }
}

}  // namespace
}  // namespace povslam
