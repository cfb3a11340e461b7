#include "pipeline/objects/extract.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <unordered_set>

#include "pipeline/objects/box_fit.hpp"
#include "pipeline/objects/components.hpp"
#include "pipeline/objects/find_fences.hpp"
#include "pipeline/objects/grooves.hpp"

namespace povslam {
namespace {

constexpr std::size_t kClassIds = 256;
constexpr double kBoxTrim = 0.01;

// What a class id of a label image stands for here.
enum class Part : std::uint8_t { nothing, structure, moving, thing };

std::array<Part, kClassIds> parts_of(const ClassTable& table) {
  std::array<Part, kClassIds> parts{};
  for (const ObjectClass& row : table.classes) {
    if (row.id >= kClassIds) continue;
    if (row.kind == ClassKind::structure) parts[row.id] = Part::structure;
    if (row.kind == ClassKind::dynamic) parts[row.id] = Part::moving;
    if (row.kind == ClassKind::static_object || row.kind == ClassKind::semi_static) parts[row.id] = Part::thing;
  }
  return parts;
}

std::int64_t key_of(const Eigen::Vector3d& p, double spacing_m) {
  const auto index = [&](double v) { return static_cast<std::int64_t>(std::floor(v / spacing_m)) & 0x1FFFFF; };
  return index(p.x()) | (index(p.y()) << 21) | (index(p.z()) << 42);
}

}  // namespace

struct Extractor::Impl {
  Impl(const ExtractOptions& its_options, double depth_sigma_quadratic_per_m)
      : options(its_options), sigma_quadratic(depth_sigma_quadratic_per_m), grooves(depth_sigma_quadratic_per_m) {}

  ExtractOptions options;
  double sigma_quadratic;
  ComponentFinder finder;
  GrooveFinder grooves;
  ImageU16 separable;  // pixels of classes whose things grooves separate, by class
  ImageU8 groove;      // empty: none are looked for
  ImageU16 value;      // per cell of 2 x 2 pixels: what must be equal within a component; 0: none
  ImageF depth;        // per cell
  Extraction result;

  template <class Value>
  bool uniform(const Image<Value>& image, int x, int y) const {
    const Value here = image.at(x, y);
    const int r = options.erode_px;
    const auto same = [&](int i, int j) {
      return i < 0 || j < 0 || i >= image.width() || j >= image.height() || image.at(i, j) == here;
    };
    return same(x - r, y) && same(x + r, y) && same(x, y - r) && same(x, y + r);
  }

  void find_grooves(const ImageU8& classes, const ClassTable& table, const DepthView& view) {
    std::array<bool, kClassIds> is_separable{};
    for (const ObjectClass& row : table.classes) {
      const bool thing = row.kind == ClassKind::static_object || row.kind == ClassKind::semi_static;
      if (row.id < kClassIds) is_separable[row.id] = thing && !row.one_piece;
    }
    separable.resize(classes.width(), classes.height());
    for (std::size_t i = 0; i < classes.size(); ++i) {
      const std::uint8_t id = classes.data()[i];
      separable.data()[i] = is_separable[id] ? id : std::uint16_t{0};
    }
    grooves.find(separable, view, groove);
  }

  void find_grooves(const ImageU16& instances, const DepthView& view) {
    separable.resize(instances.width(), instances.height());
    for (std::size_t i = 0; i < instances.size(); ++i) {
      const std::uint16_t id = instances.data()[i];
      separable.data()[i] = id >= kFirstInstance ? id : std::uint16_t{0};
    }
    grooves.find(separable, view, groove);
  }

  // A groove may be narrower than a cell: half of it is enough to divide.
  bool grooved(int x, int y) const {
    if (groove.empty()) return false;
    int pixels = 0;
    for (int k = 0; k < 4; ++k) pixels += groove.at(2 * x + (k & 1), 2 * y + (k >> 1)) != 0 ? 1 : 0;
    return pixels >= 2;
  }

  // The cell's pixel with depth, the first of four.
  template <class Value, class Wanted>
  void fill_cells(const Image<Value>& image, const DepthView& view, const Wanted& wanted) {
    value.resize(view.camera.width / 2, view.camera.height / 2);
    depth.resize(value.width(), value.height());
    for (int y = 0; y < value.height(); ++y) {
      for (int x = 0; x < value.width(); ++x) {
        value.at(x, y) = 0;
        depth.at(x, y) = 0.0F;
        if (grooved(x, y)) continue;
        for (int k = 0; k < 4; ++k) {
          const int u = 2 * x + (k & 1), v = 2 * y + (k >> 1);
          const float z = view.depth_m.at(u, v);
          if (!(z > 0.0F) || static_cast<double>(z) > options.max_depth_m) continue;
          if (!wanted(image.at(u, v)) || !uniform(image, u, v)) continue;
          value.at(x, y) = static_cast<std::uint16_t>(image.at(u, v));
          depth.at(x, y) = z;
          break;
        }
      }
    }
  }

  double step_m(float z) const { return options.connect_m + options.connect_share * static_cast<double>(z); }

  // Components large enough become observations; owner ids of small ones are 0.
  template <class SetClass>
  std::vector<std::uint16_t> observe(const DepthView& view, bool instances, const SetClass& set_class) {
    const std::vector<Component>& components = finder.find(value, depth, options.connect_m, options.connect_share);
    std::vector<std::uint16_t> owner(components.size(), kNobody);
    for (std::size_t i = 0; i < components.size(); ++i) {
      const Component& part = components[i];
      if (4 * part.cells < options.min_pixels) continue;
      Observation thing;
      thing.owner = static_cast<std::uint16_t>(kFirstInstance + result.observations.size());
      set_class(part.value, thing);
      thing.pixels = 4 * part.cells;
      thing.partial =
          part.x_min <= 1 || part.y_min <= 1 || part.x_max >= value.width() - 2 || part.y_max >= value.height() - 2;
      owner[i] = thing.owner;
      result.observations.push_back(std::move(thing));
    }
    collect_points(view, owner);
    find_fences({value, depth, finder, components, owner, instances}, separable, view, result.observations);
    drop_thin(owner);
    return owner;
  }

  void collect_points(const DepthView& view, const std::vector<std::uint16_t>& owner) {
    std::vector<std::unordered_set<std::int64_t>> taken(result.observations.size());
    std::vector<std::vector<float>> depths(result.observations.size());
    const PinholeCamera& camera = view.camera;
    for (int y = 0; y < value.height(); ++y) {
      for (int x = 0; x < value.width(); ++x) {
        const std::int32_t component = finder.component_at(x, y);
        if (component < 0 || owner[static_cast<std::size_t>(component)] == kNobody) continue;
        const std::size_t i = owner[static_cast<std::size_t>(component)] - kFirstInstance;
        const double z = static_cast<double>(depth.at(x, y));
        const Eigen::Vector3d p = view.T_world_camera * Eigen::Vector3d((2 * x + 0.5 - camera.cx) / camera.fx * z,
                                                                        (2 * y + 0.5 - camera.cy) / camera.fy * z, z);
        depths[i].push_back(depth.at(x, y));
        if (!taken[i].insert(key_of(p, options.point_spacing_m)).second) continue;
        result.observations[i].points_world.push_back(p.cast<float>());
        result.observations[i].sigma_m.push_back(static_cast<float>(sigma_quadratic * z * z));
      }
    }
    for (std::size_t i = 0; i < depths.size(); ++i) {
      if (depths[i].empty()) continue;
      const auto middle = depths[i].begin() + std::ssize(depths[i]) / 2;
      std::nth_element(depths[i].begin(), middle, depths[i].end());
      result.observations[i].median_depth_m = static_cast<double>(*middle);
    }
  }

  void drop_thin(std::vector<std::uint16_t>& owner) {
    std::vector<std::uint16_t> renamed(result.observations.size(), kNobody);
    std::vector<Observation> kept;
    for (Observation& thing : result.observations) {
      const std::size_t i = thing.owner - kFirstInstance;
      if (std::ssize(thing.points_world) < options.min_points) continue;
      renamed[i] = thing.owner = static_cast<std::uint16_t>(kFirstInstance + kept.size());
      thing.box = fit_box(thing.points_world, kBoxTrim);
      kept.push_back(std::move(thing));
    }
    for (std::uint16_t& id : owner) {
      if (id != kNobody) id = renamed[static_cast<std::size_t>(id - kFirstInstance)];
    }
    result.observations = std::move(kept);
  }

  // Every pixel of a cell that is like the cell's own.
  template <class Value>
  void write_owner(const Image<Value>& image, const std::vector<std::uint16_t>& owner, DepthView& view) const {
    for (int y = 0; y < value.height(); ++y) {
      for (int x = 0; x < value.width(); ++x) {
        const std::int32_t component = finder.component_at(x, y);
        if (component < 0) continue;
        const std::uint16_t id = owner[static_cast<std::size_t>(component)];
        if (id == kNobody) continue;
        const float z = depth.at(x, y);
        for (int k = 0; k < 4; ++k) {
          const int u = 2 * x + (k & 1), v = 2 * y + (k >> 1);
          const float d = view.depth_m.at(u, v);
          if (image.at(u, v) == value.at(x, y) && d > 0.0F && std::abs(static_cast<double>(d - z)) < step_m(z)) {
            view.owner.at(u, v) = id;
          }
        }
      }
    }
  }

  template <class Value, class Structure>
  void write_structure(const Image<Value>& image, const Structure& is_structure, DepthView& view) const {
    for (int y = 0; y < view.camera.height; ++y) {
      for (int x = 0; x < view.camera.width; ++x) {
        const bool mine = is_structure(image.at(x, y)) && view.depth_m.at(x, y) > 0.0F && uniform(image, x, y);
        view.owner.at(x, y) = mine ? kStructure : kNobody;
      }
    }
  }

  // With a rim: where a silhouette ends is not told to the pixel.
  template <class Moving>
  void write_moving(const ImageU8& classes, const Moving& is_moving, DepthView& view) const {
    const int r = options.erode_px, last_x = classes.width() - 1, last_y = classes.height() - 1;
    for (int y = 0; y <= last_y; ++y) {
      for (int x = 0; x <= last_x; ++x) {
        if (!is_moving(classes.at(x, y))) continue;
        view.owner.at(x, y) = kMoving;
        view.owner.at(std::max(x - r, 0), y) = view.owner.at(std::min(x + r, last_x), y) = kMoving;
        view.owner.at(x, std::max(y - r, 0)) = view.owner.at(x, std::min(y + r, last_y)) = kMoving;
      }
    }
  }
};

Extractor::Extractor(const ExtractOptions& options, double depth_sigma_quadratic_per_m)
    : impl_(std::make_unique<Impl>(options, depth_sigma_quadratic_per_m)) {}
Extractor::~Extractor() = default;

const Extraction& Extractor::from_classes(const ImageU8& classes, const ClassTable& table, DepthView& view) {
  EXPECTS(classes.width() == view.camera.width && classes.height() == view.camera.height);
  impl_->result = {};
  const auto parts = parts_of(table);
  impl_->find_grooves(classes, table, view);
  impl_->fill_cells(classes, view, [&](std::uint8_t id) { return parts[id] == Part::thing; });
  impl_->write_structure(
      classes, [&](std::uint8_t id) { return parts[id] == Part::structure; }, view);
  impl_->write_moving(
      classes, [&](std::uint8_t id) { return parts[id] == Part::moving; }, view);
  const auto owner =
      impl_->observe(view, false, [](std::uint16_t value, Observation& thing) { thing.class_id = value; });
  impl_->write_owner(classes, owner, view);
  return impl_->result;
}

const Extraction& Extractor::from_instances(const ImageU16& instances, const std::vector<SegmentClass>& class_of,
                                            DepthView& view) {
  EXPECTS(instances.width() == view.camera.width && instances.height() == view.camera.height);
  impl_->result = {};
  impl_->find_grooves(instances, view);
  impl_->fill_cells(instances, view, [](std::uint16_t id) { return id >= kFirstInstance; });
  impl_->write_structure(
      instances, [](std::uint16_t id) { return id == kStructure; }, view);
  const auto owner = impl_->observe(view, true, [&](std::uint16_t value, Observation& thing) {
    const SegmentClass& named = class_of[static_cast<std::size_t>(value - kFirstInstance)];
    thing.class_id = named.id;
    thing.votes = named.votes;
    thing.class_binds = false;
  });
  impl_->write_owner(instances, owner, view);
  return impl_->result;
}

}  // namespace povslam
