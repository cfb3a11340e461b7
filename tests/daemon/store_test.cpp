#include "daemon/store.hpp"

#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sqlite3.h>
#include <sys/stat.h>
#include <unistd.h>

#include <fstream>
#include <limits>

#include "daemon/store_rows.hpp"
#include "daemon/store_schema.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/same_map.hpp"
#include "tests/support/same_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

class Store : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "map.db"; }
  MapStore open(StoreMode mode = StoreMode::read_write) {
    auto store = MapStore::open(file(), mode);
    EXPECT_TRUE(store) << store.error().message;
    return std::move(*store);
  }
  std::string refusal(StoreMode mode = StoreMode::read_write) {
    const auto store = MapStore::open(file(), mode);
    EXPECT_FALSE(store);
    return store ? "" : store.error().message;
  }
  // Past the store, as another program would.
  void run_sql(const std::string& sql) const {
    sqlite3* database = nullptr;
    ASSERT_EQ(sqlite3_open(file().c_str(), &database), SQLITE_OK);
    EXPECT_EQ(sqlite3_exec(database, sql.c_str(), nullptr, nullptr, nullptr), SQLITE_OK) << sqlite3_errmsg(database);
    sqlite3_close(database);
  }
  std::string load_fault() {
    auto store = MapStore::open(file(), StoreMode::read_only);
    if (!store) return store.error().message;
    const auto content = store->load();
    const auto world = store->load_world();
    return !content ? content.error().message : !world ? world.error().message : "";
  }
  std::size_t count_files(const std::string& part) const {
    std::size_t count = 0;
    for (const auto& entry : std::filesystem::directory_iterator(folder_.path())) {
      count += entry.path().filename().string().find(part) != std::string::npos ? 1 : 0;
    }
    return count;
  }
  TempFolder folder_;
};

TEST_F(Store, BeginsEmpty) {
  MapStore store = open();
  const auto content = store.load();
  ASSERT_TRUE(content) << content.error().message;
  EXPECT_TRUE(content->empty());
  EXPECT_EQ(content->meta.next_keyframe, 0);
}

TEST_F(Store, GivesBackToTheLastBitWhatWasCommitted) {
  made::MapMaker maker(made::small_pace(1));
  {
    MapStore store = open();
    for (int i = 1; i <= 30; ++i) {
      const auto done = store.commit(maker.next());
      ASSERT_TRUE(done) << done.error().message;
      EXPECT_EQ(done->number, static_cast<std::uint64_t>(i));
      EXPECT_EQ(done->rows_left_out, 0) << done->why_left_out;
    }
    EXPECT_TRUE(same_map(*store.load(), maker.truth().content()));
  }
  MapStore again = open();
  EXPECT_TRUE(same_map(*again.load(), maker.truth().content()));
  ASSERT_TRUE(again.commit(maker.next()));
  EXPECT_TRUE(same_map(*again.load(), maker.truth().content()));
}

TEST_F(Store, SetAndRemovedInOneChangeIsRemoved) {
  made::MapMaker maker(made::small_pace(2));
  MapStore store = open();
  MapChange change = maker.next();
  change.removed_keyframes = {0};
  change.removed_landmarks = {1, 999};
  ASSERT_TRUE(store.commit(change));
  const auto content = store.load();
  EXPECT_EQ(content->keyframes.size(), 1u);
  for (const auto& row : content->looks) EXPECT_NE(row.landmark, 1);
}

TEST_F(Store, LeavesNothingBesideItWhenClosed) {
  {
    MapStore store = open();
    made::MapMaker maker(made::small_pace(3));
    ASSERT_TRUE(store.commit(maker.next()));
  }
  EXPECT_EQ(count_files("map.db"), 2u);  // and its lock
}

TEST_F(Store, IsReadBesideItsWriter) {
  MapStore writer = open();
  made::MapMaker maker(made::small_pace(4));
  ASSERT_TRUE(writer.commit(maker.next()));
  MapStore reader = open(StoreMode::read_only);
  EXPECT_TRUE(same_map(*reader.load(), maker.truth().content()));
  ASSERT_TRUE(writer.commit(maker.next()));
  EXPECT_TRUE(same_map(*reader.load(), maker.truth().content()));
  const auto info = reader.info();
  ASSERT_TRUE(info);
  EXPECT_EQ(info->commits, 2u);
  EXPECT_GT(info->log_bytes, 0u);
}

TEST_F(Store, HasOneWriter) {
  const MapStore writer = open();
  EXPECT_THAT(refusal(), AllOf(HasSubstr("map.db: another povslam process uses this map"), HasSubstr("fuser")));
  EXPECT_FALSE(open_or_quarantine(file()));
  EXPECT_EQ(count_files("damaged"), 0u);
}

TEST_F(Store, SaysWhatItHolds) {
  made::MapMaker maker(made::small_pace(5));
  MapStore store = open();
  ASSERT_TRUE(store.commit(maker.next()));
  const auto info = store.info();
  ASSERT_TRUE(info) << info.error().message;
  EXPECT_EQ(info->schema_version, kSchemaVersion);
  EXPECT_EQ(info->meta.next_landmark, maker.truth().meta.next_landmark);
  EXPECT_GE(info->committed, info->created);
  for (const auto& table : info->tables) {
    if (table.table == std::string("looks")) {
      EXPECT_EQ(table.rows, maker.truth().looks.size());
      EXPECT_EQ(table.bytes, maker.truth().looks.size() * (1 + kPatchSide * kPatchSide));
    }
  }
}

TEST_F(Store, LeavesOutARowThatCannotBeAndKeepsTheOneBefore) {
  made::MapMaker maker(made::small_pace(6));
  MapStore store = open();
  ASSERT_TRUE(store.commit(maker.next()));
  MapChange change;
  change.meta = maker.truth().meta;
  change.keyframes = {maker.truth().keyframes.at(1), maker.truth().keyframes.at(0)};
  change.keyframes[0].T_world_camera.translation.x() = std::numeric_limits<double>::quiet_NaN();
  change.keyframes[1].T_world_camera.translation.x() = 7.0;
  const auto done = store.commit(change);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->rows_left_out, 1);
  EXPECT_EQ(done->why_left_out, "keyframe 1: the pose is none");
  const auto content = store.load();
  ASSERT_TRUE(content) << content.error().message;
  EXPECT_EQ(content->keyframes[0].T_world_camera.translation.x(), 7.0);
  EXPECT_EQ(content->keyframes[1].T_world_camera.translation.x(),
            maker.truth().keyframes.at(1).T_world_camera.translation.x());
}

TEST_F(Store, NeverTakesBackIdsThatWereGivenOut) {
  made::MapMaker maker(made::small_pace(7));
  MapStore store = open();
  ASSERT_TRUE(store.commit(maker.next()));
  MapChange forgetful;
  forgetful.meta.next_keyframe = 1;
  ASSERT_TRUE(store.commit(forgetful));
  EXPECT_EQ(store.load()->meta.next_keyframe, maker.truth().meta.next_keyframe);
}

TEST_F(Store, LeavesOutWhatLostItsOtherHalf) {
  made::MapMaker maker(made::small_pace(8));
  MapStore store = open();
  MapChange change = maker.next();
  change.keyframes.erase(change.keyframes.begin());  // number 0 has features only
  change.looks.pop_back();
  ASSERT_TRUE(store.commit(change));
  const auto content = store.load();
  ASSERT_TRUE(content) << content.error().message;
  EXPECT_EQ(content->features.size(), 1u);
  for (const auto& row : content->landmarks) EXPECT_EQ(row.anchor, 1);
  EXPECT_EQ(content->looks.size() + 1, content->landmarks.size());
  EXPECT_FALSE(content->landmarks.back().has_patch);
}

TEST_F(Store, NoticesARowThatVanishedOrChangedOrMoved) {
  made::MapMaker maker(made::small_pace(9));
  ASSERT_TRUE(open().commit(maker.next()));
  const auto before = folder_.path() / "whole.db";
  std::filesystem::copy_file(file(), before);
  const auto fault_after = [&](const std::string& sql) {
    std::filesystem::copy_file(before, file(), std::filesystem::copy_options::overwrite_existing);
    run_sql(sql);
    return load_fault();
  };
  EXPECT_THAT(fault_after("DELETE FROM looks WHERE id = 3"),
              HasSubstr("table looks: 11 rows where the manifest has 12"));
  EXPECT_THAT(fault_after("DELETE FROM features"), HasSubstr("table features"));
  EXPECT_THAT(fault_after("UPDATE landmarks SET data = zeroblob(87) WHERE id = 5"),
              HasSubstr("table landmarks, row 5: the checksum differs"));
  EXPECT_THAT(fault_after("UPDATE landmarks SET id = 777 WHERE id = 5"), HasSubstr("row 777: the checksum differs"));
  EXPECT_THAT(fault_after("UPDATE landmarks SET crc = crc + 1 WHERE id = 5"), HasSubstr("row 5"));
  EXPECT_THAT(fault_after("DELETE FROM manifest WHERE id = 2"), HasSubstr("manifest"));
  EXPECT_THAT(fault_after("DELETE FROM meta"), HasSubstr("meta"));
  EXPECT_THAT(fault_after("INSERT INTO events VALUES(1, x'00', 5)"), HasSubstr("table events, row 1"));
  EXPECT_THAT(fault_after("CREATE TABLE more(x)"), HasSubstr("its tables are not those of a map store"));
  EXPECT_THAT(fault_after("PRAGMA user_version = 99"), HasSubstr("its version is damaged"));
  EXPECT_EQ(fault_after("VACUUM"), "");
}

TEST_F(Store, BringsAnOlderStoreForward) {
  {
    Database old(file(), SqlMode::create);
    migrate(old, 0, 1);
    old.text("PRAGMA journal_mode = WAL");
    EXPECT_THROW(old.number("SELECT count(*) FROM events"), StoreFault);
  }
  MapStore reader = open(StoreMode::read_only);
  EXPECT_TRUE(reader.load());
  EXPECT_EQ(reader.info()->schema_version, 1);
  made::MapMaker maker(made::small_pace(10));
  ASSERT_TRUE(open().commit(maker.next()));
  MapStore store = open();
  EXPECT_EQ(store.info()->schema_version, kSchemaVersion);
  EXPECT_TRUE(same_map(*store.load(), maker.truth().content()));
}

TEST_F(Store, KeepsTheMapOfAStoreFromBeforeObjects) {
  made::MapMaker maker(made::small_pace(12));
  const MapChange change = maker.next();
  {
    Database old(file(), SqlMode::create);
    migrate(old, 0, 2);
    old.text("PRAGMA journal_mode = WAL");
    Transaction transaction(old, Transaction::Kind::write);
    Manifest manifest = read_manifest(old, 2);
    Bytes bytes;
    const auto put = [&](Table table, std::int64_t id, const auto& row) {
      write_row(row, bytes);
      TableWriter(old, table).put(id, bytes, manifest);
    };
    put(Table::meta, 0, StoredMeta{.map = change.meta});
    for (const auto& row : change.features) put(Table::features, row.keyframe, row);
    for (const auto& row : change.keyframes) put(Table::keyframes, row.keyframe, row);
    for (const auto& row : change.landmarks) put(Table::landmarks, row.landmark, row);
    for (const auto& row : change.looks) put(Table::looks, row.landmark, row);
    write_manifest(old, 2, manifest);
    transaction.commit();
  }
  EXPECT_TRUE(open(StoreMode::read_only).load_world()->empty());
  EXPECT_EQ(open(StoreMode::read_only).info()->schema_version, 2);
  auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened) << opened.error().message;
  EXPECT_TRUE(opened->quarantined.empty());
  EXPECT_TRUE(same_map(opened->content, maker.truth().content()));
  EXPECT_TRUE(opened->world.empty());
  made::WorldMaker worlds({});
  ASSERT_TRUE(opened->store.commit(worlds.next()));
  EXPECT_EQ(opened->store.info()->schema_version, kSchemaVersion);
  EXPECT_TRUE(same_map(*opened->store.load(), maker.truth().content()));
  EXPECT_TRUE(same_world(*opened->store.load_world(), worlds.truth().content()));
}

// The bytes of a store of version 2 as povslam made it then: marks and checksums must stay what they were.
TEST_F(Store, KnowsTheMarksOfStoresOfBefore) {
  EXPECT_EQ(checksum(Table::landmarks, 5, Bytes{1, 2, 3}), 0xBE9D71DEU);
  EXPECT_EQ(row_mark(Table::landmarks, 5, 7), 0x51AB6BE45FC73A98U);
}

TEST_F(Store, GivesBackToTheLastBitWhatStandsInIt) {
  made::MapMaker maps(made::small_pace(1));
  made::WorldMaker worlds({});
  {
    MapStore store = open();
    for (int i = 0; i < 30; ++i) {
      const MapChange map = maps.next();
      const WorldChange world = worlds.next();
      const auto done = i % 2 == 0 ? store.commit(&map, &world) : store.commit(map);
      ASSERT_TRUE(done) << done.error().message;
      EXPECT_EQ(done->rows_left_out, 0) << done->why_left_out;
      if (i % 2 == 1) {
        ASSERT_TRUE(store.commit(world));
      }
    }
    EXPECT_EQ(store.info()->commits, 45u);
    EXPECT_EQ(store.info()->world.next_event_seq, worlds.truth().meta.next_event_seq);
  }
  const auto opened = open_or_quarantine(file());
  ASSERT_TRUE(opened);
  EXPECT_TRUE(same_map(opened->content, maps.truth().content()));
  EXPECT_TRUE(same_world(opened->world, worlds.truth().content()));
  EXPECT_GT(opened->world.blocks.size(), 50u);
  EXPECT_LT(opened->world.objects.size(), 30u) << "some were removed";
}

TEST_F(Store, LeavesOutAnObjectThatCannotBeAndBlocksWithoutTheirObject) {
  made::WorldMaker worlds({.objects = 2, .seed = 3});
  MapStore store = open();
  WorldChange change = worlds.next();
  change.removed_objects.clear();
  const std::int64_t bad = change.objects[0].object.id;
  change.objects[0].object.place.yaw = std::numeric_limits<double>::quiet_NaN();
  const auto done = store.commit(change);
  ASSERT_TRUE(done);
  EXPECT_EQ(done->rows_left_out, 1);
  EXPECT_EQ(done->why_left_out, "object " + std::to_string(bad) + ": the place is none");
  const auto world = store.load_world();
  ASSERT_TRUE(world) << world.error().message;
  EXPECT_EQ(world->objects.size(), 1u);
  for (const auto& block : world->blocks) EXPECT_NE(block.volume, bad);
}

// The tracker begins again behind what it had not stored: those ids go to other landmarks.
TEST_F(Store, ForgetsClaimsToLandmarksThatWereNeverStored) {
  made::MapMaker maps(made::small_pace(4));
  made::WorldMaker worlds({.seed = 4});
  MapStore store = open();
  ASSERT_TRUE(store.commit(maps.next()));
  const std::int64_t next = maps.truth().meta.next_landmark;
  WorldChange change = worlds.next();
  change.removed_objects.clear();
  change.objects[0].object.landmarks = {0, next - 1, next, next + 7};
  ASSERT_TRUE(store.commit(change));
  EXPECT_EQ(store.load_world()->objects[0].object.landmarks, (std::vector<std::int64_t>{0, next - 1}));
}

TEST_F(Store, NoticesARowOfWhatStandsThatVanishedOrMoved) {
  made::WorldMaker worlds({.objects = 3});
  {
    MapStore store = open();
    ASSERT_TRUE(store.commit(worlds.next()));
  }
  const auto before = folder_.path() / "whole.db";
  std::filesystem::copy_file(file(), before);
  for (const std::string& table :
       std::vector<std::string>{"objects", "voxel_blocks", "empty_cells", "events", "world"}) {
    for (const std::string& sql : {"DELETE FROM " + table, "UPDATE " + table + " SET crc = crc + 1"}) {
      std::filesystem::copy_file(before, file(), std::filesystem::copy_options::overwrite_existing);
      run_sql(sql);
      EXPECT_THAT(load_fault(), HasSubstr("table " + table)) << sql;
    }
  }
}

TEST_F(Store, LeavesANewerStoreAlone) {
  open();
  {
    Database database(file(), SqlMode::read_write);
    Manifest manifest = read_manifest(database, kSchemaVersion);
    const Bytes step = {'x'};
    TableWriter(database, Table::steps).put(kSchemaVersion + 1, step, manifest);
    write_manifest(database, kSchemaVersion, manifest);
    database.run("PRAGMA user_version = " + std::to_string(kSchemaVersion + 1));
  }
  EXPECT_THAT(refusal(), AllOf(HasSubstr("its version is 4"), HasSubstr("install a newer povslam")));
  const auto opened = open_or_quarantine(file());
  ASSERT_FALSE(opened);
  EXPECT_THAT(opened.error().message, HasSubstr("its version is 4"));
  EXPECT_EQ(count_files("damaged"), 0u);
}

TEST_F(Store, MakesItsFolder) {
  const auto deep = folder_.path() / "a" / "b" / "map.db";
  EXPECT_TRUE(MapStore::open(deep, StoreMode::read_write));
  EXPECT_TRUE(std::filesystem::exists(deep));
}

TEST_F(Store, DoesNotMakeWhatIsOnlyToBeRead) {
  EXPECT_THAT(refusal(StoreMode::read_only), HasSubstr("map.db"));
  EXPECT_EQ(count_files("map.db"), 0u);
}

TEST_F(Store, SaysWhatIsWrongWithTheFolder) {
  std::ofstream(folder_.path() / "file") << "no folder";
  const auto store = MapStore::open(folder_.path() / "file" / "map.db", StoreMode::read_write);
  ASSERT_FALSE(store);
  EXPECT_THAT(store.error().message, HasSubstr("file"));
  std::filesystem::create_directory(file());
  const auto folder = open_or_quarantine(file());
  ASSERT_FALSE(folder);
  EXPECT_THAT(folder.error().message, HasSubstr("map.db"));
  EXPECT_EQ(count_files("damaged"), 0u);
}

TEST_F(Store, SaysThatAFolderCannotBeWritten) {
  if (geteuid() == 0) GTEST_SKIP() << "root may write everywhere";
  open();
  const auto empty = folder_.path() / "empty";
  std::filesystem::create_directory(empty);
  for (const auto& folder : {empty, folder_.path()}) {
    std::filesystem::permissions(folder, std::filesystem::perms::owner_read | std::filesystem::perms::owner_exec);
  }
  EXPECT_TRUE(MapStore::open(file(), StoreMode::read_only));
  EXPECT_THAT(refusal(), HasSubstr("this user"));
  const auto fresh = open_or_quarantine(empty / "map.db");
  ASSERT_FALSE(fresh);
  EXPECT_THAT(fresh.error().message, HasSubstr("the folder must be writable by this user"));
  for (const auto& folder : {folder_.path(), empty}) {
    std::filesystem::permissions(folder, std::filesystem::perms::owner_all);
  }
}

TEST_F(Store, NoticesThatItsFileWasTakenAway) {
  made::MapMaker maker(made::small_pace(11));
  MapStore store = open();
  const MapChange first = maker.next(), second = maker.next();
  ASSERT_TRUE(store.commit(first));
  std::filesystem::rename(file(), folder_.path() / "elsewhere.db");
  std::filesystem::rename(folder_.path() / "map.db-wal", folder_.path() / "elsewhere.db-wal");
  for (int i = 0; i < 2; ++i) {
    const auto done = store.commit(second);
    ASSERT_FALSE(done);
    EXPECT_THAT(done.error().message, HasSubstr("map.db"));
  }
  EXPECT_FALSE(std::filesystem::exists(file()));
  std::filesystem::rename(folder_.path() / "elsewhere.db", file());
  std::filesystem::rename(folder_.path() / "elsewhere.db-wal", folder_.path() / "map.db-wal");
  const auto done = store.commit(second);
  ASSERT_TRUE(done) << done.error().message;
  EXPECT_TRUE(same_map(*store.load(), maker.truth().content()));
}

}  // namespace
}  // namespace povslam
