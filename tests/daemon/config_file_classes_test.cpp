#include "daemon/config_file_classes.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>
#include <set>

#include "daemon/class_presets.hpp"
#include "drivers/synthetic/scene.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

std::string complaint(const std::string& text) {
  const auto table = parse_class_table(text, "c.toml");
  return table ? "accepted" : table.error().message;
}
std::string with(const std::string& row) {
  return "name = \"t\"\nclass = [\n  {id = 0, name = \"none\", kind = \"ignore\"},\n  " + row + ",\n]\n";
}

TEST(ClassFile, EveryBuiltInTableIsReadAndNamedAsItsFile) {
  std::set<std::string> names;
  for (const ClassPreset& preset : class_presets()) {
    const auto table = load_class_table(preset.name);
    ASSERT_TRUE(table) << table.error().message;
    EXPECT_EQ(table->name, preset.name);
    names.insert(table->name);
  }
  EXPECT_THAT(names, testing::IsSupersetOf({"synthetic", "torwic", "coco", "geometric"}));
}

TEST(ClassFile, SyntheticIsTheSimulatorsOwnTable) {
  const auto table = load_class_table("synthetic");
  ASSERT_TRUE(table);
  ASSERT_EQ(table->classes.size(), synthetic::class_table().size());
  LabelTable rows{"synthetic", {}};
  for (const synthetic::ClassRow& row : synthetic::class_table()) {
    rows.classes.push_back({static_cast<std::uint16_t>(row.id), row.name, row.kind, "scene"});
  }
  const auto simulated = class_table_of(rows);
  ASSERT_TRUE(simulated);
  for (std::size_t i = 0; i < rows.classes.size(); ++i) {
    EXPECT_EQ(table->classes[i].id, simulated->classes[i].id);
    EXPECT_EQ(table->classes[i].name, simulated->classes[i].name);
    EXPECT_EQ(table->classes[i].kind, simulated->classes[i].kind);
  }
}

TEST(ClassFile, GeometricIsWhatTheSegmenterSays) {
  const auto table = load_class_table("geometric");
  ASSERT_TRUE(table);
  const ClassTable known = geometric_classes();
  ASSERT_EQ(table->classes.size(), known.classes.size());
  for (const ObjectClass& row : known.classes) {
    EXPECT_EQ(table->find(row.id)->name, row.name);
    EXPECT_EQ(table->find(row.id)->kind, row.kind);
  }
}

TEST(ClassFile, TorwicAndCocoHaveTheirClasses) {
  const auto torwic = load_class_table("torwic");
  ASSERT_TRUE(torwic);
  ASSERT_EQ(torwic->classes.size(), 16u);
  EXPECT_EQ(torwic->find(7)->name, "goods_material");
  EXPECT_EQ(torwic->find(7)->kind, ClassKind::semi_static);
  EXPECT_EQ(torwic->find(13)->kind, ClassKind::dynamic);
  EXPECT_EQ(torwic->find(14)->rgb, (std::array<std::uint8_t, 3>{0, 153, 51}));
  const auto coco = load_class_table("coco");
  ASSERT_TRUE(coco);
  ASSERT_EQ(coco->classes.size(), 81u);
  EXPECT_EQ(coco->find(1)->name, "person");
  EXPECT_EQ(coco->find(1)->kind, ClassKind::dynamic);
  EXPECT_EQ(coco->find(57)->name, "chair");
  EXPECT_EQ(coco->find(57)->kind, ClassKind::semi_static);
  EXPECT_EQ(coco->find(80)->name, "toothbrush");
}

TEST(ClassFile, WhatIsNotSaidFollowsFromTheKind) {
  const auto table = parse_class_table(
      with("{id = 3, name = \"rack\", kind = \"static_object\", k_inlier = 5, max_extent_m = 12.5, rgb = [1, 2, 3]}"),
      "c.toml");
  ASSERT_TRUE(table) << table.error().message;
  const ObjectClass& row = *table->find(3);
  const ObjectClass plain = make_class(3, "rack", ClassKind::static_object);
  EXPECT_EQ(row.k_inlier, 5.0);
  EXPECT_EQ(row.k_outlier, plain.k_outlier);
  EXPECT_EQ(row.prior_alpha, plain.prior_alpha);
  EXPECT_EQ(row.max_extent_m, 12.5);
  EXPECT_EQ(row.rgb, (std::array<std::uint8_t, 3>{1, 2, 3}));
  EXPECT_NE(row.rgb, plain.rgb);
}

TEST(ClassFile, ErrorsNameFileLineAndKey) {
  EXPECT_THAT(complaint(with("{id = 1, name = \"a\", kind = \"movable\"}")),
              AllOf(StartsWith("c.toml:4: kind: expected one of"), HasSubstr("semi_static")));
  EXPECT_THAT(complaint(with("{id = 256, name = \"a\", kind = \"dynamic\"}")),
              StartsWith("c.toml:4: id: expected an integer from 0 to 255"));
  EXPECT_THAT(complaint(with("{id = 1.5, name = \"a\", kind = \"dynamic\"}")), StartsWith("c.toml:4: id"));
  EXPECT_THAT(complaint(with("{id = 1, name = \"\", kind = \"dynamic\"}")), StartsWith("c.toml:4: name"));
  EXPECT_THAT(complaint(with("{id = 1, kind = \"dynamic\"}")), StartsWith("c.toml:4: name: missing"));
  EXPECT_THAT(complaint(with("{id = 1, name = \"a\", kind = \"dynamic\", max_extent = 3}")),
              AllOf(StartsWith("c.toml:4: max_extent: unknown key"), HasSubstr("max_extent_m")));
  EXPECT_THAT(complaint(with("{id = 1, name = \"a\", kind = \"dynamic\", min_extent_m = 4}")),
              StartsWith("c.toml:4: min_extent_m: must not exceed"));
  EXPECT_THAT(complaint(with("{id = 1, name = \"a\", kind = \"dynamic\", rgb = [1, 2, 300]}")),
              StartsWith("c.toml:4: rgb"));
  EXPECT_THAT(complaint(with("{id = 0, name = \"a\", kind = \"dynamic\"}")),
              AllOf(StartsWith("c.toml:4: id: 0 is taken"), HasSubstr("c.toml:3")));
  EXPECT_THAT(complaint(with("{id = 1, name = \"none\", kind = \"dynamic\"}")), StartsWith("c.toml:4: name: \"none\""));
  EXPECT_THAT(complaint("name = \"t\"\nclass = [{id = 0, name = \"a\", kind = \"structure\"}]"),
              AllOf(StartsWith("c.toml:2: kind: id 0"), HasSubstr("ignore")));
  EXPECT_THAT(complaint("class = [{id = 0, name = \"a\", kind = \"ignore\"}]"), StartsWith("c.toml: name: expected"));
  EXPECT_THAT(complaint("name = \"t\"\nclass = []"), StartsWith("c.toml: class: expected"));
  EXPECT_THAT(complaint("name = \"t\"\nclass = [3]"), StartsWith("c.toml:2: class: expected"));
  EXPECT_THAT(complaint("name = \"t\"\nclasses = []"), StartsWith("c.toml:2: classes: unknown key"));
  EXPECT_THAT(complaint("name = \"t\"\nname = \"u\""), StartsWith("c.toml:2: "));
}

TEST(ClassFile, SurvivesAnyDamage) {
  const std::string whole = class_presets().front().toml;
  rc::check([&whole] {
    std::string text = whole;
    for (int i = *rc::gen::inRange(1, 5); i > 0; --i) {
      text.replace(*rc::gen::inRange<std::size_t>(0, text.size()), *rc::gen::inRange<std::size_t>(0, 20),
                   *rc::gen::arbitrary<std::string>());
    }
    const std::string message = complaint(text);
    RC_ASSERT(message == "accepted" || message.starts_with("c.toml"));
  });
}

TEST(ClassFile, ChoiceFollowsTheConfigurationThenTheSensor) {
  const std::optional<LabelTable> torwic = LabelTable{"torwic", {}};
  const std::optional<LabelTable> own = LabelTable{"/r/classes.csv", {{4, "crate", "semi_static", "/r/classes.csv:2"}}};
  EXPECT_EQ(choose_class_table({}, torwic)->name, "torwic");
  EXPECT_EQ(choose_class_table({}, own)->find(4)->name, "crate");
  EXPECT_EQ(choose_class_table({"", "", "coco"}, torwic)->name, "coco");
  EXPECT_EQ(choose_class_table({}, std::nullopt)->name, "geometric");
  const auto unnamed = choose_class_table({"/run/povslam/labels.sock", "", "auto"}, std::nullopt);
  ASSERT_FALSE(unnamed);
  EXPECT_THAT(unnamed.error().message, AllOf(StartsWith("labels.classes: "), HasSubstr("coco")));
  const auto nowhere = choose_class_table({"", "", "/nowhere/c.toml"}, std::nullopt);
  ASSERT_FALSE(nowhere);
  EXPECT_THAT(nowhere.error().message, AllOf(StartsWith("labels.classes: /nowhere/c.toml"), HasSubstr("torwic")));
  const auto folder = choose_class_table({"", "", temp_folder().string()}, std::nullopt);
  EXPECT_FALSE(folder);
  const std::optional<LabelTable> twice = LabelTable{"x", {{4, "a", "dynamic", "x:2"}, {4, "b", "dynamic", "x:3"}}};
  EXPECT_THAT(choose_class_table({}, twice).error().message, AllOf(StartsWith("x:3: id"), HasSubstr("x:2")));
}

}  // namespace
}  // namespace povslam
