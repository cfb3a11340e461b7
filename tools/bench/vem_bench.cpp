// What 30 EM iterations cost on one core: the structured solver and Ceres interleaved in one process, and how the
// structured one grows with landmarks, objects and window (thread CPU time). And how many windows in space are solved.
#include <ctime>

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include "pipeline/backend/vem.hpp"
#include "tests/support/simulated_objects.hpp"
#include "tools/povslam/plot_axes.hpp"

namespace povslam {

namespace {

double cpu_s() {
  timespec now{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

double median(std::vector<double> values) {
  std::ranges::sort(values);
  return values[values.size() / 2];
}

simulated::ObjectsOptions problem(int landmarks, int objects, int frames) {
  simulated::ObjectsOptions options;
  options.num_landmarks = landmarks;
  options.num_objects = objects;
  options.num_moved = objects / 5;
  options.num_frames = frames;
  options.shift_min_m = 0.3;
  options.shift_max_m = 0.8;
  options.prior_sigma_m = 0.01;
  options.prior_sigma_rad = 0.0035;
  return options;
}

VemOptions options_of(VemSolver solver) {
  VemOptions options;
  options.solver = solver;
  options.max_iterations = 30;
  options.stop_m = -1.0;  // all 30
  options.other_starts = 0;
  return options;
}

struct Timed {
  double s = 0.0, without_setup_s = 0.0;
  VemResult result;
};

Timed run(Vem& vem, const VemWindow& window) {
  const double begin = cpu_s();
  Timed timed;
  timed.result = vem.solve(window);
  timed.s = cpu_s() - begin;
  double outside = 0.0;
  for (const VemIteration& iteration : timed.result.iterations) outside += iteration.preparation_s;
  timed.without_setup_s = timed.s - outside;
  return timed;
}

void compare(int rounds) {
  const VemWindow window = simulated::make_objects(problem(4000, 30, 8)).window;
  Vem structured(options_of(VemSolver::structured)), ceres(options_of(VemSolver::ceres));
  std::printf("4000 landmarks, 30 objects, window 8, %zu matches; 30 EM iterations, CPU ms\n", window.matches.size());
  std::printf("%6s %11s %10s %16s %8s %16s\n", "round", "structured", "Ceres", "without set-up", "ratio",
              "without set-up");
  std::vector<double> times, ratios, bare_ratios;
  for (int round = 0; round < rounds; ++round) {
    const Timed own = run(structured, window), reference = run(ceres, window);
    times.push_back(1e3 * own.s);
    ratios.push_back(reference.s / own.s);
    bare_ratios.push_back(reference.without_setup_s / own.s);
    std::printf("%6d %11.2f %10.0f %16.0f %8.0f %16.0f\n", round, 1e3 * own.s, 1e3 * reference.s,
                1e3 * reference.without_setup_s, ratios.back(), bare_ratios.back());
    const Rigid3 &a = own.result.poses.back(), &b = reference.result.poses.back();
    if (round == 0) std::printf("       current pose apart: %.1e\n", local(a, b).norm());
  }
  std::printf("median %11.2f %10s %16s %8.0f %16.0f\n\n", median(times), "", "", median(ratios), median(bare_ratios));
}

struct Series {
  std::string name, unit;
  std::vector<Eigen::Vector2d> points;  // size, ms
};

void measure(Series& series, int size, int landmarks, int objects, int frames) {
  const VemWindow window = simulated::make_objects(problem(landmarks, objects, frames)).window;
  Vem vem(options_of(VemSolver::structured));
  std::vector<double> times;
  for (int round = 0; round < 9; ++round) times.push_back(1e3 * run(vem, window).s);
  series.points.emplace_back(size, median(times));
  std::printf("%9d %7d %6d %9zu %8.2f %8.2f\n", landmarks, objects, frames, window.matches.size(),
              *std::ranges::min_element(times), median(times));
}

std::vector<Series> scale() {
  std::printf("structured, 30 EM iterations, CPU ms of 9 runs\n%9s %7s %6s %9s %8s %8s\n", "landmarks", "objects",
              "window", "matches", "min", "median");
  std::vector<Series> all(3);
  all[0] = {"landmarks (30 objects, window 8)", "landmarks", {}};
  for (const int n : {500, 1000, 2000, 4000, 8000, 16000, 32000}) measure(all[0], n, n, 30, 8);
  all[1] = {"objects (4000 landmarks, window 8)", "objects", {}};
  for (const int n : {5, 10, 30, 100, 300}) measure(all[1], n, 4000, n, 8);
  all[2] = {"window (4000 landmarks, 30 objects)", "frames", {}};
  for (const int n : {4, 6, 8, 12, 16}) measure(all[2], n, 4000, 30, n);
  return all;
}

Status plot(const std::string& file, const std::vector<Series>& all) {
  using drawing::Range;
  const bool svg = file.ends_with(".svg");
  const auto canvas = svg ? drawing::make_svg_canvas(1260, 420) : drawing::make_png_canvas(1260, 420);
  double left_px = 60.0;
  for (const Series& series : all) {
    std::vector<double> x{0.0}, y{0.0};
    for (const Eigen::Vector2d& point : series.points) {
      x.push_back(point.x());
      y.push_back(point.y());
    }
    drawing::Axes axes(*canvas, {left_px, 50}, {340, 300}, drawing::range_of(x, 1.0), drawing::range_of(y, 1.0));
    axes.draw_frame("ms by " + series.name, series.unit);
    axes.curve(series.points, {{40, 90, 200}, 2.0});
    for (const Eigen::Vector2d& point : series.points) axes.dot(point, 4.0, {40, 90, 200});
    left_px += 410.0;
  }
  return canvas->save(file);
}

// The whole window begins 0.3 m and 8 degrees off. Solved: each box told, each pose within 5 cm.
bool solves(simulated::ObjectsOptions options, double sigma_prior_m) {
  options.start_m = 0.3;
  options.start_rad = 0.14;
  const simulated::ObjectsWindow made = simulated::make_objects(options);
  VemOptions vem;
  vem.sigma_prior_m = sigma_prior_m;
  const VemResult result = Vem(vem).solve(made.window);
  bool right = true;
  for (std::size_t i = 0; i < made.moved.size(); ++i) {
    right = right && result.objects[i].accepted == (made.moved[i] == 0);
  }
  for (std::size_t t = 0; t < made.truth.size(); ++t) {
    right = right && (result.poses[t].translation - made.truth[t].translation).norm() < 0.05;
  }
  return right;
}

void count_solved(int seeds) {
  std::printf("\nwindows of 8 frames and 10 boxes solved, of %d\n%12s %12s %10s %10s\n", seeds, "sigma_prior",
              "moved by", "6 moved", "4 moved");
  for (const double sigma_prior_m : {0.05, VemOptions{}.sigma_prior_m}) {
    for (const auto& [low_m, high_m] : {std::pair{0.5, 1.5}, std::pair{0.8, 2.0}}) {
      int solved[2] = {0, 0};
      for (int i = 0; i < 2 * seeds; ++i) {
        simulated::ObjectsOptions options;
        options.num_moved = i % 2 == 0 ? 6 : 4;
        options.shift_min_m = low_m;
        options.shift_max_m = high_m;
        options.seed = static_cast<unsigned>(1 + i / 2);
        solved[i % 2] += solves(options, sigma_prior_m) ? 1 : 0;
      }
      std::printf("%10.2f m %5.1f-%3.1f m %10d %10d\n", sigma_prior_m, low_m, high_m, solved[0], solved[1]);
    }
  }
}

}  // namespace

}  // namespace povslam

int main(int argc, char** argv) {
  CLI::App app("Times the variational EM");
  int rounds = 5;
  int seeds = 200;
  std::string plot_file;
  app.add_option("--rounds", rounds, "of the comparison with Ceres; 0: none")->check(CLI::Range(0, 1000));
  app.add_option("--seeds", seeds, "windows to count the solved among; 0: none")->check(CLI::Range(0, 100000));
  app.add_option("--plot", plot_file, "the growth as a picture, .png or .svg");
  CLI11_PARSE(app, argc, argv);
  if (rounds > 0) povslam::compare(rounds);
  const auto series = povslam::scale();
  if (seeds > 0) povslam::count_solved(seeds);
  if (plot_file.empty()) return 0;
  const povslam::Status saved = povslam::plot(plot_file, series);
  if (!saved) std::fprintf(stderr, "%s\n", saved.error().message.c_str());
  return saved ? 0 : 1;
}
