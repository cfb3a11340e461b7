#include "tools/povslam/scores/visibility.hpp"

#include <algorithm>
#include <cmath>

#include "drivers/replay/image_file.hpp"
#include "drivers/replay/text_file.hpp"
#include "tools/povslam/progress.hpp"
#include "tools/povslam/scores/side_sightings.hpp"

namespace povslam::scores {
namespace {

constexpr double kObjectShareOfImage = 0.0005;
constexpr int kGrid = 5;
constexpr double kSeenThroughShare = 0.2;

double depth_tolerance_m(double z_m) {
  return 0.05 + 3.0 * 0.0025 * z_m * z_m;
}

struct DepthAt {
  double expected_m = 0.0, measured_m = 0.0;
};

// Nothing: outside of the image, behind the camera, or not measured there.
std::optional<DepthAt> look_at(const TrueView& view, const Eigen::Vector3d& p_world) {
  const Eigen::Vector3d p_camera = view.T_camera_world * p_world;
  const std::optional<Eigen::Vector2d> pixel = view.camera->project(p_camera);
  if (!pixel || !view.camera->contains(*pixel)) return std::nullopt;
  const std::uint16_t units =
      view.depth->at(static_cast<int>(std::lround(pixel->x())), static_cast<int>(std::lround(pixel->y())));
  if (units == 0) return std::nullopt;
  return DepthAt{p_camera.z(), units / view.depth_scale};
}

void count_objects(const TrueView& view, const SceneTruth& truth, std::vector<ObjectSightings>& counts) {
  std::map<int, std::size_t> pixels = instance_pixels(*view.instances);
  const double least = kObjectShareOfImage * static_cast<double>(view.instances->size());
  for (std::size_t i = 0; i < truth.objects.size(); ++i) {
    const TrueObject& object = truth.objects[i];
    const bool after = !object.changed || view.stamp > object.switch_time;
    const bool before = !object.changed || view.stamp <= object.switch_time;
    if (static_cast<double>(pixels[object.id]) >= least) {
      ++counts[i].object_ever;
      counts[i].object_after += after ? 1 : 0;
      counts[i].object_before += before ? 1 : 0;
    }
    if (object.changed && after && object.before && sees_place_empty(view, *object.before)) ++counts[i].old_place_after;
    if (object.changed && !after && object.after && sees_place_empty(view, *object.after)) ++counts[i].new_place_before;
  }
}

void count_points(const TrueView& view, const PlyMesh& surface_world, std::vector<std::size_t>& counts) {
  for (std::size_t i = 0; i < counts.size(); ++i) {
    if (counts[i] >= kMaxPointFrames) continue;
    const Eigen::Vector3d* normal_world = surface_world.normals.empty() ? nullptr : &surface_world.normals[i];
    if (sees_point(view, surface_world.vertices[i], normal_world)) ++counts[i];
  }
}

// Of things that moved, in their old places and their new ones.
class MovedSides {
 public:
  explicit MovedSides(const SceneTruth& truth) {
    for (std::size_t i = 0; i < truth.objects.size(); ++i) {
      const TrueObject& object = truth.objects[i];
      if (object.changed && object.before && object.after)
        things_.push_back({i, object.switch_time, SideSightings(*object.before), SideSightings(*object.after)});
    }
  }
  void look(const TrueView& view) {
    for (Thing& thing : things_) (view.stamp > thing.switch_time ? thing.after : thing.before).look(view);
  }
  void tell(std::vector<ObjectSightings>& objects) const {
    for (const Thing& thing : things_) {
      objects[thing.index].sides_before = thing.before.two_that_meet();
      objects[thing.index].sides_after = thing.after.two_that_meet();
    }
  }

 private:
  struct Thing {
    std::size_t index;
    TimeNs switch_time;
    SideSightings before, after;
  };
  std::vector<Thing> things_;
};

// What lies behind a rim by more than this is another surface than the one measured there.
double surface_tolerance_m(const TrueView& view, const Eigen::Vector3d& p_camera,
                           const Eigen::Vector3d& normal_camera) {
  constexpr double kFloor_m = 0.01, kMostSlant_m = 0.05;
  const double z_m = p_camera.z(), half_pixel_of_x = 0.5 * z_m / view.camera->fx,
               half_pixel_of_y = 0.5 * z_m / view.camera->fy;
  const double slant_m =
      (std::abs(normal_camera.x()) * half_pixel_of_x + std::abs(normal_camera.y()) * half_pixel_of_y) * z_m /
      std::abs(normal_camera.dot(p_camera));
  return kFloor_m + 3.0 * 0.0025 * z_m * z_m + std::min(slant_m, kMostSlant_m);
}

Result<std::vector<StampedPose>> true_poses(const std::filesystem::path& sequence) {
  return read_trajectory(sequence / "groundtruth.txt");
}

std::filesystem::path instance_file(const std::filesystem::path& sequence, const SequenceEntry& entry) {
  return sequence / "instance" / (std::filesystem::path(entry.file).stem().string() + ".png");
}

}  // namespace

bool sees_place_empty(const TrueView& view, const OrientedBox& place) {
  const Eigen::Matrix3d R = Eigen::AngleAxisd(place.yaw_rad, Eigen::Vector3d::UnitZ()).toRotationMatrix();
  int through = 0;
  for (int i = 0; i < kGrid * kGrid * kGrid; ++i) {
    const Eigen::Vector3d cell(i % kGrid, i / kGrid % kGrid, i / (kGrid * kGrid));
    const Eigen::Vector3d share = ((cell.array() + 0.5) / kGrid - 0.5).matrix();
    const std::optional<DepthAt> depth = look_at(view, place.center_world + R * share.cwiseProduct(place.size_m));
    if (depth && depth->measured_m > depth->expected_m + depth_tolerance_m(depth->expected_m)) ++through;
  }
  return through >= kSeenThroughShare * kGrid * kGrid * kGrid;
}

bool sees_point(const TrueView& view, const Eigen::Vector3d& p_world, const Eigen::Vector3d* normal_world) {
  const std::optional<DepthAt> depth = look_at(view, p_world);
  if (!depth) return false;
  const double off_m = std::abs(depth->measured_m - depth->expected_m);
  if (normal_world == nullptr) return off_m <= depth_tolerance_m(depth->expected_m);
  const Eigen::Vector3d p_camera = view.T_camera_world * p_world,
                        normal_camera = view.T_camera_world.rotation * *normal_world;
  return normal_camera.dot(p_camera) < 0.0 && off_m <= surface_tolerance_m(view, p_camera, normal_camera);
}

std::map<int, std::size_t> instance_pixels(const ImageU16& instances) {
  std::vector<std::size_t> histogram(65536, 0);
  for (const std::uint16_t id : instances.pixels()) ++histogram[id];
  std::map<int, std::size_t> pixels;
  for (int id = 0; id < 65536; ++id) {
    if (histogram[id] > 0) pixels[id] = histogram[id];
  }
  return pixels;
}

Result<Sightings> count_sightings(const std::filesystem::path& sequence, const SceneTruth& truth,
                                  const PlyMesh& surface_world) {
  const Result<Sequence> frames = read_sequence({sequence, "", LabelChoice::off, 0.02});
  if (!frames) return frames.error();
  const SequenceSensor& sensor = frames->sensors.front();
  if (sensor.depth) return Error{sequence.string() + ": visibility is only counted with depth registered to colour"};
  const Result<std::vector<StampedPose>> poses = true_poses(sequence);
  if (!poses) return poses.error();
  const PinholeCamera& camera = sensor.calibration.camera;
  const ImageSize size{camera.width, camera.height};
  Sightings sightings;
  sightings.objects.resize(truth.objects.size());
  sightings.points.assign(surface_world.vertices.size(), 0);
  MovedSides sides(truth);
  ImageReader reader;
  ImageU16 depth, instances;
  Progress progress("looking at the truth", sensor.entries.size());
  for (const SequenceEntry& entry : sensor.entries) {
    progress.step();
    const std::optional<Rigid3> pose = pose_at(*poses, entry.stamp, 0.1);
    if (!pose) continue;
    if (const Status read = reader.read_u16(entry.second_file, size, depth); !read) return read.error();
    TrueView view{entry.stamp, pose->inverse(), &camera, &depth, sensor.calibration.depth_scale, nullptr};
    const std::filesystem::path instance = instance_file(sequence, entry);
    if (is_file(instance)) {
      if (const Status read = reader.read_u16(instance, size, instances); !read) return read.error();
      view.instances = &instances;
      sightings.have_instances = true;
      count_objects(view, truth, sightings.objects);
    }
    sides.look(view);
    if (entry.stamp > truth.lap1_end) count_points(view, surface_world, sightings.points);
  }
  sides.tell(sightings.objects);
  return sightings;
}

}  // namespace povslam::scores
