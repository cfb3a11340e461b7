#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "daemon/store.hpp"
#include "tests/support/log_text.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/same_map.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

class Quarantine : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "map.db"; }
  void write(const std::string& bytes) const { std::ofstream(file(), std::ios::binary) << bytes; }
  std::vector<std::string> set_aside() const {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      const std::string name = entry.path().filename().string();
      if (name.find(".damaged-") != std::string::npos) names.push_back(name);
    }
    return names;
  }
  // A store of ten commits, closed.
  std::string make_store() {
    auto store = MapStore::open(file(), StoreMode::read_write);
    EXPECT_TRUE(store);
    for (int i = 0; i < 10; ++i) EXPECT_TRUE(store->commit(maker_.next()));
    store = Error{"closed"};
    return content(file());
  }
  TempFolder folder_;
  LogText log_;
  made::MapMaker maker_{made::small_pace(1)};
};

TEST_F(Quarantine, DoesNotTouchASoundStore) {
  make_store();
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_TRUE(opened->quarantined.empty());
  EXPECT_TRUE(same_map(opened->content, maker_.truth().content()));
  EXPECT_EQ(log_.text(), "");
}

TEST_F(Quarantine, KeepsWhateverIsNoStoreAndBeginsAnEmptyOne) {
  const std::string whole = make_store();
  const std::vector<std::string> damaged = {"",
                                            "hello",
                                            whole.substr(0, 50),
                                            whole.substr(0, whole.size() / 2),
                                            whole.substr(0, whole.size() - 4096),
                                            std::string(whole.size(), '\0'),
                                            std::string(4096, '\0') + whole.substr(4096),
                                            whole.substr(0, whole.size() - 4096) + std::string(4096, '\0'),
                                            std::string(1 << 20, 'x')};
  for (const std::string& bytes : damaged) {
    for (const std::string& name : set_aside()) std::filesystem::remove(folder_.path() / name);
    write(bytes);
    auto opened = open_or_quarantine(file());
    ASSERT_TRUE(opened) << opened.error().message;
    EXPECT_TRUE(opened->content.empty());
    EXPECT_TRUE(content(opened->quarantined) == bytes);
    made::MapMaker anew(made::small_pace(2));
    EXPECT_TRUE(opened->store.commit(anew.next()));
    EXPECT_TRUE(same_map(*opened->store.load(), anew.truth().content()));
    ASSERT_EQ(set_aside().size(), 1u);
  }
}

TEST_F(Quarantine, SaysLoudlyWhereEverythingIs) {
  write("no map");
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened);
  EXPECT_THAT(log_.text(),
              AllOf(HasSubstr("[error] map store damaged: " + file().string()),
                    HasSubstr("it is kept as " + opened->quarantined.string()),
                    HasSubstr("an EMPTY map begins at " + file().string()), HasSubstr("if you have a copy")));
}

TEST_F(Quarantine, KeepsTheNewestThree) {
  std::string last;
  for (int i = 0; i < 6; ++i) {
    write("damaged, number " + std::to_string(i));
    const auto opened = open_or_quarantine(file());
    ASSERT_TRUE(opened) << opened.error().message;
    last = opened->quarantined.filename().string();
    EXPECT_EQ(content(opened->quarantined), "damaged, number " + std::to_string(i));
  }
  EXPECT_EQ(set_aside().size(), 3u);
  EXPECT_THAT(set_aside(), testing::Contains(last));
}

TEST_F(Quarantine, TakesTheLogAlong) {
  make_store();
  const std::string whole = content(file());
  {
    auto store = MapStore::open(file(), StoreMode::read_write);
    ASSERT_TRUE(store->commit(maker_.next()));
    std::filesystem::copy_file(folder_.path() / "map.db-wal", folder_.path() / "kept");
  }
  write(whole.substr(0, 100) + std::string(whole.size() - 100, '\0'));
  std::filesystem::rename(folder_.path() / "kept", folder_.path() / "map.db-wal");
  const std::string log = content(folder_.path() / "map.db-wal");
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_FALSE(opened->quarantined.empty());
  EXPECT_TRUE(content(opened->quarantined.string() + "-wal") == log);
  EXPECT_TRUE(opened->content.empty());
}

// SQLite would replay a log left behind into a new store of the same name.
TEST_F(Quarantine, SetsAsideALogWithoutItsStore) {
  make_store();
  {
    auto store = MapStore::open(file(), StoreMode::read_write);
    ASSERT_TRUE(store->commit(maker_.next()));
    std::filesystem::copy_file(folder_.path() / "map.db-wal", folder_.path() / "kept");
  }
  std::filesystem::remove(file());
  std::filesystem::rename(folder_.path() / "kept", folder_.path() / "map.db-wal");
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_TRUE(opened->content.empty());
  EXPECT_EQ(set_aside().size(), 1u);
}

TEST_F(Quarantine, RemovesAHalfMadeStoreOfADeadProcess) {
  std::ofstream(file().string() + ".new") << "half";
  std::ofstream(file().string() + ".new-journal") << "half";
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_TRUE(opened->quarantined.empty());
  EXPECT_FALSE(std::filesystem::exists(file().string() + ".new"));
}

TEST_F(Quarantine, FollowsALinkToTheStoreItself) {
  std::filesystem::create_directory(folder_.path() / "disk");
  std::filesystem::create_symlink(folder_.path() / "disk" / "real.db", file());
  std::ofstream(folder_.path() / "disk" / "real.db") << "no map";
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_EQ(opened->quarantined.parent_path().filename(), "disk");
  EXPECT_TRUE(std::filesystem::is_symlink(file()));
}

}  // namespace
}  // namespace povslam
