// How well, and how fast, the index of places recognises views: place_bench [--sequence FOLDER --camera NAME].
// Simulated: keyframes along one lap, asked with views beside the path that look elsewhere. Recorded: each 20th frame,
// asked of keyframes that are others. Right is a keyframe that stands near and looks the same way.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <cstdio>
#include <fstream>
#include <string>
#include <vector>

#include "drivers/replay/trajectory_file.hpp"
#include "drivers/synthetic/random.hpp"
#include "pipeline/base/time.hpp"
#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/place_index.hpp"
#include "tools/bench/scene_views.hpp"

namespace povslam {
namespace {

struct Arguments {
  std::vector<std::string> scenes{"static", "aisle"};
  std::vector<std::uint64_t> seeds{1, 2, 3};
  std::string sequence, camera, vocabulary;
  int queries = 60;
};

constexpr double kNearM = 1.0, kNearRad = 0.5;  // of a keyframe that is right

struct View {
  Rigid3 T_world_camera;
  std::vector<std::uint32_t> words;
};

bool near(const Rigid3& a, const Rigid3& b, double radius_m) {
  const Rigid3 between = a.inverse() * b;
  return between.translation.norm() < radius_m && rotation_angle_rad(between) < kNearRad;
}

std::vector<std::uint32_t> words_of(const Vocabulary& vocabulary, const Frame& frame) {
  const std::size_t n = static_cast<std::size_t>(frame.size());
  std::vector<std::uint32_t> words(n);
  vocabulary.words({frame.features.descriptor.data(), n}, words);
  return words;
}

// Ranks of the first right answers. Keyframes near in the sequence to the query may be left out.
void score(const Vocabulary& vocabulary, const std::string& name, const std::vector<View>& keyframes,
           const std::vector<View>& queries, double radius_m) {
  PlaceIndex index(vocabulary, static_cast<int>(keyframes.size()) + 1, 1000);
  for (std::size_t k = 0; k < keyframes.size(); ++k) index.add(static_cast<std::int32_t>(k), keyframes[k].words);
  int asked = 0, first = 0, five = 0;
  double right_score = 0.0, wrong_score = 0.0;
  for (const View& query : queries) {
    const auto right = [&](std::int32_t slot) {
      return near(query.T_world_camera, keyframes[static_cast<std::size_t>(slot)].T_world_camera, radius_m);
    };
    bool any = false;
    for (std::size_t k = 0; k < keyframes.size(); ++k) any = any || right(static_cast<std::int32_t>(k));
    if (!any) continue;
    ++asked;
    index.query(query.words);
    int rank = 0;
    double best_right = 0.0, best_wrong = 0.0;
    for (int r = 1; auto c = index.next(); ++r) {
      double& best = right(c->keyframe) ? best_right : best_wrong;
      if (right(c->keyframe) && rank == 0) rank = r;
      if (best == 0.0) best = c->score;
    }
    first += rank == 1 ? 1 : 0;
    five += rank >= 1 && rank <= 5 ? 1 : 0;
    right_score += best_right;
    wrong_score += best_wrong;
  }
  std::printf("%-28s %5zu %6d %9.3f %9.3f %9.3f %9.3f\n", name.c_str(), keyframes.size(), asked,
              static_cast<double>(first) / std::max(asked, 1), static_cast<double>(five) / std::max(asked, 1),
              right_score / std::max(asked, 1), wrong_score / std::max(asked, 1));
}

void score_scene(const Arguments& arguments, const Vocabulary& vocabulary, const std::string& scene,
                 std::uint64_t seed) {
  SceneViews views(scene, seed);
  const PinholeCamera camera = views.calibration().camera;
  FrameBuilder builder(camera, {});
  Frame frame(camera, {});
  std::vector<View> keyframes, queries;
  synthetic::Random random(synthetic::mix(seed, 77));
  const auto see = [&](const Rigid3& T, double time_s) {
    builder.build(views.look(T, time_s), 1.0, frame);
    return View{T, words_of(vocabulary, frame)};
  };
  for (double t = 0.0; t < views.lap_s(); t += 0.7) keyframes.push_back(see(views.world().T_world_camera(t), t));
  for (int q = 0; q < arguments.queries; ++q) {
    const double t = random.uniform(0.0, views.lap_s());
    const Rigid3 beside{so3_exp({0.0, random.uniform(-0.35, 0.35), 0.0}),
                        {random.uniform(-0.4, 0.4), random.uniform(-0.1, 0.1), random.uniform(-0.4, 0.4)}};
    queries.push_back(see(views.world().T_world_camera(t) * beside, t));
  }
  score(vocabulary, scene + " " + std::to_string(seed), keyframes, queries, kNearM);
}

Status score_recording(const Arguments& arguments, const Vocabulary& vocabulary) {
  constexpr double kSequenceNearM = 0.5;
  const auto truth = read_trajectory(arguments.sequence + "/groundtruth.txt");
  if (!truth) return truth.error();
  std::unique_ptr<FrameBuilder> builder;
  std::unique_ptr<Frame> frame;
  std::vector<View> first_half, others, late, each20;
  int count = 0;
  const Status read = for_each_frame(
      arguments.sequence, arguments.camera, [&](const SensorCalibration& calibration, const RgbdFrame& image) {
        if (!builder) {
          builder = std::make_unique<FrameBuilder>(calibration.camera, FrontendOptions{});
          frame = std::make_unique<Frame>(calibration.camera, FrontendOptions{});
        }
        const int i = count++;
        const auto pose = pose_at(*truth, image.stamp, 0.1);
        if (!pose) return;
        builder->build(image, 1.0, *frame);
        const View view{*pose, words_of(vocabulary, *frame)};
        if (i < 200 && i % 5 == 0) first_half.push_back(view);
        if (i >= 200 && i % 5 == 0) late.push_back(view);
        if (i % 20 == 0) each20.push_back(view);
        if (i % 20 == 10) others.push_back(view);
      });
  if (!read) return read.error();
  score(vocabulary, "recording, each 20th", others, each20, kSequenceNearM);
  score(vocabulary, "recording, 2nd half of 1st", first_half, late, kSequenceNearM);
  return Done{};
}

// Words as frequent as in an aisle: keyframes of random mixtures of the scene's words.
void time_index(const Vocabulary& vocabulary) {
  constexpr int kKeyframes = 2000, kFeatures = 1000, kQueries = 50;
  SceneViews views("aisle", 5);
  const PinholeCamera camera = views.calibration().camera;
  FrameBuilder builder(camera, {});
  Frame frame(camera, {});
  std::vector<std::vector<std::uint32_t>> seen;
  TimeNs quantising = 0;
  for (double t = 0.0; t < views.lap_s(); t += 0.7) {
    builder.build(views.look(views.world().T_world_camera(t), t), 1.0, frame);
    const TimeNs begun = thread_cpu_now();
    seen.push_back(words_of(vocabulary, frame));
    quantising += thread_cpu_now() - begun;
  }
  PlaceIndex index(vocabulary, kKeyframes, kFeatures);
  synthetic::Random random(1);
  std::vector<std::uint32_t> words;
  const auto mixture = [&] {
    words.clear();
    const auto& some = seen[static_cast<std::size_t>(random.below(static_cast<int>(seen.size())))];
    while (words.size() < kFeatures) {
      const auto& other = seen[static_cast<std::size_t>(random.below(static_cast<int>(seen.size())))];
      const auto& from = random.chance(0.5) ? some : other;
      words.push_back(from[static_cast<std::size_t>(random.below(static_cast<int>(from.size())))]);
    }
  };
  const TimeNs begun = thread_cpu_now();
  for (std::int32_t slot = 0; slot < kKeyframes; ++slot) {
    mixture();
    index.add(slot, words);
  }
  const TimeNs filled = thread_cpu_now();
  for (std::int32_t slot = 0; slot < kKeyframes; slot += 4) index.remove(slot);
  const TimeNs removed = thread_cpu_now();
  for (std::int32_t slot = 0; slot < kKeyframes; slot += 4) {
    mixture();
    index.add(slot, words);
  }
  std::vector<double> ms;
  for (int q = 0; q < kQueries; ++q) {
    mixture();
    const TimeNs asked = thread_cpu_now();
    index.query(words);
    for (int k = 0; k < 10; ++k) static_cast<void>(index.next());
    ms.push_back(to_ms(thread_cpu_now() - asked));
  }
  std::ranges::sort(ms);
  std::printf(
      "\n%d keyframes of %d words: query and ten answers %.3f ms (median), %.3f ms (most); add %.3f ms, remove "
      "%.3f ms; words of a frame %.3f ms\n",
      kKeyframes, kFeatures, ms[ms.size() / 2], ms.back(), to_ms(filled - begun) / kKeyframes,
      to_ms(removed - filled) / (kKeyframes / 4), to_ms(quantising) / static_cast<double>(seen.size()));
}

int run(const Arguments& arguments) {
  std::vector<std::uint64_t> storage;
  const TimeNs begun = monotonic_now();
  const Vocabulary* vocabulary = &Vocabulary::shipped();
  std::printf("shipped vocabulary ready after %.3f ms\n", to_ms(monotonic_now() - begun));
  Result<Vocabulary> other = *vocabulary;
  if (!arguments.vocabulary.empty()) {
    std::ifstream file(arguments.vocabulary, std::ios::binary | std::ios::ate);
    const auto size = static_cast<std::size_t>(std::max<std::streamoff>(0, file.tellg()));
    storage.resize(size / 8 + 1);
    file.seekg(0).read(reinterpret_cast<char*>(storage.data()), static_cast<std::streamsize>(size));
    other = Vocabulary::view(std::as_bytes(std::span(storage)).first(size));
    if (!other) {
      std::fprintf(stderr, "place_bench: %s: %s\n", arguments.vocabulary.c_str(), other.error().message.c_str());
      return 1;
    }
    vocabulary = &*other;
  }
  std::printf("%u words\n%-28s %5s %6s %9s %9s %9s %9s\n", vocabulary->num_words(), "views", "keyf.", "asked",
              "recall@1", "recall@5", "right", "wrong");
  for (const std::string& scene : arguments.scenes) {
    for (const std::uint64_t seed : arguments.seeds) score_scene(arguments, *vocabulary, scene, seed);
  }
  if (!arguments.sequence.empty()) {
    if (const Status scored = score_recording(arguments, *vocabulary); !scored) {
      std::fprintf(stderr, "place_bench: %s\n", scored.error().message.c_str());
      return 1;
    }
  }
  time_index(*vocabulary);
  return 0;
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  CLI::App cli{"How well, and how fast, the index of places recognises views.", "place_bench"};
  cli.add_option("--scenes", arguments.scenes, "Simulated scenes")->capture_default_str();
  cli.add_option("--seeds", arguments.seeds, "Simulated worlds")->capture_default_str();
  cli.add_option("--queries", arguments.queries, "Views asked of each")->capture_default_str();
  cli.add_option("--sequence", arguments.sequence, "Recorded sequence with groundtruth.txt");
  cli.add_option("--camera", arguments.camera, "Camera preset of the sequence");
  cli.add_option("--vocabulary", arguments.vocabulary, "Another vocabulary than what ships");
  CLI11_PARSE(cli, argc, argv);
  return povslam::run(arguments);
}
