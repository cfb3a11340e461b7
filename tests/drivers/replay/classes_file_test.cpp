#include "drivers/replay/classes_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>

#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

Result<LabelTable> read(const std::string& text) {
  const auto path = temp_folder() / "classes.csv";
  std::ofstream(path, std::ios::binary) << text;
  return read_classes_file(path);
}
std::string complaint(const std::string& text) {
  const auto table = read(text);
  return table ? "accepted" : table.error().message;
}

TEST(ClassesFile, ReadsIdsNamesAndKinds) {
  const auto table = read("\xEF\xBB\xBFid,name,kind\r\n0,unlabelled,ignore\r\n# people\r\n9, person ,dynamic\r\n\r\n");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_THAT(table->name, HasSubstr("classes.csv"));
  ASSERT_EQ(table->classes.size(), 2u);
  EXPECT_EQ(table->classes[1].id, 9);
  EXPECT_EQ(table->classes[1].name, "person");
  EXPECT_EQ(table->classes[1].kind, "dynamic");
  EXPECT_THAT(table->classes[1].where, HasSubstr("classes.csv:4"));
}

TEST(ClassesFile, ReadsTheOlderMovableColumn) {
  const auto table = read("id,movable,name\n1,0,wall\n2,1,box");
  ASSERT_TRUE(table) << table.error().message;
  EXPECT_EQ(table->classes[0].kind, "structure");
  EXPECT_EQ(table->classes[1].kind, "semi_static");
  EXPECT_EQ(table->classes[1].name, "box");
  EXPECT_THAT(complaint("id,name,movable\n1,wall,2\n"), HasSubstr("classes.csv:2: movable: expected 0 or 1"));
}

TEST(ClassesFile, NamesTheLineAndWhatIsAllowed) {
  EXPECT_THAT(complaint(""), HasSubstr("no class"));
  EXPECT_THAT(complaint("id,name,kind\n"), HasSubstr("no class"));
  EXPECT_THAT(complaint("1,wall,structure\n"), HasSubstr("classes.csv:1: expected the header line"));
  EXPECT_THAT(complaint("id,name,kind\n1,wall\n"), HasSubstr("classes.csv:2: fewer columns"));
  EXPECT_THAT(complaint("id,name,kind\n1,wall,wall\n"),
              AllOf(HasSubstr("classes.csv:2: kind"), HasSubstr("semi_static")));
  EXPECT_THAT(complaint("id,name,kind\n1,,structure\n"), HasSubstr("classes.csv:2: name"));
  for (const char* id : {"256", "-1", "1x", "", "1.0", "99999999999999999999"}) {
    EXPECT_THAT(complaint("id,name,kind\n" + std::string(id) + ",wall,structure\n"), HasSubstr("classes.csv:2: id"))
        << id;
  }
  EXPECT_THAT(read_classes_file("/nowhere/classes.csv").error().message, HasSubstr("no such file"));
}

TEST(ClassesFile, SurvivesAnyText) {
  rc::check([](const std::string& text) {
    const std::string message = complaint(text);
    RC_ASSERT(message == "accepted" || message.find("classes.csv") != std::string::npos);
  });
}

}  // namespace
}  // namespace povslam
