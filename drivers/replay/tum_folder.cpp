// The TUM RGB-D benchmark's layout with our extras: further cameras rgb_<name>.txt / depth_<name>.txt, label.txt,
// lidar.txt, and sensors.yaml that says where each of them sits.
#include <algorithm>
#include <set>

#include "drivers/replay/classes_file.hpp"
#include "drivers/replay/file_list.hpp"
#include "drivers/replay/sequence.hpp"
#include "drivers/replay/text_file.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {

namespace {

namespace fs = std::filesystem;

// Their numbers are missing from the frames' count: a gap.
void warn_of_unpaired(const FileList& color, const std::vector<std::pair<std::size_t, std::size_t>>& pairs,
                      double tolerance_s) {
  if (pairs.size() == color.files.size()) return;
  std::size_t first = 0;  // pairs are in the order of colour
  while (first < pairs.size() && pairs[first].first == first) ++first;
  log::warn("{}: no depth image within {} s of this one, nor of {} others; left out", color.files[first].where,
            tolerance_s, color.files.size() - pairs.size() - 1);
}

constexpr const char* kMainCamera = "camera";
constexpr double kLidarRate_hz = 10.0;

void append(std::vector<std::string>& all, const std::vector<std::string>& more) {
  all.insert(all.end(), more.begin(), more.end());
}

SequenceEntry rgbd_entry(const fs::path& folder, const ListedFile& color, const ListedFile& depth) {
  return {color.stamp, depth.stamp, color.seq, (folder / color.file).string(), (folder / depth.file).string(),
          color.where};
}

// suffix: "" for the main camera, "_<name>" for a further one.
Result<std::vector<SequenceEntry>> read_rgbd_entries(const SequenceOptions& options, const std::string& suffix,
                                                     std::vector<std::string>& faults) {
  const fs::path& folder = options.folder;
  std::vector<SequenceEntry> entries;
  if (suffix.empty() && is_file(folder / "associations.txt")) {
    const Result<PairList> list = read_associations(folder / "associations.txt");
    if (!list) return list.error();
    append(faults, list->faults);
    for (const ListedPair& pair : list->pairs) entries.push_back(rgbd_entry(folder, pair.color, pair.depth));
    if (entries.empty())
      return Error{(folder / "associations.txt").string() + ": no line 't_rgb rgb_file t_depth depth_file'"};
    return entries;
  }
  const Result<FileList> color = read_file_list(folder / ("rgb" + suffix + ".txt"));
  const Result<FileList> depth = read_file_list(folder / ("depth" + suffix + ".txt"));
  for (const Result<FileList>* list : {&color, &depth}) {
    if (!*list) {
      return Error{list->error().message +
                   "; a recorded sequence has rgb.txt and depth.txt (lines 'stamp file') or associations.txt"};
    }
    append(faults, (*list)->faults);
  }
  const auto pairs = associate(color->files, depth->files, from_seconds(options.association_tolerance_s));
  for (const auto& [i, j] : pairs) {
    entries.push_back(rgbd_entry(folder, color->files[i], depth->files[j]));
  }
  if (entries.empty()) {
    return Error{
        folder.string() + ": none of the " + std::to_string(color->files.size()) + " colour images (rgb" + suffix +
        ".txt) has a depth image within association_tolerance_s = " + std::to_string(options.association_tolerance_s)};
  }
  warn_of_unpaired(*color, pairs, options.association_tolerance_s);
  return entries;
}

Result<CameraFile> read_calibration(const SequenceOptions& options, const std::string& suffix) {
  for (const std::string& name : {"camera" + suffix + ".yaml", std::string("camera.yaml")}) {
    std::error_code fault;
    if (fs::exists(options.folder / name, fault)) return read_camera_file(options.folder / name);
  }
  if (!options.camera.empty()) return find_camera(options.camera);
  std::string known;
  for (const std::string& name : camera_preset_names()) known += " " + name;
  return Error{options.folder.string() + ": no camera.yaml; give the option camera: a camera.yaml file or one of" +
               known};
}

SequenceSensor rgbd_sensor(const CameraFile& camera, std::string name, const Rigid3& T_body_camera) {
  SequenceSensor sensor;
  sensor.calibration.name = std::move(name);
  sensor.calibration.kind = SensorKind::rgbd;
  sensor.calibration.camera = camera.color;
  sensor.calibration.depth_scale = camera.depth_scale;
  sensor.calibration.fps = camera.fps;
  sensor.calibration.rolling_shutter_s = camera.rolling_shutter_s;
  sensor.calibration.T_body_sensor = T_body_camera;
  sensor.depth = camera.depth;
  return sensor;
}

// A label image belongs to the colour image nearest in time and takes over its stamp.
Result<SequenceSensor> read_labels(const SequenceOptions& options, const SequenceSensor& camera,
                                   std::vector<std::string>& faults) {
  const fs::path& folder = options.folder;
  const Result<FileList> list = read_file_list(folder / "label.txt");
  if (!list) return list.error();
  append(faults, list->faults);
  SequenceSensor labels;
  labels.calibration = camera.calibration;
  labels.calibration.kind = SensorKind::labels;
  labels.calibration.name += "_labels";
  std::vector<ListedFile> frames;
  for (const SequenceEntry& entry : camera.entries) frames.push_back({entry.stamp, entry.file, entry.seq, entry.where});
  std::error_code fault;
  const bool instances = fs::is_directory(folder / "instance", fault);
  for (const auto& [i, j] : associate(frames, list->files, from_seconds(options.association_tolerance_s))) {
    const ListedFile& label = list->files[j];
    const fs::path instance = folder / "instance" / fs::path(label.file).filename();
    labels.entries.push_back({frames[i].stamp, 0, label.seq, (folder / label.file).string(),
                              instances ? instance.string() : std::string(), label.where});
  }
  return labels;
}

Result<SequenceSensor> read_lidar(const fs::path& folder, const Rigid3& T_body_lidar,
                                  std::vector<std::string>& faults) {
  const Result<FileList> list = read_file_list(folder / "lidar.txt");
  if (!list) return list.error();
  append(faults, list->faults);
  SequenceSensor lidar;
  lidar.calibration.name = "lidar";
  lidar.calibration.kind = SensorKind::lidar;
  lidar.calibration.fps = kLidarRate_hz;
  lidar.calibration.T_body_sensor = T_body_lidar;
  for (const ListedFile& scan : list->files) {
    lidar.entries.push_back({scan.stamp, 0, scan.seq, (folder / scan.file).string(), "", scan.where});
  }
  return lidar;
}

// Names of further cameras: the <name> of each rgb_<name>.txt, in alphabetical order.
std::set<std::string> further_cameras(const fs::path& folder) {
  std::set<std::string> names;
  std::error_code fault;
  for (fs::directory_iterator it(folder, fault), end; !fault && it != end; it.increment(fault)) {
    const std::string name = it->path().filename().string();
    if (name.starts_with("rgb_") && name.ends_with(".txt") && name.size() > 8)
      names.insert(name.substr(4, name.size() - 8));
  }
  return names;
}

Result<std::map<std::string, Rigid3>> read_mounting(const fs::path& folder, const std::set<std::string>& cameras,
                                                    bool lidar) {
  std::map<std::string, Rigid3> mounting;
  const fs::path path = folder / "sensors.yaml";
  std::error_code fault;
  if (fs::exists(path, fault)) {
    Result<std::map<std::string, Rigid3>> read = read_sensors_file(path);
    if (!read) return read.error();
    mounting = *read;
  }
  mounting.try_emplace(kMainCamera, level_forward_camera());
  std::set<std::string> sensors = cameras;
  if (lidar) sensors.insert("lidar");
  for (const std::string& name : sensors) {
    if (!mounting.contains(name)) {
      return Error{path.string() + ": T_body_" + name +
                   " is missing; it says where that sensor sits (translation, q_xyzw)"};
    }
  }
  return mounting;
}

Status add_camera(Sequence& sequence, const SequenceOptions& options, const std::string& name,
                  const Rigid3& T_body_camera) {
  const std::string suffix = name == kMainCamera ? "" : "_" + name;
  Result<std::vector<SequenceEntry>> entries = read_rgbd_entries(options, suffix, sequence.faults);
  if (!entries) return entries.error();
  const Result<CameraFile> camera = read_calibration(options, suffix);
  if (!camera) return camera.error();
  sequence.sensors.push_back(rgbd_sensor(*camera, name, T_body_camera));
  sequence.sensors.back().entries = std::move(*entries);
  return Done{};
}

Status add_labels(Sequence& sequence, const SequenceOptions& options) {
  const bool has_labels = is_file(options.folder / "label.txt");
  if (options.labels == LabelChoice::off || (options.labels == LabelChoice::automatic && !has_labels)) return Done{};
  if (!has_labels)
    return Error{options.folder.string() + ": labels = true, but there is no label.txt; set labels = false"};
  Result<SequenceSensor> labels = read_labels(options, sequence.sensors.front(), sequence.faults);
  if (!labels) return labels.error();
  sequence.sensors.push_back(std::move(*labels));
  const fs::path classes = options.folder / "classes.csv";
  std::error_code fault;
  if (!fs::exists(classes, fault)) return Done{};
  Result<LabelTable> table = read_classes_file(classes);
  if (!table) return table.error();
  sequence.label_table = std::move(*table);
  return Done{};
}

}  // namespace

Result<Sequence> read_tum_folder(const SequenceOptions& options) {
  const std::set<std::string> cameras = further_cameras(options.folder);
  const bool has_lidar = is_file(options.folder / "lidar.txt");
  const Result<std::map<std::string, Rigid3>> mounting = read_mounting(options.folder, cameras, has_lidar);
  if (!mounting) return mounting.error();
  Sequence sequence;
  sequence.description = options.folder.string();
  if (const Status s = add_camera(sequence, options, kMainCamera, mounting->at(kMainCamera)); !s) return s.error();
  if (const Status s = add_labels(sequence, options); !s) return s.error();
  for (const std::string& name : cameras) {
    if (const Status s = add_camera(sequence, options, name, mounting->at(name)); !s) return s.error();
  }
  if (has_lidar) {
    Result<SequenceSensor> lidar = read_lidar(options.folder, mounting->at("lidar"), sequence.faults);
    if (!lidar) return lidar.error();
    sequence.sensors.push_back(std::move(*lidar));
  }
  return sequence;
}

}  // namespace povslam
