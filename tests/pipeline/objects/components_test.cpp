#include "pipeline/objects/components.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

struct Picture {
  explicit Picture(const std::vector<std::string>& rows)
      : value(static_cast<int>(rows[0].size()), static_cast<int>(rows.size())), depth(value.width(), value.height()) {
    depth.fill(2.0F);
    for (int y = 0; y < value.height(); ++y) {
      for (int x = 0; x < value.width(); ++x) {
        const char c = rows[static_cast<std::size_t>(y)][static_cast<std::size_t>(x)];
        value.at(x, y) = c == '.' ? std::uint16_t{0} : static_cast<std::uint16_t>(c);
      }
    }
  }
  const std::vector<Component>& find() { return finder.find(value, depth, 0.05, 0.02); }
  ImageU16 value;
  ImageF depth;
  ComponentFinder finder;
};

TEST(Components, AreConnectedPartsOfOneValue) {
  Picture picture({"aa.b.", "a..b.", "..abb", "aaa.."});
  const std::vector<Component>& parts = picture.find();
  ASSERT_EQ(parts.size(), 3U);
  EXPECT_EQ(parts[0].cells, 3);
  EXPECT_EQ(parts[1].value, 'b');
  EXPECT_EQ(parts[1].cells, 4);
  EXPECT_EQ(parts[1].x_max, 4);
  EXPECT_EQ(parts[2].cells, 4);
  EXPECT_EQ(parts[2].x_min, 0);
  EXPECT_EQ(picture.finder.component_at(0, 3), 2);
  EXPECT_EQ(picture.finder.component_at(2, 0), -1);
}

TEST(Components, JoinWhatMeetsOnlyFurtherDown) {
  Picture picture({"a.a.a", "a.a.a", "aaaaa"});
  ASSERT_EQ(picture.find().size(), 1U);
  EXPECT_EQ(picture.finder.component_at(4, 0), 0);
}

TEST(Components, EndWhereDepthJumps) {
  Picture picture({"aaaa"});
  picture.depth.at(2, 0) = picture.depth.at(3, 0) = 2.2F;
  EXPECT_EQ(picture.find().size(), 2U);
  picture.depth.at(2, 0) = 2.08F;
  picture.depth.at(3, 0) = 2.16F;
  EXPECT_EQ(picture.find().size(), 1U);
}

TEST(Components, OfNothingAreNone) {
  Picture picture({"...", "..."});
  EXPECT_TRUE(picture.find().empty());
}

}  // namespace
}  // namespace povslam
