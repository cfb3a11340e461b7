#include "pipeline/objects/segment_namer.hpp"

#include <gtest/gtest.h>

namespace povslam {
namespace {

constexpr std::uint16_t kPerson = 1, kCup = 42;  // of COCO: index + 1

ClassTable some_of_coco() {
  return {"some", {make_class(kPerson, "person", ClassKind::dynamic), make_class(kCup, "cup", ClassKind::semi_static)}};
}

// Two segments side by side; the view has a picture of that size.
class SegmentNamerTest : public testing::Test {
 protected:
  SegmentNamerTest() {
    view_.color = ImageU8(40, 20, 3);
    instances_ = ImageU16(40, 20);
    for (int y = 0; y < 20; ++y) {
      for (int x = 0; x < 40; ++x) instances_.at(x, y) = static_cast<std::uint16_t>(kFirstInstance + (x < 20 ? 0 : 1));
    }
  }
  SegmentNamer namer(int every_nth_view) {
    NamingOptions options;
    options.every_nth_view = every_nth_view;
    return {[this](const ImageU8&) { return answer_; }, some_of_coco(), options};
  }

  DepthView view_;
  ImageU16 instances_;
  Result<std::vector<DetectedBox>> answer_ = std::vector<DetectedBox>{{kCup - 1, 0.9F, 0, 0, 20, 20}};
};

TEST_F(SegmentNamerTest, NamesWhatABoxHoldsAndSaysThatTheRestIsAThing) {
  SegmentNamer namer = this->namer(1);
  const auto& names = namer.name(view_, instances_, 2);
  ASSERT_EQ(names.size(), 2U);
  EXPECT_EQ(names[0].id, kCup);
  EXPECT_EQ(names[0].votes, kVotesOfName);
  EXPECT_EQ(names[1].id, kUnnamedThing);
  EXPECT_EQ(names[1].votes, 1);
  EXPECT_EQ(namer.counts().named, 1);
}

TEST_F(SegmentNamerTest, AsksOneViewInSoManyAndTheOthersVoteForNothing) {
  SegmentNamer namer = this->namer(3);
  for (int i = 0; i < 7; ++i) {
    const auto& names = namer.name(view_, instances_, 2);
    ASSERT_EQ(names.size(), 2U);
    EXPECT_EQ(names[0].votes, i % 3 == 0 ? kVotesOfName : 0);
    EXPECT_EQ(names[1].votes, i % 3 == 0 ? 1 : 0);
  }
  EXPECT_EQ(namer.counts().asked, 3);
}

TEST_F(SegmentNamerTest, KnowsNoClassThatItsTableDoesNotHave) {
  answer_ = std::vector<DetectedBox>{{7, 0.9F, 0, 0, 20, 20}};
  SegmentNamer namer = this->namer(1);
  EXPECT_EQ(namer.name(view_, instances_, 2)[0].id, kUnnamedThing);
}

TEST_F(SegmentNamerTest, CountsANetworkThatFailsAndGoesOnWithoutNames) {
  answer_ = Error{"no memory"};
  SegmentNamer namer = this->namer(1);
  EXPECT_EQ(namer.name(view_, instances_, 2)[0].votes, 0) << "an error says nothing of what is there";
  EXPECT_EQ(namer.counts().failed, 1);
  EXPECT_EQ(namer.last_error(), "no memory");
}

TEST_F(SegmentNamerTest, AsksNothingWithoutAPictureOrWithoutSegments) {
  SegmentNamer namer = this->namer(1);
  EXPECT_TRUE(namer.name(view_, instances_, 0).empty());
  view_.color = ImageU8();
  EXPECT_EQ(namer.name(view_, instances_, 2).size(), 2U);
  EXPECT_EQ(namer.counts().asked, 0);
}

}  // namespace
}  // namespace povslam
