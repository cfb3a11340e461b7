// The store on a disk that forgets, fills up and fails.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

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

using Leftover = FaultyDisk::Leftover;

// A store, what it was told and what it must still know.
class Trial {
 public:
  explicit Trial(unsigned seed) : random_(seed), maker_(pace(seed)), worlds_(world_pace(seed)) {
    states_.push_back({});
  }

  std::filesystem::path file() const { return folder_.path() / "map.db"; }
  FaultyDisk& disk() { return disk_; }
  std::mt19937& random() { return random_; }
  int dice(int low, int high) { return std::uniform_int_distribution<int>(low, high)(random_); }
  std::size_t confirmed() const { return confirmed_; }

  // Commits until the power goes, now and then closing and opening in between.
  void work_until_the_power_goes() {
    while (!disk_.power_is_off()) {
      if (!store_ || dice(0, 9) == 0) open();
      if (!store_) continue;
      if (!waiting_) next();
      commit();
    }
    store_.reset();
  }

  bool commit() {
    const auto done = store_->commit(map_ ? &*map_ : nullptr, world_ ? &*world_ : nullptr);
    if (!done) return false;
    confirmed_ = states_.size() - 1;
    waiting_ = false;
    return true;
  }
  // A change of the map, of what stands in it, or of both; of both first, since objects name landmarks of the map.
  void next() { next(states_.size() == 1 ? kBoth : dice(0, 2)); }
  static constexpr int kBoth = 2;
  void next(int kind) {
    map_.reset();
    world_.reset();
    if (kind != 1) map_ = maker_.next();
    if (kind != 0) world_ = worlds_.next();
    states_.push_back({maker_.truth().content(), worlds_.truth().content()});
    waiting_ = true;
  }
  void open() {
    store_.reset();
    auto opened = MapStore::open(file(), StoreMode::read_write);
    if (opened) store_.emplace(std::move(*opened));
    EXPECT_TRUE(opened || disk_.power_is_off() || disk_.has_failed()) << opened.error().message;
  }
  void close() { store_.reset(); }

  // It must open, and hold what was last confirmed or what was being committed then, and nothing else.
  void expect_nothing_lost() {
    LogText log;
    auto opened = open_or_quarantine(file());
    ASSERT_TRUE(opened) << opened.error().message;
    ASSERT_TRUE(opened->quarantined.empty()) << log.text();
    const auto as_confirmed = same(*opened, states_[confirmed_]);
    const auto as_last = same(*opened, states_.back());
    EXPECT_TRUE(as_confirmed || as_last) << as_confirmed.message() << "; " << as_last.message() << "; " << confirmed_
                                         << " confirmed, next keyframe " << opened->content.meta.next_keyframe;
  }

 private:
  struct State {
    MapContent map;
    WorldContent world;
  };
  static testing::AssertionResult same(const OpenedStore& opened, const State& state) {
    const auto map = same_map(opened.content, state.map);
    return map ? same_world(opened.world, state.world) : map;
  }
  static made::WorldPace world_pace(unsigned seed) {
    return {.objects = 1, .old_objects = 1, .blocks = seed % 3 == 0 ? 20 : 1, .seed = seed};
  }
  static made::MapPace pace(unsigned seed) {
    made::MapPace pace = made::small_pace(seed);
    if (seed % 3 == 0) {  // commits of some hundred pages: the log is brought in every few
      pace.features = 400;
      pace.new_landmarks = 500;
    }
    return pace;
  }

  TempFolder folder_;
  FaultyDisk disk_;
  std::mt19937 random_;
  made::MapMaker maker_;
  made::WorldMaker worlds_;
  std::optional<MapStore> store_;
  std::optional<MapChange> map_;
  std::optional<WorldChange> world_;
  bool waiting_ = false;
  std::vector<State> states_;  // after each change; the last may be on its way
  std::size_t confirmed_ = 0;
};

TEST(StorePower, NothingCommittedIsLostWhenThePowerGoes) {
  std::size_t confirmed = 0;
  for (unsigned seed = 0; seed < 40 && !testing::Test::HasFailure(); ++seed) {
    Trial trial(seed);
    for (int cut = 0; cut < 4; ++cut) {
      trial.disk().cut_power_after(trial.dice(0, seed % 2 == 0 ? 150 : 2500));
      trial.work_until_the_power_goes();
      trial.disk().power_on(static_cast<Leftover>(trial.dice(0, 2)), trial.random());
      trial.expect_nothing_lost();
    }
    confirmed += trial.confirmed();
  }
  EXPECT_GT(confirmed, 600u) << "the cuts come too early to prove anything";
}

TEST(StorePower, EachMomentOfTheFirstCommitsAndOfCreationIsSafe) {
  for (int calls = 0; calls < 200 && !testing::Test::HasFailure(); ++calls) {
    Trial trial(1);
    trial.disk().cut_power_after(calls);
    trial.work_until_the_power_goes();
    trial.disk().power_on(static_cast<Leftover>(calls % 3), trial.random());
    trial.expect_nothing_lost();
  }
}

// fault, then the same change again; then the power goes.
void fail_and_retry(DiskFault fault, int after, int times, int& faults_hit) {
  Trial trial(4);
  trial.open();
  for (int i = 0; i < 3; ++i) {
    trial.next();
    ASSERT_TRUE(trial.commit());
  }
  trial.disk().fail_after(after, fault, times);
  int failed = 0;
  for (int i = 0; i < 6; ++i) {
    trial.next();
    while (!trial.commit()) ASSERT_LE(++failed, times + 1);
  }
  faults_hit += trial.disk().has_failed() ? 1 : 0;
  trial.disk().cut_power_after(0);
  trial.close();
  trial.disk().power_on(Leftover::nothing, trial.random());
  trial.expect_nothing_lost();
}

TEST(StorePower, AFailedCommitIsTriedAgainAndThenSafe) {
  for (const DiskFault fault : {DiskFault::full, DiskFault::io_error, DiskFault::short_write}) {
    int faults_hit = 0;
    for (int after = 0; after < 130 && !testing::Test::HasFailure(); after += 1 + after / 20) {
      fail_and_retry(fault, after, 1 + after % 3, faults_hit);
    }
    EXPECT_GT(faults_hit, 30);
  }
}

// What a failed sync leaves can still be read, but a later sync does not bring it to the disk.
TEST(StorePower, NothingBuildsOnWhatCouldNotBeSynced) {
  int faults_hit = 0;
  for (int after = 0; after < 12 && !testing::Test::HasFailure(); ++after) {
    for (const int times : {1, 2, 3, 4}) fail_and_retry(DiskFault::failed_sync, after, times, faults_hit);
  }
  EXPECT_GT(faults_hit, 20);
}

TEST(StorePower, AFullDiskKeepsWhatWasStored) {
  Trial trial(5);
  trial.open();
  trial.next();
  ASSERT_TRUE(trial.commit());
  trial.disk().fail_after(0, DiskFault::full, 1 << 30);
  trial.next();
  for (int i = 0; i < 5; ++i) EXPECT_FALSE(trial.commit());
  trial.close();
  trial.expect_nothing_lost();
}

// Opens a store while `times` reads fail from number `after` on. Counts a refusal.
void open_with_read_errors(int after, int times, int& refusals) {
  Trial trial(6);
  trial.open();
  for (int i = 0; i < 5; ++i) {
    trial.next(Trial::kBoth);
    ASSERT_TRUE(trial.commit());
  }
  if (after % 2 == 0) trial.close();
  trial.disk().fail_after(after, DiskFault::read_error, times);
  trial.close();
  {
    LogText log;
    const auto opened = open_or_quarantine(trial.file());
    EXPECT_TRUE(!opened || opened->quarantined.empty()) << after << ": " << log.text();
    if (!opened) {
      ++refusals;
      EXPECT_THAT(opened.error().message, testing::HasSubstr("dmesg"));
    }
  }
  trial.disk().fail_after(0, DiskFault::read_error, 0);
  trial.expect_nothing_lost();
}

TEST(StorePower, ReadErrorsAreNoDamage) {
  for (const int times : {1, 3, 1 << 30}) {
    int refusals = 0;
    for (int after = 0; after < 60 && !testing::Test::HasFailure(); after += 1 + after / 8) {
      open_with_read_errors(after, times, refusals);
    }
    EXPECT_GT(refusals, 1) << times;  // what opening reads first
  }
}

}  // namespace
}  // namespace povslam
