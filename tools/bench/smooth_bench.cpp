// How long a local bundle adjustment takes on one core, by size of the window and share of outliers.
#include <benchmark/benchmark.h>

#include "pipeline/backend/smooth.hpp"
#include "tests/support/simulated_window.hpp"

namespace povslam {

namespace {

// Arguments: free poses (as many are fixed), points, observations, outliers [%].
void smooth_window(benchmark::State& state) {
  simulated::WindowOptions options;
  options.num_free = options.num_fixed = static_cast<int>(state.range(0));
  options.num_points = static_cast<int>(state.range(1));
  options.max_observations = static_cast<int>(state.range(2));
  options.share_outliers = 0.01 * static_cast<double>(state.range(3));
  const simulated::Window window = simulated::make_window(options);
  const SmoothProblem& asked = window.problem;
  SmoothProblem answer;
  for (auto _ : state) {
    state.PauseTiming();
    answer = asked;
    state.ResumeTiming();
    smooth(answer, SmoothOptions{});
  }
  state.counters["observations"] = static_cast<double>(asked.observations.size());
  state.counters["iterations"] = answer.iterations;
  state.counters["pose_error_mm"] = 1e3 * simulated::pose_error(window, answer)[0];
}

BENCHMARK(smooth_window)
    ->ArgNames({"free", "points", "observations", "outliers_pct"})
    ->Args({16, 4000, 25'000, 0})
    ->Args({16, 4000, 25'000, 5})
    ->Args({8, 1500, 8'000, 5})
    ->Args({40, 8000, 60'000, 5})
    ->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace povslam

BENCHMARK_MAIN();
