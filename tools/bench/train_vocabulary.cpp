// Makes the vocabulary of place recognition from simulated scenes and a recording: train_vocabulary --out FILE.
// The same arguments give the same bytes. What ships, and from what: docs/place_recognition.md.
#include <CLI/CLI.hpp>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdio>
#include <cstring>
#include <fstream>
#include <numeric>
#include <string>
#include <vector>

#include "drivers/synthetic/random.hpp"
#include "pipeline/frontend/frame.hpp"
#include "pipeline/frontend/vocabulary.hpp"
#include "tools/bench/scene_views.hpp"

namespace povslam {
namespace {

struct Arguments {
  std::string out;
  std::vector<std::string> scenes{"boxsim", "static", "aisle", "majority", "adversarial"};
  std::vector<std::string> recordings;  // FOLDER,CAMERA
  std::uint64_t first_seed = 1001;
  int seeds = 4;
  int views = 40;  // of a lap
  int every = 2;   // frame of a recording
  int copies = 1;  // how often a recording's looks count
  std::uint32_t branching = 10, levels = 4;
  int rounds = 12;
  std::uint64_t seed = 1;
};

struct Looks {
  std::vector<Descriptor> descriptors;
  std::vector<std::size_t> image_begin;  // into descriptors
  void add(const OrbFeatures& features) {
    image_begin.push_back(descriptors.size());
    descriptors.insert(descriptors.end(), features.descriptor.begin(), features.descriptor.begin() + features.size);
  }
};

// k-majority: as k-means, with Hamming distances, and each bit of a centre what most of its members have.
class TreeTrainer {
 public:
  TreeTrainer(const Arguments& arguments, const Looks& looks)
      : arguments_(arguments), looks_(looks), random_(arguments.seed), cluster_of_(looks.descriptors.size()) {}

  std::vector<Descriptor> train() {
    std::vector<std::uint32_t> all(looks_.descriptors.size());
    std::iota(all.begin(), all.end(), 0U);
    std::vector<std::vector<std::uint32_t>> groups{std::move(all)};
    std::vector<Descriptor> nodes;
    for (std::uint32_t level = 0; level < arguments_.levels; ++level) {
      std::vector<std::vector<std::uint32_t>> children;
      for (const auto& group : groups) {
        const std::vector<Descriptor> centres = split(group);
        nodes.insert(nodes.end(), centres.begin(), centres.end());
        const std::size_t first = children.size();
        children.resize(first + arguments_.branching);
        for (const std::uint32_t i : group) children[first + cluster_of_[i]].push_back(i);
      }
      groups = std::move(children);
    }
    return nodes;
  }

 private:
  const Descriptor& look(std::uint32_t i) const { return looks_.descriptors[i]; }

  // Far ones are likelier to become centres (k-means++, Arthur and Vassilvitskii 2007).
  std::vector<Descriptor> first_centres(const std::vector<std::uint32_t>& group) {
    std::vector<Descriptor> centres;
    std::vector<double> weight(group.size(), 1.0);
    while (centres.size() < arguments_.branching) {
      const double total = std::accumulate(weight.begin(), weight.end(), 0.0);
      if (total <= 0.0) break;
      double draw = random_.uniform() * total;
      std::size_t chosen = 0;
      while (chosen + 1 < group.size() && (draw -= weight[chosen]) > 0.0) ++chosen;
      if (weight[chosen] <= 0.0) continue;
      centres.push_back(look(group[chosen]));
      for (std::size_t i = 0; i < group.size(); ++i) {
        const double d = hamming_distance(look(group[i]), centres.back());
        weight[i] = centres.size() == 1 ? d * d : std::min(weight[i], d * d);
      }
    }
    return centres;
  }

  std::vector<Descriptor> split(const std::vector<std::uint32_t>& group) {
    std::vector<Descriptor> centres = first_centres(group);
    for (int round = 0; round < arguments_.rounds && !centres.empty(); ++round) {
      assign(group, centres);
      std::vector<std::array<std::uint32_t, 256>> ones(centres.size());
      std::vector<std::uint32_t> members(centres.size());
      for (const std::uint32_t i : group) {
        ++members[cluster_of_[i]];
        for (std::size_t bit = 0; bit < 256; ++bit) {
          ones[cluster_of_[i]][bit] += static_cast<std::uint32_t>(look(i)[bit / 64] >> (bit % 64) & 1U);
        }
      }
      bool changed = false;
      for (std::size_t c = 0; c < centres.size(); ++c) {
        if (members[c] == 0) continue;
        Descriptor majority{};
        for (std::size_t bit = 0; bit < 256; ++bit) {
          if (2 * ones[c][bit] > members[c]) majority[bit / 64] |= std::uint64_t{1} << (bit % 64);
        }
        changed = changed || majority != centres[c];
        centres[c] = majority;
      }
      if (!changed) break;
    }
    assign(group, centres);
    if (centres.empty()) centres.emplace_back();
    centres.resize(arguments_.branching, centres.front());
    return centres;
  }

  void assign(const std::vector<std::uint32_t>& group, const std::vector<Descriptor>& centres) {
    for (const std::uint32_t i : group) {
      cluster_of_[i] = static_cast<std::uint32_t>(
          nearest_descriptor(look(i), centres.data(), static_cast<int>(centres.size())).index);
    }
  }

  const Arguments& arguments_;
  const Looks& looks_;
  synthetic::Random random_;
  std::vector<std::uint32_t> cluster_of_;
};

// One lap of each world, looking a little to all sides.
void look_at_scenes(const Arguments& arguments, Looks& looks) {
  for (const std::string& scene : arguments.scenes) {
    for (int s = 0; s < arguments.seeds; ++s) {
      const std::uint64_t seed = arguments.first_seed + static_cast<std::uint64_t>(s);
      SceneViews views(scene, seed);
      const PinholeCamera camera = views.calibration().camera;
      FrameBuilder builder(camera, {});
      Frame frame(camera, {});
      synthetic::Random random(synthetic::mix(arguments.seed, seed));
      for (int v = 0; v < arguments.views; ++v) {
        const double time_s = views.lap_s() * (v + random.uniform()) / arguments.views;
        const Rigid3 step{so3_exp({random.uniform(-0.1, 0.1), random.uniform(-0.6, 0.6), random.uniform(-0.1, 0.1)}),
                          {random.uniform(-0.3, 0.3), random.uniform(-0.1, 0.1), random.uniform(-0.3, 0.3)}};
        builder.build(views.look(views.world().T_world_camera(time_s) * step, time_s), 1.0, frame);
        looks.add(frame.features);
      }
    }
  }
}

Status look_at_recordings(const Arguments& arguments, Looks& looks) {
  for (const std::string& recording : arguments.recordings) {
    const std::size_t comma = recording.rfind(',');
    if (comma == std::string::npos) return Error{"'" + recording + "' is not FOLDER,CAMERA"};
    std::unique_ptr<FrameBuilder> builder;
    std::unique_ptr<Frame> frame;
    int count = 0;
    const Status read = for_each_frame(recording.substr(0, comma), recording.substr(comma + 1),
                                       [&](const SensorCalibration& calibration, const RgbdFrame& image) {
                                         if (count++ % arguments.every != 0) return;
                                         if (!builder) {
                                           builder =
                                               std::make_unique<FrameBuilder>(calibration.camera, FrontendOptions{});
                                           frame = std::make_unique<Frame>(calibration.camera, FrontendOptions{});
                                         }
                                         builder->build(image, 1.0, *frame);
                                         for (int c = 0; c < arguments.copies; ++c) looks.add(frame->features);
                                       });
    if (!read) return read.error();
  }
  return Done{};
}

std::vector<std::byte> to_bytes(const Arguments& arguments, const std::vector<Descriptor>& nodes,
                                const std::vector<std::uint8_t>& surprise) {
  static_assert(std::endian::native == std::endian::little);
  std::vector<std::byte> bytes(sizeof(VocabularyHeader) + nodes.size() * sizeof(Descriptor) + surprise.size());
  std::byte* content = bytes.data() + sizeof(VocabularyHeader);
  std::memcpy(content, nodes.data(), nodes.size() * sizeof(Descriptor));
  std::memcpy(content + nodes.size() * sizeof(Descriptor), surprise.data(), surprise.size());
  const VocabularyHeader header{
      kVocabularyMagic, arguments.branching, arguments.levels,
      vocabulary_fingerprint(arguments.branching, arguments.levels, {content, bytes.data() + bytes.size()})};
  std::memcpy(bytes.data(), &header, sizeof header);
  return bytes;
}

// In how few images each word is.
std::vector<std::uint8_t> measure_surprise(const Vocabulary& vocabulary, const Looks& looks) {
  std::vector<std::uint32_t> images(vocabulary.num_words()), last(vocabulary.num_words(), ~0U);
  const std::size_t num_images = looks.image_begin.size();
  for (std::size_t image = 0; image < num_images; ++image) {
    const std::size_t end = image + 1 < num_images ? looks.image_begin[image + 1] : looks.descriptors.size();
    for (std::size_t i = looks.image_begin[image]; i < end; ++i) {
      const std::uint32_t word = vocabulary.word(looks.descriptors[i]);
      if (last[word] != image) ++images[word];
      last[word] = static_cast<std::uint32_t>(image);
    }
  }
  std::vector<std::uint8_t> surprise;
  int used = 0;
  for (const std::uint32_t holding : images) {
    used += holding > 0 ? 1 : 0;
    const double value = std::log(static_cast<double>(num_images) / std::max(0.5, static_cast<double>(holding)));
    surprise.push_back(static_cast<std::uint8_t>(std::clamp(value / kVocabularyStep, 0.0, 255.0)));
  }
  std::printf("%d of %zu words are used\n", used, images.size());
  return surprise;
}

Status train(const Arguments& arguments) {
  Looks looks;
  look_at_scenes(arguments, looks);
  const std::size_t simulated = looks.image_begin.size();
  if (const Status read = look_at_recordings(arguments, looks); !read) return read.error();
  std::printf("%zu images simulated, %zu recorded; %zu looks\n", simulated, looks.image_begin.size() - simulated,
              looks.descriptors.size());
  const std::vector<Descriptor> nodes = TreeTrainer(arguments, looks).train();
  std::uint32_t words = 1;
  for (std::uint32_t level = 0; level < arguments.levels; ++level) words *= arguments.branching;
  const auto bare = to_bytes(arguments, nodes, std::vector<std::uint8_t>(words));
  const auto vocabulary = Vocabulary::view(bare);
  if (!vocabulary) return vocabulary.error();
  const auto bytes = to_bytes(arguments, nodes, measure_surprise(*vocabulary, looks));
  std::ofstream file(arguments.out, std::ios::binary);
  file.write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
  if (!file.flush()) return Error{"cannot write '" + arguments.out + "'"};
  std::printf("%s: %zu bytes\n", arguments.out.c_str(), bytes.size());
  return Done{};
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  povslam::Arguments arguments;
  CLI::App cli{"Makes the vocabulary of place recognition.", "train_vocabulary"};
  cli.add_option("--out", arguments.out, "File to write")->required();
  cli.add_option("--scenes", arguments.scenes, "Simulated scenes")->capture_default_str();
  cli.add_option("--first-seed", arguments.first_seed, "Simulated worlds: the first…")->capture_default_str();
  cli.add_option("--seeds", arguments.seeds, "…and how many of each scene")->capture_default_str();
  cli.add_option("--views", arguments.views, "Images of a lap")->capture_default_str();
  cli.add_option("--recording", arguments.recordings, "FOLDER,CAMERA of a recording; may be given often");
  cli.add_option("--every", arguments.every, "Of its frames, each so many-th")->capture_default_str();
  cli.add_option("--copies", arguments.copies, "How often its looks count")->capture_default_str();
  cli.add_option("--branching", arguments.branching, "Children of a node")->capture_default_str();
  cli.add_option("--levels", arguments.levels, "Levels below the root")->capture_default_str();
  cli.add_option("--rounds", arguments.rounds, "Of k-majority, at most")->capture_default_str();
  cli.add_option("--seed", arguments.seed, "Of all draws")->capture_default_str();
  CLI11_PARSE(cli, argc, argv);
  if (const povslam::Status trained = povslam::train(arguments); !trained) {
    std::fprintf(stderr, "train_vocabulary: %s\n", trained.error().message.c_str());
    return 1;
  }
}
