// How well things are told apart, by depth alone or by classes and depth (--labels): views of simulated scenes,
// segmented, against the true instances.
//   segment_bench SCENE SEED… [--labels] [--every S] [--range M] [--min-pixels N] [--pictures FOLDER] [--list]
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <map>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <string>
#include <vector>

#include "pipeline/mapping/integrate.hpp"
#include "pipeline/objects/extract.hpp"
#include "pipeline/objects/segment.hpp"
#include "tools/bench/scene_views.hpp"

namespace povslam {
namespace {

struct BenchOptions {
  std::string scene, pictures;
  std::vector<std::uint64_t> seeds;
  double every_s = 1.0;
  float range_m = 5.0F;
  bool list = false;      // what matches no thing
  bool labels = false;    // told apart within the true classes
  int min_pixels = 2000;  // of a thing, measured within range, to be asked for
};

struct Tally {
  int things = 0, found = 0;
  double iou = 0.0;
};

struct Scores {
  std::map<std::string, Tally> things;        // by class
  std::map<std::string, int> segments;        // by the class most of their pixels show
  std::map<std::string, int> false_segments;  // that match no thing
  std::vector<double> ms;
  int views = 0;
};

double cpu_ms() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

bool is_movable(std::uint8_t class_id) {
  return std::string(synthetic::class_table()[class_id].kind) == "semi_static";
}

void fill_view(const RgbdFrame& frame, const PinholeCamera& camera, const Rigid3& T_world_camera, float range_m,
               DepthView& view) {
  view.stamp = frame.stamp;
  view.camera = camera;
  view.T_world_camera = T_world_camera;
  view.depth_m.resize(camera.width, camera.height);
  view.owner.resize(camera.width, camera.height);
  for (std::size_t i = 0; i < frame.depth.size(); ++i) {
    const float depth = static_cast<float>(frame.depth.data()[i]) / frame.depth_scale;
    view.depth_m.data()[i] = depth >= 0.3F && depth <= range_m ? depth : 0.0F;
  }
}

struct Overlap {
  std::map<std::pair<int, int>, int> both;  // (thing, segment) -> pixels
  std::map<int, int> thing, segment;
  std::map<int, std::uint8_t> class_of;                      // thing
  std::map<int, std::map<std::uint8_t, int>> classes_under;  // segment

  double iou(int t, int s) const {
    const auto it = both.find({t, s});
    if (it == both.end()) return 0.0;
    return static_cast<double>(it->second) / (thing.at(t) + segment.at(s) - it->second);
  }
};

Overlap overlap(const LabelFrame& truth, const ImageF& depth_m, const ImageU16& instances) {
  Overlap result;
  for (std::size_t i = 0; i < instances.size(); ++i) {
    if (depth_m.data()[i] <= 0.0F) continue;
    const std::uint8_t class_id = truth.classes.data()[i];
    const int thing = is_movable(class_id) ? truth.instances.data()[i] : 0;
    const int segment = instances.data()[i] >= kFirstInstance ? instances.data()[i] : 0;
    if (thing != 0) {
      ++result.thing[thing];
      result.class_of[thing] = class_id;
    }
    if (segment != 0) {
      ++result.segment[segment];
      ++result.classes_under[segment][class_id];
    }
    if (thing != 0 && segment != 0) ++result.both[{thing, segment}];
  }
  return result;
}

void score(const Overlap& seen, const std::vector<Segment>& segments, const BenchOptions& options, Scores& scores) {
  for (const auto& [thing, pixels] : seen.thing) {
    if (pixels < options.min_pixels) continue;
    double best = 0.0;
    for (const auto& [segment, count] : seen.segment) best = std::max(best, seen.iou(thing, segment));
    Tally& tally = scores.things[synthetic::class_table()[seen.class_of.at(thing)].name];
    ++tally.things;
    tally.found += best >= 0.5;
    tally.iou += best;
  }
  for (const auto& [segment, count] : seen.segment) {
    double best = 0.0;
    for (const auto& [thing, pixels] : seen.thing) best = std::max(best, seen.iou(thing, segment));
    const auto& under = seen.classes_under.at(segment);
    const auto most =
        std::max_element(under.begin(), under.end(), [](const auto& a, const auto& b) { return a.second < b.second; });
    const std::string name = synthetic::class_table()[most->first].name;
    ++scores.segments[name];
    scores.false_segments[name] += best < 0.5;
    if (!options.list || best >= 0.5) continue;
    const Segment& s = segments[static_cast<std::size_t>(segment - kFirstInstance)];
    std::printf("  view %d: no thing on %s: %d px, z %.2f to %.2f, %.2f x %.2f m, %.2f m2, own %.2f%s\n", scores.views,
                name.c_str(), s.pixels, s.bottom_m, s.top_m, s.length_m, s.width_m, s.area_m2, s.own_outline,
                s.at_border ? ", at border" : "");
  }
}

cv::Vec3b color_of(int id) {
  const auto hash = static_cast<unsigned>(id) * 2654435761U;
  return {static_cast<unsigned char>(64 + (hash >> 8) % 192), static_cast<unsigned char>(64 + (hash >> 16) % 192),
          static_cast<unsigned char>(64 + (hash >> 24) % 192)};
}

// Left: the truth of movable things; right: segments (structure dark, nobody black).
void draw(const RgbdFrame& frame, const LabelFrame* truth, const DepthView& view, const ImageU16& instances,
          const std::string& file) {
  const int width = view.camera.width, height = view.camera.height;
  cv::Mat picture(height, 2 * width, CV_8UC3);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const int channels = frame.color.channels();
      cv::Vec3b grey;
      for (int c = 0; c < 3; ++c) grey[c] = frame.color.at(x, y, channels == 3 ? 2 - c : 0);
      const int thing = truth != nullptr && is_movable(truth->classes.at(x, y)) ? truth->instances.at(x, y) : 0;
      const int instance = instances.at(x, y);
      cv::Vec3b left = grey, right(0, 0, 0);
      if (thing != 0) left = 0.5 * left + 0.5 * color_of(thing);
      if (instance == kStructure) right = 0.4 * grey;
      if (instance >= kFirstInstance) right = 0.4 * grey + 0.6 * color_of(instance);
      if (view.depth_m.at(x, y) <= 0.0F) right = cv::Vec3b(40, 0, 0);
      picture.at<cv::Vec3b>(y, x) = left;
      picture.at<cv::Vec3b>(y, width + x) = right;
    }
  }
  cv::imwrite(file, picture);
}

void label_segments(const std::vector<Segment>& segments, const std::string& file, const ImageU16& instances) {
  cv::Mat picture = cv::imread(file);
  for (std::size_t i = 0; i < segments.size(); ++i) {
    long sum_x = 0, sum_y = 0, count = 0;
    for (int y = 0; y < instances.height(); ++y) {
      for (int x = 0; x < instances.width(); ++x) {
        if (instances.at(x, y) != kFirstInstance + i) continue;
        sum_x += x;
        sum_y += y;
        ++count;
      }
    }
    if (count == 0) continue;
    const Segment& s = segments[i];
    char text[100];
    std::snprintf(text, sizeof text, "%.1f-%.1f o%.2f", s.bottom_m, s.top_m, s.own_outline);
    cv::putText(picture, text,
                cv::Point(static_cast<int>(sum_x / count) + instances.width() - 40, static_cast<int>(sum_y / count)),
                cv::FONT_HERSHEY_SIMPLEX, 0.35, cv::Scalar(255, 255, 255));
  }
  cv::imwrite(file, picture);
}

ClassTable true_classes() {
  ClassTable table;
  for (std::size_t i = 0; i < synthetic::class_table().size(); ++i) {
    const std::string kind = synthetic::class_table()[i].kind, name = synthetic::class_table()[i].name;
    const ClassKind ours = kind == "semi_static" ? ClassKind::semi_static
                           : kind == "structure" ? ClassKind::structure
                                                 : ClassKind::ignore;
    table.classes.push_back(make_class(static_cast<std::uint16_t>(i), name, ours));
    table.classes.back().one_piece = name == "pallet" || name == "forklift";
  }
  return table;
}

// As the object library would see them; segments carry nothing but their number.
std::vector<Segment> extract(Extractor& extractor, const LabelFrame& truth, DepthView& view, ImageU16& instances) {
  static const ClassTable table = true_classes();
  const Extraction& extraction = extractor.from_classes(truth.classes, table, view);
  instances = view.owner;
  return std::vector<Segment>(extraction.observations.size());
}

void run_scene(const BenchOptions& options, std::uint64_t seed, Scores& scores) {
  SceneViews views(options.scene, seed);
  const PinholeCamera camera = views.calibration().camera;
  SegmentOptions segment;
  segment.max_depth_m = static_cast<double>(options.range_m);
  Segmenter segmenter(camera, segment);
  Extractor extractor(ExtractOptions{}, IntegrateOptions{}.depth_sigma_quadratic_per_m);
  synthetic::Renderer renderer(views.world());
  RgbdFrame frame;
  LabelFrame truth;
  DepthView view;
  ImageU16 instances;
  int number = 0;
  for (double t = 0.0; t < views.lap_s(); t += options.every_s, ++number) {
    const Rigid3 T_world_camera = views.world().T_world_camera(t);
    renderer.render(T_world_camera, t, frame);
    renderer.label(truth);
    fill_view(frame, camera, T_world_camera, options.range_m, view);
    const double start = cpu_ms();
    const std::vector<Segment> segments =
        options.labels ? extract(extractor, truth, view, instances) : segmenter.segment(view, instances);
    scores.ms.push_back(cpu_ms() - start);
    ++scores.views;
    score(overlap(truth, view.depth_m, instances), segments, options, scores);
    if (options.pictures.empty()) continue;
    char name[100];
    std::snprintf(name, sizeof name, "/%s_%d_%03d.png", options.scene.c_str(), static_cast<int>(seed), number);
    draw(frame, &truth, view, instances, options.pictures + name);
    label_segments(segments, options.pictures + name, instances);
  }
}

void print(const BenchOptions& options, Scores& scores) {
  std::sort(scores.ms.begin(), scores.ms.end());
  std::printf("%s, seeds", options.scene.c_str());
  for (const std::uint64_t seed : options.seeds) std::printf(" %d", static_cast<int>(seed));
  std::printf(": %d views, %.1f ms median, %.1f ms 95 %%\n", scores.views, scores.ms[scores.ms.size() / 2],
              scores.ms[scores.ms.size() * 95 / 100]);
  Tally all;
  for (const auto& [name, tally] : scores.things) {
    std::printf("  %-10s %5d things, recall@0.5 %.3f, mean best IoU %.3f\n", name.c_str(), tally.things,
                static_cast<double>(tally.found) / tally.things, tally.iou / tally.things);
    all.things += tally.things;
    all.found += tally.found;
    all.iou += tally.iou;
  }
  std::printf("  all        %5d things, recall@0.5 %.3f, mean best IoU %.3f\n", all.things,
              static_cast<double>(all.found) / std::max(1, all.things), all.iou / std::max(1, all.things));
  int segments = 0, wrong = 0;
  for (const auto& [name, count] : scores.segments) {
    const int bad = scores.false_segments[name];
    std::printf("  segments on %-10s %5d, of no thing %5d\n", name.c_str(), count, bad);
    segments += count;
    wrong += bad;
  }
  std::printf("  segments %d, precision@0.5 %.3f\n", segments,
              1.0 - static_cast<double>(wrong) / std::max(1, segments));
}

BenchOptions parse(int argc, char** argv) {
  BenchOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--every" && has_value) {
      options.every_s = std::stod(argv[++i]);
    } else if (word == "--range" && has_value) {
      options.range_m = std::stof(argv[++i]);
    } else if (word == "--min-pixels" && has_value) {
      options.min_pixels = std::stoi(argv[++i]);
    } else if (word == "--pictures" && has_value) {
      options.pictures = argv[++i];
    } else if (word == "--labels") {
      options.labels = true;
    } else if (word == "--list") {
      options.list = true;
    } else if (options.scene.empty()) {
      options.scene = word;
    } else {
      options.seeds.push_back(std::stoull(word));
    }
  }
  return options;
}

int run(int argc, char** argv) {
  const BenchOptions options = parse(argc, argv);
  if (options.scene.empty() || options.seeds.empty() || options.every_s <= 0.0) {
    std::fprintf(
        stderr,
        "usage: segment_bench SCENE SEED… [--labels] [--every S] [--range M] [--min-pixels N] [--pictures DIR] "
        "[--list]\n");
    return 2;
  }
  Scores scores;
  for (const std::uint64_t seed : options.seeds) run_scene(options, seed, scores);
  print(options, scores);
  return 0;
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  return povslam::run(argc, argv);
}
