#include "daemon/store_thread.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <functional>
#include <thread>

#include "tests/support/log_text.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/same_map.hpp"
#include "tests/support/same_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::HasSubstr;

bool eventually(const std::function<bool()>& condition) {
  for (int i = 0; i < 2000 && !condition(); ++i) std::this_thread::sleep_for(std::chrono::milliseconds(5));
  return condition();
}

class StoreThreadTest : public testing::Test {
 protected:
  std::filesystem::path file() const { return folder_.path() / "map.db"; }
  std::unique_ptr<StoreThread> start() {
    auto store = MapStore::open(file(), StoreMode::read_write);
    EXPECT_TRUE(store) << store.error().message;
    const StoreThreadOptions options{.first_pause = 2 * kNsPerMs, .longest_pause = 10 * kNsPerMs};
    return std::make_unique<StoreThread>(std::move(*store), changes_, counters_, options);
  }
  void push(MapChange& change) {
    MapChange* pointer = &change;
    EXPECT_TRUE(changes_.map.taken.try_push(std::move(pointer)));
  }
  void take_the_file_away() {
    std::filesystem::rename(file(), folder_.path() / "away");
    if (std::filesystem::exists(log())) std::filesystem::rename(log(), folder_.path() / "away-wal");
  }
  void bring_it_back() {
    if (std::filesystem::exists(folder_.path() / "away-wal"))
      std::filesystem::rename(folder_.path() / "away-wal", log());
    std::filesystem::rename(folder_.path() / "away", file());
  }
  MapContent on_disk() const {
    auto store = MapStore::open(file(), StoreMode::read_only);
    EXPECT_TRUE(store) << store.error().message;
    return *store->load();
  }
  std::filesystem::path log() const { return file().string() + "-wal"; }

  TempFolder folder_;
  LogText log_;
  Counters counters_;
  ChangeRings changes_;
  made::MapMaker maker_{made::small_pace(1)};
};

TEST_F(StoreThreadTest, CommitsWhatItIsGivenAndGivesItBack) {
  const auto thread = start();
  for (int i = 0; i < 5; ++i) {
    MapChange change = maker_.next();
    push(change);
    EXPECT_EQ(*changes_.map.stored.pop(), &change);
    EXPECT_TRUE(same_map(on_disk(), maker_.truth().content()));
  }
  EXPECT_EQ(counters_.store_commits.load(), 5);
  EXPECT_GT(counters_.store_committed_at.load(), 0);
  EXPECT_FALSE(counters_.store_failing.load());
}

TEST_F(StoreThreadTest, StoresWhatIsLeftAtTheEnd) {
  const auto thread = start();
  MapChange last = maker_.next();
  push(last);
  EXPECT_TRUE(thread->finish());
  MapChange rest = maker_.next();
  EXPECT_TRUE(thread->commit_rest(&rest, nullptr));
  EXPECT_TRUE(same_map(on_disk(), maker_.truth().content()));
}

TEST_F(StoreThreadTest, TriesOnUntilTheDiskIsBackAndForgetsNothing) {
  const auto thread = start();
  take_the_file_away();
  MapChange change = maker_.next();
  push(change);
  EXPECT_TRUE(eventually([this] { return counters_.store_failing.load(); }));
  std::this_thread::sleep_for(std::chrono::milliseconds(50));  // several tries
  EXPECT_FALSE(changes_.map.stored.try_pop());
  bring_it_back();
  EXPECT_EQ(*changes_.map.stored.pop(), &change);
  EXPECT_TRUE(thread->finish());
  EXPECT_FALSE(counters_.store_failing.load());
  EXPECT_TRUE(same_map(on_disk(), maker_.truth().content()));
  EXPECT_THAT(log_.text(), HasSubstr("[error] map not stored: " + file().string()));
  EXPECT_THAT(log_.text(), HasSubstr("[info] " + file().string() + ": stored again after"));
  EXPECT_EQ(log_.lines(), 2);
}

TEST_F(StoreThreadTest, EndsAtOnceWhileTheDiskIsAwayAndSaysWhatIsMissing) {
  const auto thread = start();
  take_the_file_away();
  MapChange change = maker_.next();
  push(change);
  EXPECT_TRUE(eventually([this] { return counters_.store_failing.load(); }));
  const TimeNs begun = monotonic_now();
  EXPECT_FALSE(thread->finish());
  EXPECT_LT(to_seconds(monotonic_now() - begun), 2.0);
  EXPECT_THAT(log_.text(), HasSubstr("the last changes of the map are not stored"));
}

TEST_F(StoreThreadTest, CommitsWhatStandsInTheMapAsWell) {
  const auto thread = start();
  made::WorldMaker worlds({});
  WorldChange first = worlds.next(), second = worlds.next();
  const auto push_world = [this](WorldChange& change) {
    WorldChange* pointer = &change;
    EXPECT_TRUE(changes_.world.taken.try_push(std::move(pointer)));
  };
  push_world(first);
  EXPECT_EQ(*changes_.world.stored.pop(), &first);
  MapChange map = maker_.next();
  push(map);
  push_world(second);
  EXPECT_EQ(*changes_.world.stored.pop(), &second);
  EXPECT_TRUE(thread->finish());
  WorldChange rest = worlds.next();
  MapChange map_rest = maker_.next();
  const std::int64_t before = counters_.store_commits;
  EXPECT_TRUE(thread->commit_rest(&map_rest, &rest));
  EXPECT_EQ(counters_.store_commits, before + 1) << "both at once";
  EXPECT_TRUE(same_map(on_disk(), maker_.truth().content()));
  EXPECT_TRUE(same_world(*MapStore::open(file(), StoreMode::read_only)->load_world(), worlds.truth().content()));
}

TEST_F(StoreThreadTest, SaysOnceThatARowCannotBe) {
  const auto thread = start();
  for (int i = 0; i < 3; ++i) {
    MapChange change = maker_.next();
    change.keyframes[0].covariance(0, 0) = std::numeric_limits<double>::infinity();
    push(change);
    ASSERT_TRUE(changes_.map.stored.pop());
  }
  EXPECT_TRUE(thread->finish());
  EXPECT_THAT(log_.text(), HasSubstr("1 rows left out, the first: keyframe 0: the covariance is none"));
  EXPECT_EQ(log_.lines(), 1);
}

}  // namespace
}  // namespace povslam
