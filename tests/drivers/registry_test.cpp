#include "drivers/registry.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace povslam {

using testing::AllOf;
using testing::HasSubstr;

TEST(Registry, KnowsItsDriversByName) {
  EXPECT_THAT(driver_names(), testing::IsSupersetOf({"replay", "synthetic"}));
  EXPECT_TRUE(make_driver("replay", {{"path", "/nonexistent"}})) << "making a driver opens nothing";
}

TEST(Registry, ListsWhatThereIsForAnUnknownName) {
  const auto driver = make_driver("kinect9", {});
  ASSERT_FALSE(driver);
  EXPECT_THAT(driver.error().message,
              AllOf(HasSubstr("'kinect9' is unknown"), HasSubstr("replay"), HasSubstr("synthetic")));
}

TEST(Registry, PassesOnWhatADriverSaysOfItsOptions) {
  EXPECT_THAT(make_driver("replay", {{"pth", "x"}}).error().message, HasSubstr("unknown key 'pth'"));
}

}  // namespace povslam
