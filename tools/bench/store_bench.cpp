// What the map on disk costs: a commit of what two seconds of mapping change, its bytes, and loading a whole map.
#include <benchmark/benchmark.h>
#include <unistd.h>

#include <fstream>

#include "daemon/store.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

MapStore store_at(const std::filesystem::path& file) {
  auto store = MapStore::open(file, StoreMode::read_write);
  EXPECTS(store);
  return std::move(*store);
}

// Bytes that this process gave to the disk so far.
double written_bytes() {
  std::ifstream file("/proc/self/io");
  std::string name;
  double value = 0.0;
  while (file >> name >> value) {
    if (name == "wchar:") return value;
  }
  return 0.0;
}

// Changes of 3 keyframes with 1,000 features, 400 new landmarks with their looks, 1,100 corrected ones and 24 corrected
// keyframes, on a store that already holds some.
void commit_change(benchmark::State& state) {
  const TempFolder folder;
  MapStore store = store_at(folder.path() / "map.db");
  made::MapMaker maker({});
  for (int i = 0; i < 30; ++i) EXPECTS(store.commit(maker.next()));
  double bytes = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    const MapChange change = maker.next();
    const double before = written_bytes();
    state.ResumeTiming();
    EXPECTS(store.commit(change));
    state.PauseTiming();
    bytes += written_bytes() - before;
    state.ResumeTiming();
  }
  state.counters["written_MB"] = 1e-6 * bytes / static_cast<double>(state.iterations());
}
BENCHMARK(commit_change)->Unit(benchmark::kMillisecond)->Iterations(100)->UseRealTime();

// Changes of 20 objects with 5 voxel blocks each, 100 of the structure, and the argument's number of empty cells, on a
// store that already holds some.
void commit_world(benchmark::State& state) {
  const TempFolder folder;
  MapStore store = store_at(folder.path() / "map.db");
  made::WorldMaker maker({.objects = 1,
                          .old_objects = 19,
                          .blocks = 5,
                          .structure_blocks = 100,
                          .empty_cells = static_cast<int>(state.range(0))});
  for (int i = 0; i < 30; ++i) EXPECTS(store.commit(maker.next()));
  double bytes = 0.0;
  for (auto _ : state) {
    state.PauseTiming();
    const WorldChange change = maker.next();
    const double before = written_bytes();
    state.ResumeTiming();
    EXPECTS(store.commit(change));
    state.PauseTiming();
    bytes += written_bytes() - before;
    state.ResumeTiming();
  }
  state.counters["written_MB"] = 1e-6 * bytes / static_cast<double>(state.iterations());
}
BENCHMARK(commit_world)->Arg(0)->Arg(5000)->Unit(benchmark::kMillisecond)->Iterations(30)->UseRealTime();

// Argument: keyframes of 1,000 features, with 100 landmarks each.
void open_and_load(benchmark::State& state) {
  const TempFolder folder;
  const auto file = folder.path() / "map.db";
  const int keyframes = static_cast<int>(state.range(0));
  {
    MapStore store = store_at(file);
    made::MapMaker maker({.keyframes = 30, .new_landmarks = 3000, .old_landmarks = 0, .share_removed = 0.0});
    for (int i = 0; i < keyframes / 30; ++i) EXPECTS(store.commit(maker.next()));
  }
  for (auto _ : state) {
    const auto opened = open_or_quarantine(file);
    EXPECTS(opened && static_cast<int>(opened->content.keyframes.size()) == keyframes);
  }
  state.counters["file_MB"] = 1e-6 * static_cast<double>(std::filesystem::file_size(file));
}
BENCHMARK(open_and_load)->Arg(300)->Arg(1200)->Unit(benchmark::kMillisecond)->UseRealTime();

// Closing after a commit: the log is brought into the file.
void close_store(benchmark::State& state) {
  const TempFolder folder;
  made::MapMaker maker({});
  for (auto _ : state) {
    state.PauseTiming();
    auto store = std::make_unique<MapStore>(store_at(folder.path() / "map.db"));
    for (int i = 0; i < 3; ++i) EXPECTS(store->commit(maker.next()));
    state.ResumeTiming();
    store.reset();
  }
}
BENCHMARK(close_store)->Unit(benchmark::kMillisecond)->Iterations(20)->UseRealTime();

}  // namespace
}  // namespace povslam

BENCHMARK_MAIN();
