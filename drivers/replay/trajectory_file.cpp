#include "drivers/replay/trajectory_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <fstream>

#include "drivers/replay/text_file.hpp"
#include "pipeline/base/log.hpp"

namespace povslam {

namespace {

constexpr std::size_t kWordsPerPose = 8;
constexpr double kMaxLengthError = 0.1;  // files carry four digits or more: a longer miss is no quaternion

Result<StampedPose> parse_pose(const TextFile& file, const TextLine& line) {
  if (line.words.size() != kWordsPerPose) {
    return Error{file.at(line) + std::to_string(line.words.size()) +
                 " words, a pose has eight: t tx ty tz qx qy qz qw"};
  }
  StampedPose pose;
  const std::optional<TimeNs> stamp = parse_seconds(line.words[0]);
  if (!stamp) return Error{file.at(line) + "'" + std::string(line.words[0]) + "' is no stamp in seconds"};
  pose.stamp = *stamp;
  std::array<double, kWordsPerPose - 1> v{};
  for (std::size_t i = 0; i < v.size(); ++i) {
    const std::optional<double> number = parse_number(line.words[i + 1]);
    if (!number) return Error{file.at(line) + "'" + std::string(line.words[i + 1]) + "' is no finite number"};
    v[i] = *number;
  }
  pose.T_world_sensor.translation = {v[0], v[1], v[2]};
  pose.T_world_sensor.rotation = Eigen::Quaterniond(v[6], v[3], v[4], v[5]);
  const double length = pose.T_world_sensor.rotation.norm();
  if (!(std::abs(length - 1.0) <= kMaxLengthError)) {
    return Error{file.at(line) + "the quaternion has length " + std::to_string(length) + ", not 1"};
  }
  pose.T_world_sensor.rotation.normalize();
  return pose;
}

bool by_stamp(const StampedPose& a, const StampedPose& b) {
  return a.stamp < b.stamp;
}

void put_in_order(std::vector<StampedPose>& poses, const std::filesystem::path& path) {
  const auto not_after = [](const StampedPose& a, const StampedPose& b) { return b.stamp <= a.stamp; };
  if (std::adjacent_find(poses.begin(), poses.end(), not_after) == poses.end()) return;
  const std::size_t before = poses.size();
  std::stable_sort(poses.begin(), poses.end(), by_stamp);
  const auto same_stamp = [](const StampedPose& a, const StampedPose& b) { return a.stamp == b.stamp; };
  poses.erase(std::unique(poses.begin(), poses.end(), same_stamp), poses.end());
  log::warn("{}: stamps do not increase; sorted, {} poses of a repeated stamp left out", path.string(),
            before - poses.size());
}

}  // namespace

Result<std::vector<StampedPose>> read_trajectory(const std::filesystem::path& path) {
  const Result<TextFile> file = TextFile::read(path);
  if (!file) return file.error();
  std::vector<StampedPose> poses;
  for (const TextLine& line : file->lines()) {
    const Result<StampedPose> pose = parse_pose(*file, line);
    if (!pose) return pose.error();
    poses.push_back(*pose);
  }
  if (poses.empty()) return Error{path.string() + ": holds no pose; lines are t tx ty tz qx qy qz qw"};
  put_in_order(poses, path);
  return poses;
}

Status write_trajectory(const std::filesystem::path& path, std::span<const StampedPose> poses) {
  std::ofstream stream(path, std::ios::binary);
  stream << "# timestamp tx ty tz qx qy qz qw\n";
  char text[400];
  for (const StampedPose& pose : poses) {
    const Eigen::Vector3d& t = pose.T_world_sensor.translation;
    const Eigen::Quaterniond& q = pose.T_world_sensor.rotation;
    std::snprintf(text, sizeof text, " %.9f %.9f %.9f %.9f %.9f %.9f %.9f\n", t.x(), t.y(), t.z(), q.x(), q.y(), q.z(),
                  q.w());
    stream << format_seconds(pose.stamp) << text;
  }
  stream.close();
  if (!stream) return Error{path.string() + ": cannot be written; is its folder there and the disk not full?"};
  return Done{};
}

std::optional<Rigid3> pose_at(std::span<const StampedPose> poses, TimeNs stamp, double max_gap_s) {
  const auto after = std::lower_bound(poses.begin(), poses.end(), StampedPose{stamp, {}}, by_stamp);
  if (after == poses.end()) return std::nullopt;
  if (after->stamp == stamp) return after->T_world_sensor;
  if (after == poses.begin()) return std::nullopt;
  const auto before = after - 1;
  const TimeNs gap = after->stamp - before->stamp;
  if (gap > from_seconds(max_gap_s)) return std::nullopt;
  const double s = static_cast<double>(stamp - before->stamp) / static_cast<double>(gap);
  const Rigid3& a = before->T_world_sensor;
  const Rigid3& b = after->T_world_sensor;
  return Rigid3{a.rotation.slerp(s, b.rotation).normalized(), (1.0 - s) * a.translation + s * b.translation};
}

}  // namespace povslam
