// Any damage to a store's files: what opens is what was stored, or an empty map with the damaged one set aside.
#include <gtest/gtest.h>

#include <fstream>
#include <sstream>

#include "daemon/store.hpp"
#include "tests/support/faulty_disk.hpp"
#include "tests/support/log_text.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/same_map.hpp"
#include "tests/support/same_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

std::string read_file(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

void write_file(const std::filesystem::path& file, const std::string& bytes) {
  std::ofstream(file, std::ios::binary) << bytes;
}

// One accident: a bit, some bits, a block of zeros, a block of another place, the end gone.
void damage(std::string& bytes, std::mt19937& random) {
  const auto dice = [&random](std::size_t sides) {
    return std::uniform_int_distribution<std::size_t>(0, sides - 1)(random);
  };
  const std::size_t at = dice(bytes.size()), length = std::min(bytes.size() - at, std::size_t{1} << dice(14));
  switch (dice(6)) {
    case 0:
      bytes.resize(at);
      return;
    case 1:
      std::fill_n(bytes.begin() + static_cast<std::ptrdiff_t>(at), length, '\0');
      return;
    case 2:
      bytes.replace(at, length, bytes.substr(dice(bytes.size() - length + 1), length));
      return;
    case 3:  // the file's and its first pages' headers
      bytes[dice(std::min<std::size_t>(bytes.size(), 200))] ^= static_cast<char>(1U << dice(8));
      return;
    default:
      for (std::size_t n = 1U << dice(5); n > 0; --n) bytes[dice(bytes.size())] ^= static_cast<char>(1U << dice(8));
  }
}

class Damage : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "map.db"; }
  std::filesystem::path log_file() const { return file().string() + "-wal"; }
  void put(const std::string& store, const std::string& log) const {
    std::filesystem::remove(log_file());
    std::filesystem::remove(file().string() + "-shm");
    write_file(file(), store);
    if (!log.empty()) write_file(log_file(), log);
  }
  // The store's states after each of ten commits; its files as a killed process leaves them.
  void make_store(bool killed) {
    made::MapPace pace = made::small_pace(1);
    pace.features = 150;  // features need overflow pages
    made::MapMaker maker(pace);
    made::WorldMaker worlds({});
    auto store = MapStore::open(file(), StoreMode::read_write);
    ASSERT_TRUE(store);
    states_.push_back({});
    for (int i = 0; i < 10; ++i) {
      if (i == 5) store = Error{"closed once in between"}, store = MapStore::open(file(), StoreMode::read_write);
      const MapChange map = maker.next();
      const WorldChange world = worlds.next();
      ASSERT_TRUE(store->commit(&map, &world));
      states_.push_back({maker.truth().content(), worlds.truth().content()});
    }
    if (killed) {
      whole_ = read_file(file());
      log_ = read_file(log_file());
    }
    store = Error{"closed"};
    if (!killed) whole_ = read_file(file());
  }
  struct State {
    MapContent map;
    WorldContent world;
  };
  static bool is(const OpenedStore& opened, const State& state) {
    return same_map(opened.content, state.map) && same_world(opened.world, state.world);
  }
  std::filesystem::path folder() const { return folder_.path(); }

  TempFolder folder_;
  FaultyDisk disk_;  // a sound one: it only spares the waiting for real syncs
  LogText text_;
  std::vector<State> states_;
  std::string whole_, log_;
};

TEST_F(Damage, OfTheFileIsNoticedOrHarmless) {
  make_store(false);
  std::mt19937 random(2);
  int set_aside = 0;
  for (int i = 0; i < 300 && !HasFailure(); ++i) {
    std::string bytes = whole_;
    damage(bytes, random);
    put(bytes, "");
    auto opened = open_or_quarantine(file());
    ASSERT_TRUE(opened) << opened.error().message;
    set_aside += opened->quarantined.empty() ? 0 : 1;
    EXPECT_TRUE(is(*opened, opened->quarantined.empty() ? states_.back() : State{})) << i;
    made::MapMaker maker(made::small_pace(3));
    EXPECT_TRUE(opened->store.commit(maker.next())) << i;
  }
  EXPECT_GT(set_aside, 180);
}

// The log ends where its checksums end to be right: SQLite cannot tell a damaged one from one cut short by a power cut.
// So the map may be that of an earlier commit, but never one that never was.
TEST_F(Damage, OfTheLogGivesAStateThatWas) {
  make_store(true);
  std::mt19937 random(4);
  for (int i = 0; i < 300 && !HasFailure(); ++i) {
    std::string store = whole_, log = log_;
    damage(i % 3 == 0 ? store : log, random);
    put(store, log);
    const auto opened = open_or_quarantine(file());
    ASSERT_TRUE(opened) << opened.error().message;
    bool was = false;
    for (std::size_t state = 0; state < states_.size(); ++state) {
      was = was || (opened->quarantined.empty() == (state > 0) && is(*opened, states_[state]));
    }
    EXPECT_TRUE(was) << i;
  }
}

TEST_F(Damage, OfEachByteOfTheFirstPageIsNoticedOrHarmless) {
  make_store(false);
  for (std::size_t at = 0; at < 4096 && !HasFailure(); at += at < 110 ? 1 : 97) {
    for (const int bit : {0, 7}) {
      std::string bytes = whole_;
      bytes[at] ^= static_cast<char>(1U << bit);
      put(bytes, "");
      const auto opened = open_or_quarantine(file());
      ASSERT_TRUE(opened) << at << ": " << opened.error().message;
      EXPECT_TRUE(is(*opened, opened->quarantined.empty() ? states_.back() : State{})) << at;
    }
  }
}

}  // namespace
}  // namespace povslam
