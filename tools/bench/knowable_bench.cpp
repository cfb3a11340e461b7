// What can be known of the boxes of things at all: along a drive through a simulated scene, with true poses, true
// instances and depth without noise, how much of each thing's box its visible surface spans.
//   knowable_bench SCENE SEED… [--every S] [--range M] [--views N] [--list]
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <unordered_map>
#include <vector>

#include "tools/bench/scene_views.hpp"
#include "tools/povslam/scores/oriented_box.hpp"

namespace povslam {
namespace {

constexpr double kCell_m = 0.02;
constexpr double kLeastShare = 0.0005;  // of an image's pixels: as the scores ask for things

struct BenchOptions {
  std::string scene;
  std::vector<std::uint64_t> seeds;
  double every_s = 0.2;  // as the daemon looks
  double range_m = 6.0;
  int views = 3;  // that must have measured a cell of the surface
  bool list = false;
};

struct Cell {
  int views = 0, last_view = -1;
  Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = Eigen::Array3d::Constant(-1e9);  // object frame
};

struct Seen {
  std::unordered_map<std::uint64_t, Cell> cells;
  int frames = 0;  // in which it is large enough to be asked for
  double nearest_m = 1e9;
};

std::uint64_t cell_of(int face, const Eigen::Vector3d& p_object) {
  auto key = static_cast<std::uint64_t>(face);
  for (const double v : {p_object.x(), p_object.y(), p_object.z()})
    key = key << 16 | (static_cast<std::uint64_t>(static_cast<std::int64_t>(std::floor(v / kCell_m))) & 0xFFFF);
  return key;
}

struct Known {
  scores::OrientedBox visible, assumed;  // object frame: what was seen, and with a depth where no side behind was
  std::array<int, 6> sides{};            // cells that face +x -x +y -y +z -z
};

// The visible surface's extent. Of a thing seen on one of two opposite sides only the depth is not known.
std::optional<Known> known_of(const Seen& seen, int views) {
  Known out;
  Eigen::Array3d low = Eigen::Array3d::Constant(1e9), high = -low;
  for (const auto& [key, cell] : seen.cells) {
    if (cell.views < views) continue;
    ++out.sides[key >> 48];
    low = low.min(cell.low), high = high.max(cell.high);
  }
  if (!(high >= low).all()) return std::nullopt;
  out.visible = {(0.5 * (low + high)).matrix(), (high - low).matrix(), 0.0};
  return out;
}

// Grows along its depth away from the side seen, to depth_m.
scores::OrientedBox with_depth(const Known& known, double depth_m) {
  scores::OrientedBox box = known.visible;
  for (const int axis : {0, 1}) {
    const bool plus = known.sides[2 * axis] > 0, minus = known.sides[2 * axis + 1] > 0;
    const double more = depth_m - box.size_m[axis];
    if (plus == minus || more <= 0.0 || box.size_m[axis] > box.size_m[1 - axis]) continue;
    box.size_m[axis] += more;
    box.center_world[axis] += plus ? -0.5 * more : 0.5 * more;
  }
  return box;
}

class Drive {
 public:
  Drive(const BenchOptions& options, std::uint64_t seed) : options_(options), views_(options.scene, seed) {}

  void look_around() {
    const synthetic::World& world = views_.world();
    synthetic::Renderer renderer(world);
    RgbdFrame frame;
    const double end_s = world.lap_end_s(world.options().laps);
    for (double t = 0.0; t < end_s; t += options_.every_s, ++view_) {
      renderer.render(world.T_world_camera(t), t, frame);
      add(renderer, frame, t);
    }
  }

  // Its view of each thing that stands at the end and was seen often enough to be asked for.
  template <class Take>
  void each_thing(const Take& take) const {
    const auto frames = static_cast<int>(10.0 / (views_.world().options().fps * 0.5 * options_.every_s));
    for (const auto& [index, seen] : seen_) {
      const synthetic::Object& object = views_.world().scene().objects[static_cast<std::size_t>(index)];
      if (object.after.present && seen.frames >= std::max(1, frames)) take(object, seen);
    }
  }

 private:
  void add(const synthetic::Renderer& renderer, const RgbdFrame& frame, double time_s) {
    const PinholeCamera camera = views_.calibration().camera;
    const Rigid3 T_world_camera = views_.world().T_world_camera(time_s);
    std::map<int, int> pixels;
    for (int y = 0; y < camera.height; ++y) {
      for (int x = 0; x < camera.width; ++x) {
        const std::int32_t hit = renderer.raster().hit().at(x, y);
        if (hit < synthetic::Raster::kFirstFace) continue;
        const synthetic::ProjectedFace& face =
            renderer.faces()[static_cast<std::size_t>(hit - synthetic::Raster::kFirstFace)];
        const synthetic::Object& object = views_.world().scene().objects[static_cast<std::size_t>(face.object)];
        const std::string kind = synthetic::class_table()[static_cast<std::size_t>(object.class_id)].kind;
        if (kind != "semi_static") continue;
        const bool changed = object.change() != synthetic::Change::unchanged;
        if (changed && time_s < object.switch_time_s) continue;
        ++pixels[face.object];
        const double z = 1.0 / static_cast<double>(renderer.raster().inverse_depth().at(x, y));
        if (frame.depth.at(x, y) == 0 || z > options_.range_m) continue;
        const Eigen::Vector3d p_world = T_world_camera * (camera.unproject({x, y}) * z);
        note(object, face, p_world, z);
      }
    }
    for (const auto& [index, count] : pixels) {
      if (count >= kLeastShare * camera.width * camera.height) ++seen_[index].frames;
    }
  }

  void note(const synthetic::Object& object, const synthetic::ProjectedFace& face, const Eigen::Vector3d& p_world,
            double z) {
    const synthetic::Placement place = object.at(1e9);
    const Eigen::Vector3d p_object =
        Eigen::AngleAxisd(-place.yaw, Eigen::Vector3d::UnitZ()) * (p_world - place.position);
    Seen& seen = seen_[face.object];
    Cell& cell = seen.cells[cell_of(face.surface % synthetic::kFacesPerPart, p_object)];
    if (cell.last_view != view_) ++cell.views;
    cell.last_view = view_;
    cell.low = cell.low.min(p_object.array()), cell.high = cell.high.max(p_object.array());
    seen.nearest_m = std::min(seen.nearest_m, z);
  }

  BenchOptions options_;
  SceneViews views_;
  int view_ = 0;
  std::map<int, Seen> seen_;  // by index of the object
};

struct Tally {
  int things = 0, visible = 0, assumed = 0, narrow = 0, low = 0;
};

void list(const synthetic::Object& object, const Seen& seen, const Known& known, double iou) {
  const Eigen::Vector3d share = known.visible.size_m.cwiseQuotient(object.size_m);
  std::printf("  %3d %-8s at %6.2f %6.2f %5.2f, %d frames, from %.1f m: spans %.2f %.2f %.2f, IoU %.2f\n", object.id,
              synthetic::class_name(object.class_id), object.after.position.x(), object.after.position.y(),
              object.after.position.z(), seen.frames, seen.nearest_m, share.x(), share.y(), share.z(), iou);
}

// What is assumed of things of a class: as deep as half of them are.
std::map<std::string, double> depths_of(const Drive& drive) {
  std::map<std::string, std::vector<double>> all;
  drive.each_thing([&](const synthetic::Object& object, const Seen&) {
    all[synthetic::class_name(object.class_id)].push_back(object.size_m.head<2>().minCoeff());
  });
  std::map<std::string, double> out;
  for (auto& [name, depths] : all) {
    std::ranges::sort(depths);
    out[name] = depths[depths.size() / 2];
  }
  return out;
}

void judge(const Drive& drive, const BenchOptions& options, std::map<std::string, Tally>& tallies) {
  std::map<std::string, double> depth_m = depths_of(drive);
  drive.each_thing([&](const synthetic::Object& object, const Seen& seen) {
    const std::string name = synthetic::class_name(object.class_id);
    Tally& tally = tallies[name];
    ++tally.things;
    const scores::OrientedBox truth{Eigen::Vector3d::Zero(), object.size_m, 0.0};
    const std::optional<Known> known = known_of(seen, options.views);
    const double iou = known ? scores::box_iou(truth, with_depth(*known, depth_m[name])) : 0.0;
    tally.visible += known && scores::box_iou(truth, known->visible) >= 0.5 ? 1 : 0;
    tally.assumed += iou >= 0.5 ? 1 : 0;
    if (options.list && iou < 0.6) list(object, seen, known.value_or(Known{}), iou);
  });
}

BenchOptions parse(int argc, char** argv) {
  BenchOptions options;
  for (int i = 1; i < argc; ++i) {
    const std::string word = argv[i];
    const bool has_value = i + 1 < argc;
    if (word == "--every" && has_value) {
      options.every_s = std::stod(argv[++i]);
    } else if (word == "--range" && has_value) {
      options.range_m = std::stod(argv[++i]);
    } else if (word == "--views" && has_value) {
      options.views = std::stoi(argv[++i]);
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
    std::fprintf(stderr, "usage: knowable_bench SCENE SEED… [--every S] [--range M] [--views N] [--list]\n");
    return 2;
  }
  for (const std::uint64_t seed : options.seeds) {
    Drive drive(options, seed);
    drive.look_around();
    std::map<std::string, Tally> tallies;
    judge(drive, options, tallies);
    Tally all;
    std::printf("%s %d: things, IoU 0.5 by what was visible alone, with a depth assumed\n", options.scene.c_str(),
                static_cast<int>(seed));
    for (const auto& [name, tally] : tallies) {
      std::printf("  %-10s %5d %5d %5d\n", name.c_str(), tally.things, tally.visible, tally.assumed);
      all.things += tally.things, all.visible += tally.visible, all.assumed += tally.assumed;
    }
    std::printf("  %-10s %5d %5d %5d, recall %.3f\n", "all", all.things, all.visible, all.assumed,
                static_cast<double>(all.assumed) / std::max(1, all.things));
  }
  return 0;
}

}  // namespace
}  // namespace povslam

int main(int argc, char** argv) {
  return povslam::run(argc, argv);
}
