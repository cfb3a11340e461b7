// CPU of bringing 640x480 views of a simulated room into a volume, at 5 and 2 cm; and of what else works on volumes.
//   tsdf_bench [ROUNDS [SCENE]]
// Beside Open3D's VoxelBlockGrid where that is installed (Debian: apt-get install libopen3d-dev, then configure anew;
// nothing else needs it): the same frames, voxels and truncation, in turns within one process; the distances compared.
// Its threads count, too: OMP_NUM_THREADS=1 keeps it to one.
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <functional>
#include <string>
#include <vector>

#include "drivers/synthetic/renderer.hpp"
#include "pipeline/mapping/compare.hpp"
#include "pipeline/mapping/empty_space.hpp"
#include "pipeline/mapping/integrate.hpp"
#include "pipeline/mapping/mesh.hpp"
#ifdef POVSLAM_OPEN3D
#include "tools/bench/open3d_volume.hpp"
#endif

namespace povslam {
namespace {

constexpr int kFrames = 20;

double cpu_ms() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return 1e3 * static_cast<double>(now.tv_sec) + 1e-6 * static_cast<double>(now.tv_nsec);
}

struct Times {
  std::vector<double> ms;
  template <class Work>
  double measure(const Work& work) {
    const double start = cpu_ms();
    work();
    ms.push_back(cpu_ms() - start);
    return ms.back();
  }
  double quantile(double share) {
    if (ms.empty()) return 0.0;
    std::sort(ms.begin(), ms.end());
    return ms[static_cast<std::size_t>(share * static_cast<double>(ms.size() - 1) + 0.5)];
  }
  std::string text() {
    char line[64];
    std::snprintf(line, sizeof line, "%7.2f %7.2f", quantile(0.5), quantile(0.0));
    return line;
  }
};

struct Frame {
  RgbdFrame rgbd;
  DepthView view;
};

std::vector<Frame> make_frames(const std::string& scene, Times& build_times) {
  synthetic::SyntheticOptions options;
  options.scene = scene;
  Result<synthetic::World> world = synthetic::World::create(options);
  if (!world) {
    std::fprintf(stderr, "tsdf_bench: %s\n", world.error().message.c_str());
    std::exit(1);
  }
  synthetic::Renderer renderer(*world);
  const DepthViewBuilder builder(options.camera, {.min_depth_m = 0.0, .max_depth_m = 6.0});
  std::vector<Frame> frames(kFrames);
  double time_s = 0.0;
  for (Frame& frame : frames) {
    renderer.render_at(time_s, frame.rgbd);
    build_times.measure([&] { builder.build(frame.rgbd, world->T_world_camera(time_s), frame.view); });
    frame.view.owner.fill(kStructure);
    time_s += 0.5;
  }
  return frames;
}

#ifdef POVSLAM_OPEN3D
// Its voxels lie at whole multiples of their size, ours in the middle between.
Rigid3 half_a_voxel(const VolumeOptions& options) {
  return {Eigen::Quaterniond::Identity(), Eigen::Vector3d::Constant(-0.5 * options.voxel_size_m)};
}

struct Differences {
  std::int64_t ours = 0, theirs = 0, both = 0;
  std::vector<double> of_m;

  void add(const Volume& volume, Open3dVolume& other) {
    for (int k = 0; k < volume.num_blocks(); ++k) {
      for (const std::uint16_t weight : volume.block(k).weight) ours += weight > 0;
    }
    for (const Open3dVolume::Block& block : other.blocks()) {
      const int index = volume.find(block.key);
      for (std::size_t k = 0; k < kBlockVoxels; ++k) {
        if (block.weight[k] == 0.0F) continue;
        ++theirs;
        if (index < 0 || volume.block(index).weight[k] == 0) continue;
        ++both;
        const double own = volume.block(index).distance[k] / static_cast<double>(kDistanceUnits);
        of_m.push_back(std::abs(own - static_cast<double>(block.distance[k])) * volume.options().truncation_m);
      }
    }
  }
  void print(const char* what) {
    double sum = 0.0;
    for (const double m : of_m) sum += m;
    std::sort(of_m.begin(), of_m.end());
    const auto count = static_cast<double>(of_m.size());
    const auto at_mm = [&](double share) { return 1e3 * of_m[static_cast<std::size_t>(share * (count - 1.0))]; };
    std::printf(
        "  %-16s voxels: ours %lld, theirs %lld, of theirs %.2f %% in both; distances differ by mean %.3f mm, "
        "median %.4f, p99 %.3f\n",
        what, static_cast<long long>(ours), static_cast<long long>(theirs),
        100.0 * static_cast<double>(both) / static_cast<double>(theirs), 1e3 * sum / count, at_mm(0.5), at_mm(0.99));
  }
};

void compare_distances(const std::vector<Frame>& frames, const VolumeOptions& options) {
  Differences single, all;
  Volume volume(options);
  Open3dVolume other(options, false);
  for (const Frame& frame : frames) {
    const auto theirs = Open3dVolume::frame(frame.rgbd, frame.view);
    Volume fresh(options);
    Open3dVolume fresh_other(options, false);
    integrate(fresh, frame.view, kStructure, half_a_voxel(options), {});
    fresh_other.integrate(theirs);
    single.add(fresh, fresh_other);
    integrate(volume, frame.view, kStructure, half_a_voxel(options), {});
    other.integrate(theirs);
  }
  all.add(volume, other);
  single.print("each frame alone");
  all.print("all frames");
}

void beside_open3d(std::vector<Frame>& frames, const VolumeOptions& options, int rounds, bool color) {
  std::vector<double> ratios;
  Times own, theirs;
  std::vector<Open3dVolume::Frame> inputs;
  for (Frame& frame : frames) {
    inputs.push_back(Open3dVolume::frame(frame.rgbd, frame.view));
    frame.view.color = color ? frame.rgbd.color : ImageU8();
  }
  for (int round = 0; round < rounds; ++round) {
    Volume volume(options);
    Open3dVolume other(options, color);
    double own_ms = 0.0, other_ms = 0.0;
    for (std::size_t k = 0; k < frames.size(); ++k) {
      own_ms += own.measure([&] { integrate(volume, frames[k].view, kStructure, half_a_voxel(options), {}); });
      other_ms += theirs.measure([&] { other.integrate(inputs[k]); });
    }
    ratios.push_back(other_ms / own_ms);
  }
  std::sort(ratios.begin(), ratios.end());
  std::printf("  %-12s ours %s ms   Open3D %s ms   ratio of rounds: %.1f (%.1f to %.1f)\n",
              color ? "with colour" : "no colour", own.text().c_str(), theirs.text().c_str(), ratios[ratios.size() / 2],
              ratios.front(), ratios.back());
}
#endif

void own_parts(const std::vector<Frame>& frames, const VolumeOptions& options, int rounds) {
  Times integrate_times, mesh_times, mesh_block_times, compare_times, points_times, look_times;
  IntegrateReport report;
  int blocks = 0, meshed = 0, made = 0;
  std::size_t triangles = 0, points = 0;
  for (int round = 0; round < rounds; ++round) {
    Volume volume(options);
    MeshCache cache;
    for (const Frame& frame : frames) {
      integrate_times.measure([&] { report = integrate(volume, frame.view, kStructure, {}, {}); });
      blocks += report.blocks_in_view;
      mesh_times.measure([&] { made = cache.update(volume); });
      meshed += made;
      if (made > 0) mesh_block_times.ms.push_back(1e3 * mesh_times.ms.back() / made);
      compare_times.measure([&] { povslam::compare_distances(volume, frame.view, {}); });
    }
    std::vector<SurfacePoint> surface;
    points_times.measure([&] { surface = surface_points(volume, 0.1); });
    points = surface.size();
    look_times.measure([&] { look_at(surface, frames.back().view, {}, 0.05); });
    Mesh mesh;
    cache.append_to(mesh, {});
    triangles = mesh.triangles.size();
  }
  const int looks = rounds * static_cast<int>(frames.size());
  std::printf("  integrate          %s ms   %d blocks = %d voxels a view\n", integrate_times.text().c_str(),
              blocks / looks, blocks / looks * kBlockVoxels);
  std::printf("  mesh update        %s ms   %d blocks a view, %.1f us each; %zu triangles in the end\n",
              mesh_times.text().c_str(), meshed / looks, mesh_block_times.quantile(0.5), triangles);
  std::printf("  compare_distances  %s ms\n", compare_times.text().c_str());
  std::printf("  surface_points     %s ms   %zu points\n", points_times.text().c_str(), points);
  std::printf("  look_at            %s ms   of all of them\n", look_times.text().c_str());
}

int run(int rounds, const std::string& scene) {
  Times build_times, empty_times;
  std::vector<Frame> frames = make_frames(scene, build_times);
  EmptySpace space({});
  for (const Frame& frame : frames) empty_times.measure([&] { space.observe(frame.view); });
  std::printf("CPU ms, median and least, of %d views 640x480 of %s, %d rounds\n", kFrames, scene.c_str(), rounds);
  std::printf("depth view           %s ms\n", build_times.text().c_str());
  std::printf("empty space          %s ms   %d cells in the end\n", empty_times.text().c_str(), space.num_cells());
  for (const double voxel_m : {0.05, 0.02}) {
    const VolumeOptions options{.voxel_size_m = voxel_m, .truncation_m = 4.0 * voxel_m, .max_blocks = 60000};
    std::printf("voxels of %.0f cm, truncation %.0f cm\n", 100.0 * voxel_m, 400.0 * voxel_m);
    own_parts(frames, options, rounds);
#ifdef POVSLAM_OPEN3D
    for (const bool color : {true, false}) beside_open3d(frames, options, rounds, color);
    compare_distances(frames, options);
#else
    std::printf("  built without Open3D: no comparison\n");
#endif
  }
  return 0;
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  const int rounds = argc > 1 ? std::atoi(argv[1]) : 5;
  if (rounds < 1) {
    std::fprintf(stderr, "usage: tsdf_bench [ROUNDS [SCENE]]\n");
    return 2;
  }
  return povslam::run(rounds, argc > 2 ? argv[2] : "rooms");
}
