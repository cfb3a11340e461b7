#include "tools/povslam/replay_output.hpp"

#include <sys/resource.h>

#include <algorithm>
#include <cmath>
#include <fstream>
#include <nlohmann/json.hpp>

#include "daemon/app.hpp"
#include "pipeline/base/log.hpp"
#include "tools/povslam/replay_objects.hpp"
#include "tools/povslam/scores/frame_list.hpp"
#include "tools/povslam/scores/trajectory_report.hpp"

namespace povslam {
namespace {

using Json = nlohmann::ordered_json;

bool is_inside(const std::filesystem::path& inner, const std::filesystem::path& outer) {
  const std::filesystem::path relative = inner.lexically_relative(outer);
  return !relative.empty() && *relative.begin() != "..";
}

// Nearest-rank percentiles.
Json stage_json(std::vector<float> ms) {
  if (ms.empty()) return {{"count", 0}};
  std::sort(ms.begin(), ms.end());
  const auto at = [&ms](double share) {
    const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(ms.size())));
    return ms[std::max<std::size_t>(rank, 1) - 1];
  };
  return {{"count", ms.size()}, {"median", at(0.5)}, {"p95", at(0.95)}, {"p99", at(0.99)}, {"max", ms.back()}};
}

// The map at the end of each second of the recording, and what a frame of it cost.
Json map_json(const ReplayRecord& record) {
  constexpr TimeNs kPeriod = 1'000'000'000;
  const std::vector<float>& total_ms = record.stages_ms[static_cast<std::size_t>(Stage::total)];
  Json json{
      {"t_s", Json::array()}, {"keyframes", Json::array()}, {"landmarks", Json::array()}, {"median_ms", Json::array()}};
  for (std::size_t first = 0, last = 0; first < record.map.size(); first = last) {
    while (last < record.map.size() && record.map[last].stamp - record.map[first].stamp < kPeriod) ++last;
    std::vector<float> ms(total_ms.begin() + static_cast<std::ptrdiff_t>(first),
                          total_ms.begin() + static_cast<std::ptrdiff_t>(last));
    std::nth_element(ms.begin(), ms.begin() + std::ssize(ms) / 2, ms.end());
    json["t_s"].push_back(to_seconds(record.map[last - 1].stamp - record.map[0].stamp));
    json["keyframes"].push_back(record.map[last - 1].size.keyframes);
    json["landmarks"].push_back(record.map[last - 1].size.landmarks);
    json["median_ms"].push_back(ms[ms.size() / 2]);
  }
  return json;
}

double peak_rss_mb() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) * 1024e-6;
}

Json metrics_json(const ReplayRecord& record) {
  Json json{{"frames", record.frames}, {"tracked", record.tracked}, {"lost", record.lost}};
  for (std::size_t i = 0; i < kNumDropReasons; ++i) {
    json["dropped"][to_string(static_cast<DropReason>(i))] = record.drops[i];
  }
  for (std::size_t i = 0; i < kStageNames.size(); ++i)
    json["stages_ms"][kStageNames[i]] = stage_json(record.stages_ms[i]);
  json["loops"] = {{"suspected", record.loops.suspected},
                   {"closed", record.loops.closed},
                   {"joined", record.loops.joined},
                   {"refused", record.loops.refused}};
  json["vem"] = {{"runs", record.vem.runs},
                 {"em_iterations", record.vem.iterations},
                 {"observations", record.vem.matches},
                 {"landmarks", record.vem.landmarks},
                 {"faults", record.vem.faults},
                 {"doubted", record.vem.doubted},
                 {"believed_again", record.vem.believed_again},
                 {"corrections", record.vem.corrections}};
  json["labels"] = {{"received", record.labels.received},
                    {"joined", record.labels.joined},
                    {"late", record.labels.late},
                    {"unmatched", record.labels.unmatched},
                    {"missing", record.labels.missing},
                    {"wrong_size", record.labels.wrong_size},
                    {"bad", record.labels.bad},
                    {"dropped", record.labels_dropped},
                    {"unknown_pixels", record.labels.unknown_ids}};
  json["views"] = {{"understood", record.views_understood},
                   {"dropped", record.views_dropped + record.labels.dropped_views}};
  json["naming"] = {
      {"asked", record.naming.asked}, {"failed", record.naming.failed}, {"segments_named", record.naming.named}};
  json["wall_s"] = record.wall_s;
  json["cpu_s"] = record.cpu_s;
  json["tracking_cpu_s"] = record.tracking_cpu_s;
  json["feeder_cpu_s"] = record.feeder_cpu_s;
  json["peak_rss_mb"] = peak_rss_mb();
  json["map"] = map_json(record);
  return json;
}

Status write_text(const std::filesystem::path& file, const std::string& text) {
  std::ofstream out(file, std::ios::binary);
  out << text;
  out.close();
  if (!out) return Error{file.string() + ": cannot be written; is the disk full?"};
  return Done{};
}

// The picture beside the truth. A truth that cannot be compared costs the picture, not the replay.
Status plot_against_truth(const std::filesystem::path& out, const std::filesystem::path& sequence,
                          const ReplayRecord& record) {
  const Result<std::vector<StampedPose>> truth = read_trajectory(sequence / "groundtruth.txt");
  if (!truth) return truth.error();
  std::vector<TimeNs> stamps;
  for (const StampedPose& pose : record.published) stamps.push_back(pose.stamp);
  Result<scores::TrajectoryReport> report = scores::report_trajectory(*truth, record.published, stamps, {});
  if (!report) return report.error();
  report->plot.title = sequence.filename().string();
  return plot_trajectories((out / "trajectory.png").string(), report->plot);
}

}  // namespace

Status make_output_folder(const std::filesystem::path& out, const std::filesystem::path& sequence) {
  std::error_code failed;
  const auto out_real = std::filesystem::weakly_canonical(std::filesystem::absolute(out), failed);
  const auto sequence_real = std::filesystem::weakly_canonical(std::filesystem::absolute(sequence), failed);
  if (is_inside(out_real, sequence_real) || is_inside(sequence_real, out_real)) {
    return Error{"--out " + out.string() + ": must be neither inside the sequence " + sequence.string() +
                 " nor around it"};
  }
  std::filesystem::create_directories(out, failed);
  if (failed) return Error{"--out " + out.string() + ": " + failed.message()};
  return Done{};
}

Status write_replay(const std::filesystem::path& out, const std::filesystem::path& sequence,
                    const ReplayRecord& record) {
  if (const Status done = write_trajectory(out / "trajectory.txt", record.published); !done) return done.error();
  if (const Status done = write_trajectory(out / "trajectory_smoothed.txt", record.smoothed); !done)
    return done.error();
  if (const Status done = write_text(out / "metrics.json", metrics_json(record).dump(2) + "\n"); !done)
    return done.error();
  if (const Status done = write_objects(out, record); !done) return done.error();
  if (record.published.empty() || !std::filesystem::exists(sequence / "groundtruth.txt")) return Done{};
  if (const Status drawn = plot_against_truth(out, sequence, record); !drawn) {
    log::warn("trajectory.png: {}", drawn.error().message);
  }
  return Done{};
}

}  // namespace povslam
