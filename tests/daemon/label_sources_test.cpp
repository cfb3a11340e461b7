#include "daemon/label_sources.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/daemon/label_thread_fixture.hpp"

namespace povslam {
namespace {

PinholeCamera small_camera() {
  PinholeCamera camera;
  camera.width = kWidth;
  camera.height = kHeight;
  return camera;
}

TEST(LabelSources, AreNoneWhenTheConfigurationAsksForNone) {
  const auto sources = LabelSources::start({}, {}, "coco", small_camera());
  ASSERT_TRUE(sources);
  EXPECT_FALSE((*sources)->any());
  (*sources)->offer(image_at(1));
  EXPECT_FALSE((*sources)->try_pop());
  EXPECT_TRUE((*sources)->health().empty());
  EXPECT_EQ((*sources)->socket().offered, 0);
}

TEST(LabelSources, ListenWhereTheConfigurationSays) {
  const TempFolder folder;
  const std::string path = (folder.path() / "labels.sock").string();
  const auto sources = LabelSources::start({path, "", "coco"}, {}, "coco", small_camera());
  ASSERT_TRUE(sources) << sources.error().message;
  EXPECT_TRUE((*sources)->any());
  LabelPeer peer(path);
  peer.say(LabelPeer::hello("coco"));
  peer.say(LabelPeer::next());
  ASSERT_TRUE(peer.hear());
  (*sources)->offer(image_at(9));
  ASSERT_TRUE(peer.hear());
  peer.say(LabelPeer::labels(9, kWidth, kHeight, 1, kPixels));
  std::optional<LabelFrame> labels;
  ASSERT_TRUE(soon([&] { return (labels = (*sources)->try_pop()).has_value(); }));
  EXPECT_EQ(labels->stamp, 9);
  EXPECT_EQ((*sources)->socket().labels, 1);
  const std::vector<LabelSourceHealth> health = (*sources)->health();
  ASSERT_EQ(health.size(), 1U);
  EXPECT_EQ(health[0].name, "socket");
  EXPECT_TRUE(health[0].connected);
  EXPECT_EQ(health[0].offered, 1);
  EXPECT_EQ(health[0].labels, 1);
}

TEST(LabelSources, SayWhichKeyIsWrong) {
  LcmConfig no_lcm;
  no_lcm.url = "";
  EXPECT_THAT(LabelSources::start({"", "LABELS", "coco"}, no_lcm, "coco", small_camera()).error().message,
              testing::StartsWith("labels.lcm_channel: "));
  EXPECT_THAT(LabelSources::start({"/nowhere/l.sock", "", "coco"}, no_lcm, "coco", small_camera()).error().message,
              testing::StartsWith("labels.socket: /nowhere/l.sock: "));
}

}  // namespace
}  // namespace povslam
