// How long closing a loop takes on one core, by number of keyframes and edges of each.
#include <benchmark/benchmark.h>

#include "pipeline/backend/close_loop.hpp"
#include "tests/support/simulated_ring.hpp"

namespace povslam {

namespace {

// Arguments: poses, edges of each to its predecessors. A tenth of the poses is a second round over the first's places.
void close_ring(benchmark::State& state) {
  simulated::RingOptions options;
  options.num_poses = static_cast<int>(state.range(0));
  options.num_predecessors = static_cast<int>(state.range(1));
  options.poses_per_round = options.num_poses * 9 / 10;
  const simulated::Ring ring = simulated::make_ring(options);
  LoopProblem answer;
  for (auto _ : state) {
    state.PauseTiming();
    answer = ring.problem;
    state.ResumeTiming();
    close_loop(answer, CloseLoopOptions{});
  }
  state.counters["edges"] = static_cast<double>(ring.problem.edges.size());
  state.counters["iterations"] = answer.iterations;
  state.counters["converged"] = answer.converged ? 1.0 : 0.0;
  state.counters["drift_mm"] = 1e3 * simulated::worst_error_m(ring, ring.problem);
  state.counters["error_mm"] = 1e3 * simulated::worst_error_m(ring, answer);
}

BENCHMARK(close_ring)
    ->ArgNames({"poses", "edges"})
    ->Args({100, 25})
    ->Args({500, 8})
    ->Args({500, 25})
    ->Args({2000, 25})
    ->Args({5000, 8})
    ->Args({5000, 25})
    ->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace povslam

BENCHMARK_MAIN();
