#include "drivers/synthetic/synthetic_driver.hpp"

#include <gtest/gtest.h>

#include <chrono>
#include <thread>

namespace povslam {

namespace {

DriverOptions small(DriverOptions more) {
  more.insert({{"scene", "static"}, {"width", "64"}, {"height", "48"}});
  return more;
}

std::string error_of(const DriverOptions& options) {
  const auto driver = make_synthetic_driver(options);
  return driver ? "" : driver.error().message;
}

}  // namespace

TEST(SyntheticDriver, NamesTheKeyItCannotUse) {
  EXPECT_NE(error_of({{"colour", "red"}}).find("'colour'"), std::string::npos);
  EXPECT_NE(error_of({{"fps", "fast"}}).find("'fps'"), std::string::npos);
  EXPECT_NE(error_of({{"speed_mps", "nan"}}).find("'speed_mps'"), std::string::npos);
  EXPECT_NE(error_of({{"width", "-5"}}).find("'width'"), std::string::npos);
  EXPECT_NE(error_of({{"scene", "moon"}}).find("boxsim"), std::string::npos);
  EXPECT_NE(error_of({{"blur", "yes"}}).find("'blur'"), std::string::npos);
  EXPECT_NE(error_of({{"changes", "no"}}).find("'changes'"), std::string::npos);
  EXPECT_EQ(error_of({{"scene", "twins"}, {"changes", "false"}}), "");
  EXPECT_EQ(error_of({{"scene", "aisle"}, {"seed", "7"}, {"blur", "true"}}), "");
}

TEST(SyntheticDriver, KeepsTheAngleOfViewWhenTheImageShrinks) {
  auto driver = make_synthetic_driver(small({{"realtime", "false"}}));
  ASSERT_TRUE(driver);
  const auto setup = (*driver)->open();
  ASSERT_TRUE(setup);
  EXPECT_DOUBLE_EQ(setup->sensors[0].camera.fx, 52.5);
  EXPECT_DOUBLE_EQ(setup->sensors[0].camera.cx, 31.5);
  EXPECT_FALSE(setup->paced);
  ASSERT_TRUE(setup->T_world_camera_start);
  EXPECT_NEAR(setup->T_world_camera_start->translation.z(), 0.8, 0.01);
}

TEST(SyntheticDriver, DeliversEveryFrameInOrderAndEnds) {
  auto driver = make_synthetic_driver(
      small({{"realtime", "false"}, {"frames", "12"}, {"labels", "true"}, {"lidar", "true"}, {"start_time_s", "100"}}));
  ASSERT_TRUE(driver);
  const auto setup = (*driver)->open();
  ASSERT_TRUE(setup);
  ASSERT_EQ(setup->sensors.size(), 3U);
  EXPECT_EQ(setup->num_frames, 12U);
  ASSERT_TRUE(setup->label_table);
  EXPECT_EQ(setup->label_table->name, "synthetic");
  SensorFrame frame;
  std::vector<TimeNs> last(3, 0);
  std::vector<int> count(3, 0);
  while ((*driver)->next(frame).kind == Next::Kind::frame) {
    const auto sensor = static_cast<std::size_t>(frame.sensor);
    EXPECT_EQ(setup->sensors[sensor].kind, frame.kind);
    EXPECT_GT(frame.stamp(), last[sensor]);
    last[sensor] = frame.stamp();
    ++count[sensor];
    if (frame.kind == SensorKind::rgbd) {
      EXPECT_EQ(frame.rgbd.seq + 1, static_cast<std::uint64_t>(count[0]));
    }
  }
  EXPECT_EQ(count, (std::vector<int>{12, 12, 3}));
  EXPECT_EQ(last[0], 100 * kNsPerSecond + 366'667 * kNsPerUs);
  EXPECT_EQ((*driver)->next(frame).kind, Next::Kind::end);
}

TEST(SyntheticDriver, GivesTheSameBytesAgainAfterReopening) {
  auto driver = make_synthetic_driver(small({{"realtime", "false"}}));
  ASSERT_TRUE(driver);
  SensorFrame first, second;
  EXPECT_EQ((*driver)->next(first).kind, Next::Kind::failed);
  ASSERT_TRUE((*driver)->open());
  ASSERT_EQ((*driver)->next(first).kind, Next::Kind::frame);
  (*driver)->close();
  ASSERT_TRUE((*driver)->open());
  ASSERT_EQ((*driver)->next(second).kind, Next::Kind::frame);
  EXPECT_TRUE(std::ranges::equal(first.rgbd.color.pixels(), second.rgbd.color.pixels()));
  EXPECT_TRUE(std::ranges::equal(first.rgbd.depth.pixels(), second.rgbd.depth.pixels()));
}

TEST(SyntheticDriver, SkipsToThePresentForALateConsumer) {
  auto driver = make_synthetic_driver(small({{"fps", "100"}}));
  ASSERT_TRUE(driver);
  const auto setup = (*driver)->open();
  ASSERT_TRUE(setup);
  EXPECT_TRUE(setup->paced);
  SensorFrame frame;
  ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
  EXPECT_EQ(frame.rgbd.seq, 0U);
  const TimeNs started = monotonic_now();
  std::this_thread::sleep_for(std::chrono::milliseconds(100));
  ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
  EXPECT_GE(frame.rgbd.seq, 9U);
  ASSERT_EQ((*driver)->next(frame).kind, Next::Kind::frame);
  EXPECT_GE(to_ms(monotonic_now() - started) + 60.0, 10.0 * static_cast<double>(frame.rgbd.seq))
      << "delivered ahead of its time";
}

}  // namespace povslam
