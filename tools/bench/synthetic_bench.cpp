// CPU of the simulated camera: what a feeder costs beside the program that is measured.
#include <benchmark/benchmark.h>

#include "drivers/synthetic/renderer.hpp"

namespace povslam::synthetic {

namespace {

void render_scene(benchmark::State& state, const char* scene, bool blur) {
  SyntheticOptions options;
  options.scene = scene;
  options.blur = blur;
  const Result<World> world = World::create(options);
  if (!world) return state.SkipWithError(world.error().message.c_str());
  Renderer renderer(*world);
  RgbdFrame frame;
  double time_s = 0.0;
  for (auto step : state) {
    renderer.render_at(time_s, frame);
    benchmark::DoNotOptimize(frame.depth.data());
    time_s += 0.37;
  }
}

void create_world(benchmark::State& state, const char* scene) {
  SyntheticOptions options;
  options.scene = scene;
  for (auto step : state) benchmark::DoNotOptimize(World::create(options));
}

BENCHMARK_CAPTURE(render_scene, boxsim, "boxsim", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, aisle, "aisle", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, twins, "twins", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, rooms, "rooms", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, hall, "hall", false)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, boxsim_blur, "boxsim", true)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(create_world, boxsim, "boxsim")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(create_world, aisle, "aisle")->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(create_world, hall, "hall")->Unit(benchmark::kMillisecond);

}  // namespace

}  // namespace povslam::synthetic

BENCHMARK_MAIN();
