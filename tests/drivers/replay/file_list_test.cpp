#include "drivers/replay/file_list.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>
#include <set>

#include "tests/support/temp_folder.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;
using testing::ElementsAre;
using testing::HasSubstr;

fs::path write_list(const std::string& text) {
  const fs::path path = temp_folder() / "povslam_list_test.txt";
  std::ofstream(path, std::ios::binary) << text;
  return path;
}

std::vector<ListedFile> stamps(const std::vector<TimeNs>& times) {
  std::vector<ListedFile> files;
  for (const TimeNs time : times) files.push_back({time, "", 0, ""});
  return files;
}

}  // namespace

TEST(FileList, IsReadWhateverTheLineEndsAndBlanks) {
  const auto list = read_file_list(write_list("# images\r\n1.000001   rgb/a.png  \r\n\r\n\t2 rgb/b.png"));
  ASSERT_TRUE(list);
  ASSERT_EQ(list->files.size(), 2U);
  EXPECT_EQ(list->files[0].stamp, 1000001000);
  EXPECT_EQ(list->files[0].file, "rgb/a.png");
  EXPECT_THAT(list->files[1].where, HasSubstr("povslam_list_test.txt:4"));
  EXPECT_TRUE(list->faults.empty());
}

TEST(FileList, TellsEachUnusableLineOnceAndKeepsTheRest) {
  const auto list = read_file_list(write_list("1 a.png\nnan b.png\n2\n3 c d\n4 e.png\n1 f.png\n"));
  ASSERT_TRUE(list);
  ASSERT_EQ(list->files.size(), 2U);
  EXPECT_EQ(list->files[0].file, "a.png");
  EXPECT_EQ(list->files[1].file, "e.png");
  EXPECT_EQ(list->files[1].seq, 4U) << "lines left out are gaps";
  EXPECT_THAT(list->faults,
              ElementsAre(HasSubstr("txt:2: not 'stamp file'"), HasSubstr("txt:3:"), HasSubstr("txt:4:"),
                          testing::AllOf(HasSubstr("txt:6: has the stamp of"), HasSubstr("txt:1; left out"))));
}

TEST(FileList, IsPutInTheOrderOfItsStamps) {
  const auto list = read_file_list(write_list("3 c\n1 a\n2 b\n"));
  ASSERT_TRUE(list);
  EXPECT_EQ(list->files[0].file + list->files[1].file + list->files[2].file, "abc");
  EXPECT_TRUE(list->faults.empty());
}

TEST(Associations, GiveBothImages) {
  const auto list = read_associations(write_list("1.5 rgb/a 1.51 depth/a\n1.6 rgb/b 1.61\n1.7 rgb/c x depth/c\n"));
  ASSERT_TRUE(list);
  ASSERT_EQ(list->pairs.size(), 1U);
  EXPECT_EQ(list->pairs[0].depth.stamp, 1510000000);
  EXPECT_EQ(list->pairs[0].depth.file, "depth/a");
  EXPECT_EQ(list->faults.size(), 2U);
}

TEST(Associate, TakesTheClosestPairsFirst) {
  const auto pairs = associate(stamps({0, 30, 60}), stamps({8, 31, 100}), 20);
  EXPECT_THAT(pairs, ElementsAre(std::pair(0U, 0U), std::pair(1U, 1U)));
  EXPECT_THAT(associate(stamps({0, 10}), stamps({9}), 20), ElementsAre(std::pair(1U, 0U)))
      << "0 is within reach of 9, but 10 is closer";
  EXPECT_TRUE(associate({}, stamps({1}), 20).empty());
}

TEST(Associate, IsOneToOneAndKeepsToItsTolerance) {
  rc::check([](const std::set<std::uint16_t>& a, const std::set<std::uint16_t>& b, std::uint8_t tolerance) {
    const auto files_a = stamps({a.begin(), a.end()}), files_b = stamps({b.begin(), b.end()});
    std::set<std::size_t> seen;
    std::size_t last = 0;
    for (const auto& [i, j] : associate(files_a, files_b, tolerance)) {
      RC_ASSERT(std::abs(files_a[i].stamp - files_b[j].stamp) <= tolerance);
      RC_ASSERT(seen.insert(j).second);
      RC_ASSERT(seen.size() == 1 || i > last);
      last = i;
    }
  });
}

}  // namespace povslam
