#include "tools/povslam/sequence_writer.hpp"

#include <array>
#include <bit>
#include <cstdio>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <utility>

namespace povslam {

namespace fs = std::filesystem;

namespace {

// What this class writes, and therefore may take away again.
constexpr std::array kFolders = {"rgb", "depth", "label", "instance", "lidar"};
constexpr std::array kFiles = {"rgb.txt",     "depth.txt",          "associations.txt", "groundtruth.txt",
                               "camera.yaml", "sensors.yaml",       "label.txt",        "lidar.txt",
                               "classes.csv", "objects_truth.json", "final_surface.ply"};
constexpr const char* kMark = "objects_truth.json";  // only our own sequences have it beside camera.yaml

std::string format(const char* pattern, auto... values) {
  std::array<char, 512> text{};
  const int length = std::snprintf(text.data(), text.size(), pattern, values...);
  EXPECTS(length >= 0 && static_cast<std::size_t>(length) < text.size());
  return text.data();
}

std::string seconds(TimeNs stamp) {
  return format("%lld.%06lld", static_cast<long long>(stamp / kNsPerSecond),
                static_cast<long long>(stamp % kNsPerSecond / kNsPerUs));
}

std::string image_name(const char* folder, std::uint64_t seq) {
  return format("%s/%06llu.png", folder, static_cast<unsigned long long>(seq));
}

std::string pose_text(const Rigid3& T) {
  const auto& p = T.translation;
  const auto& q = T.rotation;
  return format("%.9f %.9f %.9f %.9f %.9f %.9f %.9f", p.x(), p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

Error cannot_write(const fs::path& file) {
  return Error{"cannot write " + file.string() + "; is the disk full or the folder not writable?"};
}

Status write_image(const fs::path& file, const cv::Mat& image) {
  try {
    if (cv::imwrite(file.string(), image, {cv::IMWRITE_PNG_COMPRESSION, 1})) return Done{};
  } catch (const cv::Exception&) {  // imwrite throws for some failures and returns false for others
  }
  return cannot_write(file);
}

template <class Pixel>
cv::Mat as_mat(const Image<Pixel>& image, int type) {
  return {image.height(), image.width(), type, const_cast<Pixel*>(image.data())};
}

Status clear_earlier(const fs::path& folder, bool force) {
  std::error_code error;
  if (!fs::exists(folder, error) || fs::is_empty(folder, error)) return Done{};
  if (!fs::is_directory(folder, error)) return Error{"--out " + folder.string() + " is a file; give a folder"};
  const bool ours = fs::exists(folder / kMark, error) && fs::exists(folder / "camera.yaml", error);
  if (!ours) return Error{"--out " + folder.string() + " is not empty and no simulated sequence; give another folder"};
  if (!force) return Error{"--out " + folder.string() + " holds a sequence already; --force replaces it"};
  for (const char* name : kFolders) fs::remove_all(folder / name, error);
  for (const char* name : kFiles) fs::remove(folder / name, error);
  return Done{};
}

std::string sensor_text(const SensorCalibration& sensor, const char* name) {
  const auto& p = sensor.T_body_sensor.translation;
  const auto& q = sensor.T_body_sensor.rotation;
  return format("T_body_%s:\n  translation: [%.9f, %.9f, %.9f]\n  q_xyzw: [%.9f, %.9f, %.9f, %.9f]\n", name, p.x(),
                p.y(), p.z(), q.x(), q.y(), q.z(), q.w());
}

}  // namespace

Result<SequenceWriter> SequenceWriter::create(const fs::path& folder, bool force) {
  const Status cleared = clear_earlier(folder, force);
  if (!cleared) return cleared.error();
  std::error_code error;
  fs::create_directories(folder, error);
  if (error) return Error{"cannot make --out " + folder.string() + ": " + error.message()};
  return SequenceWriter(folder);
}

std::ofstream& SequenceWriter::list(const std::string& name, const char* header) {
  auto& stream = lists_[name];
  if (!stream.is_open()) {
    stream.open(folder_ / name);
    stream << header;
  }
  return stream;
}

Status SequenceWriter::make_folder(const std::string& name) {
  std::error_code error;
  fs::create_directory(folder_ / name, error);
  return error ? Status(cannot_write(folder_ / name)) : Status(Done{});
}

Status SequenceWriter::write_calibration(const SensorCalibration& camera, std::span<const SensorCalibration> others) {
  const PinholeCamera& c = camera.camera;
  const auto& d = c.distortion;
  const Status written = write_text(
      "camera.yaml",
      format(
          "width: %d\nheight: %d\nfx: %.9g\nfy: %.9g\ncx: %.9g\ncy: %.9g\ndistortion: [%.9g, %.9g, %.9g, %.9g, %.9g]\n"
          "depth_scale: %.9g\nfps: %.9g\n",
          c.width, c.height, c.fx, c.fy, c.cx, c.cy, d[0], d[1], d[2], d[3], d[4], camera.depth_scale, camera.fps));
  if (!written || others.empty()) return written;
  std::string sensors = sensor_text(camera, "camera");
  for (const SensorCalibration& other : others) sensors += sensor_text(other, other.name.c_str());
  return write_text("sensors.yaml", sensors);
}

Status SequenceWriter::add(const RgbdFrame& frame, const Rigid3& T_world_camera) {
  const std::string rgb = image_name("rgb", frame.seq), depth = image_name("depth", frame.seq);
  const std::string time = seconds(frame.stamp), depth_time = seconds(frame.depth_stamp);
  for (const char* name : {"rgb", "depth"}) {
    const Status made = make_folder(name);
    if (!made) return made;
  }
  cv::Mat bgr;
  cv::cvtColor(as_mat(frame.color, CV_8UC3), bgr, cv::COLOR_RGB2BGR);
  const Status color_written = write_image(folder_ / rgb, bgr);
  if (!color_written) return color_written;
  list("rgb.txt", "# timestamp filename\n") << time << ' ' << rgb << '\n';
  list("depth.txt", "# timestamp filename\n") << depth_time << ' ' << depth << '\n';
  list("associations.txt", "") << time << ' ' << rgb << ' ' << depth_time << ' ' << depth << '\n';
  add_truth(frame.stamp, T_world_camera);
  return write_image(folder_ / depth, as_mat(frame.depth, CV_16UC1));
}

void SequenceWriter::add_truth(TimeNs stamp, const Rigid3& T_world_camera) {
  list("groundtruth.txt", "# timestamp tx ty tz qx qy qz qw\n")
      << seconds(stamp) << ' ' << pose_text(T_world_camera) << '\n';
}

Status SequenceWriter::add(const LabelFrame& labels, std::uint64_t seq) {
  const std::string label = image_name("label", seq), instance = image_name("instance", seq);
  for (const char* name : {"label", "instance"}) {
    const Status made = make_folder(name);
    if (!made) return made;
  }
  list("label.txt", "# timestamp filename\n") << seconds(labels.stamp) << ' ' << label << '\n';
  const Status written = write_image(folder_ / label, as_mat(labels.classes, CV_8UC1));
  return written ? write_image(folder_ / instance, as_mat(labels.instances, CV_16UC1)) : written;
}

Status SequenceWriter::add(const LidarFrame& scan) {
  const Status made = make_folder("lidar");
  if (!made) return made;
  const std::string name = format("lidar/%06llu.pcd", static_cast<unsigned long long>(scan.seq));
  std::ofstream file(folder_ / name, std::ios::binary);
  const std::size_t count = scan.points.size();
  file << "# .PCD v0.7 - Point Cloud Data file format\nVERSION 0.7\nFIELDS x y z intensity t\nSIZE 4 4 4 4 4\nTYPE F F "
          "F F F\n"
       << "COUNT 1 1 1 1 1\nWIDTH " << count << "\nHEIGHT 1\nVIEWPOINT 0 0 0 1 0 0 0\nPOINTS " << count
       << "\nDATA binary\n";
  for (const LidarPoint& p : scan.points) {
    const std::array<float, 5> row = {p.x, p.y, p.z, p.intensity, p.t_offset_s};
    file.write(reinterpret_cast<const char*>(row.data()), sizeof(row));
  }
  list("lidar.txt", "# timestamp filename\n") << seconds(scan.stamp) << ' ' << name << '\n';
  return file.flush() ? Status(Done{}) : Status(cannot_write(folder_ / name));
}

Status SequenceWriter::write_text(const std::string& name, const std::string& text) {
  std::ofstream file(folder_ / name);
  file << text;
  return file.flush() ? Status(Done{}) : Status(cannot_write(folder_ / name));
}

Status SequenceWriter::write_points(const std::string& name, std::span<const synthetic::SurfacePoint> points) {
  static_assert(std::endian::native == std::endian::little && sizeof(synthetic::SurfacePoint) == 6 * sizeof(float));
  std::ofstream file(folder_ / name, std::ios::binary);
  file << "ply\nformat binary_little_endian 1.0\nelement vertex " << points.size()
       << "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty "
          "float nz\n"
       << "end_header\n";
  file.write(reinterpret_cast<const char*>(points.data()), static_cast<std::streamsize>(points.size_bytes()));
  return file.flush() ? Status(Done{}) : Status(cannot_write(folder_ / name));
}

Status SequenceWriter::finish() {
  for (auto& [name, stream] : lists_) {
    stream.close();
    if (!stream) return cannot_write(folder_ / name);
  }
  return Done{};
}

}  // namespace povslam
