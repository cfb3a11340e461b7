// kill -9 at any instant: what a process said was committed is there afterwards, and the store always opens.
// POVSLAM_KILLS sets how often (tools/experiments/kill_store).
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>

#include "daemon/store.hpp"
#include "pipeline/base/time.hpp"
#include "tests/support/log_text.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/same_map.hpp"
#include "tests/support/same_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

made::MapPace pace(unsigned seed) {
  made::MapPace pace = made::small_pace(seed);
  pace.features = seed % 2 == 0 ? 20 : 300;
  pace.new_landmarks = seed % 2 == 0 ? 12 : 300;
  return pace;
}

// Change number n of the map and of what stands in it: of both, or of one.
struct Maker {
  explicit Maker(unsigned seed)
      : maps(pace(seed)), worlds({.blocks = 1 + static_cast<int>(seed % 2) * 10, .seed = seed}) {}

  Result<CommitReport> commit_next(MapStore& store) {
    next();
    return store.commit(map ? &*map : nullptr, world ? &*world : nullptr);
  }
  void next() {
    const int kind = number++ % 3;
    map.reset();
    world.reset();
    if (kind != 1) map = maps.next();
    if (kind != 2) world = worlds.next();
  }
  testing::AssertionResult is_in(const OpenedStore& opened) const {
    const auto as_map = same_map(opened.content, maps.truth().content());
    return as_map ? same_world(opened.world, worlds.truth().content()) : as_map;
  }

  made::MapMaker maps;
  made::WorldMaker worlds;
  std::optional<MapChange> map;
  std::optional<WorldChange> world;
  int number = 0;
};

// The child: goes on from change number `done`, and tells the number of each commit through `pipe`. Never returns.
[[noreturn]] void commit_for_ever(const std::filesystem::path& file, unsigned seed, int done, int pipe) {
  Maker maker(seed);
  for (int i = 0; i < done; ++i) maker.next();
  auto opened = open_or_quarantine(file);
  if (!opened) _exit(3);
  for (int number = done + 1;; ++number) {
    if (!maker.commit_next(opened->store)) _exit(4);
    if (write(pipe, &number, sizeof number) != sizeof number) _exit(5);
  }
}

struct Killed {
  int confirmed = 0;  // the last number the child told
  int status = 0;
};

// Kills `after` the child has told of `commits`, however fast the machine is.
Killed run_and_kill(const std::filesystem::path& file, unsigned seed, int done, int commits, TimeNs after) {
  int ends[2];
  EXPECT_EQ(pipe(ends), 0);
  const pid_t child = fork();
  if (child == 0) {
    close(ends[0]);
    commit_for_ever(file, seed, done, ends[1]);
  }
  close(ends[1]);
  Killed killed{done, 0};
  int number = 0;
  while (killed.confirmed < done + commits && read(ends[0], &number, sizeof number) == sizeof number) {
    killed.confirmed = number;
  }
  usleep(static_cast<useconds_t>(after / kNsPerUs));
  kill(child, SIGKILL);
  waitpid(child, &killed.status, 0);
  while (read(ends[0], &number, sizeof number) == sizeof number) killed.confirmed = number;
  close(ends[0]);
  return killed;
}

TEST(StoreKill, LosesNothingCommittedAndAlwaysOpens) {
  const char* asked = std::getenv("POVSLAM_KILLS");
  const int kills = asked == nullptr ? 30 : std::atoi(asked);
  std::mt19937 random(1);
  int total_confirmed = 0, one_more = 0, stores = 0;
  double slowest_ms = 0.0;
  std::unique_ptr<TempFolder> folder;
  std::unique_ptr<Maker> maker;
  int done = 0;
  unsigned seed = 0;
  for (int i = 0; i < kills && !testing::Test::HasFailure(); ++i) {
    if (i % 10 == 0) {  // a new store now and then: its making is interrupted as well
      folder = std::make_unique<TempFolder>();
      maker = std::make_unique<Maker>(++seed);
      done = 0;
      ++stores;
    }
    const int commits = std::uniform_int_distribution<int>(0, 4)(random);
    const TimeNs after = std::uniform_int_distribution<TimeNs>(0, 30 * kNsPerMs)(random);
    const auto file = folder->path() / "map.db";
    const Killed killed = run_and_kill(file, seed, done, commits, after);
    ASSERT_TRUE(WIFSIGNALED(killed.status)) << "the child failed with " << WEXITSTATUS(killed.status);
    total_confirmed += killed.confirmed - done;
    for (; done < killed.confirmed; ++done) maker->next();
    const LogText log;
    const TimeNs begun = monotonic_now();
    const auto opened = open_or_quarantine(file);
    slowest_ms = std::max(slowest_ms, to_ms(monotonic_now() - begun));
    ASSERT_TRUE(opened) << opened.error().message;
    ASSERT_TRUE(opened->quarantined.empty()) << log.text();
    if (maker->is_in(*opened)) continue;
    maker->next();  // committed, and killed before it could tell
    ++done;
    ++one_more;
    EXPECT_TRUE(maker->is_in(*opened)) << "kill " << i;
  }
  std::printf(
      "%d kills on %d stores: %d commits confirmed, none missing; %d more found that were not yet told; "
      "slowest opening %.0f ms\n",
      kills, stores, total_confirmed, one_more, slowest_ms);
  EXPECT_GT(total_confirmed, kills);
}

}  // namespace
}  // namespace povslam
