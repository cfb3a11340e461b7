#include "tools/povslam/scores/pool.hpp"

#include <algorithm>
#include <fstream>

#include "tools/povslam/scores/scene_report.hpp"

namespace povslam::scores {
namespace {

using Json = nlohmann::ordered_json;

constexpr const char* kVerdictCounts[] = {"truth", "reported", "matched", "excused"};
constexpr const char* kVoxelCounts[] = {"true_positive",         "false_positive", "false_negative",
                                        "false_positive_in_box", "true_negative",  "excused"};

template <std::size_t N>
Json sum_counts(const std::vector<Json>& sections, const char* const (&names)[N]) {
  Json sum;
  sum["runs"] = sections.size();
  for (const char* name : names) {
    std::size_t total = 0;
    for (const Json& section : sections) total += section.value(name, std::size_t{0});
    sum[name] = total;
  }
  add_ratios(sum);
  return sum;
}

std::vector<Json> sections_of(const std::vector<Json>& runs, const char* name) {
  std::vector<Json> sections;
  for (const Json& run : runs) {
    if (run.contains(name)) sections.push_back(run.at(name));
  }
  return sections;
}

Json spread(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  const std::size_t half = values.size() / 2;
  const double median = values.size() % 2 == 1 ? values[half] : 0.5 * (values[half - 1] + values[half]);
  return {{"median", median}, {"min", values.front()}, {"max", values.back()}};
}

Json pool_errors(const std::vector<Json>& sections) {
  Json pooled;
  pooled["runs"] = sections.size();
  for (const char* name : {"ate_rmse_m", "ate_mean_m", "mpe_m", "rotation_rmse_deg"}) {
    std::vector<double> values;
    for (const Json& section : sections) values.push_back(section.at(name).get<double>());
    pooled[name] = spread(values);
  }
  for (const char* lap : {"lap1", "lap2"}) {
    const std::vector<Json> laps = sections_of(sections, lap);
    if (!laps.empty()) pooled[lap] = pool_errors(laps);
  }
  return pooled;
}

Json pool_trajectories(const std::vector<Json>& trajectories) {
  Json pooled;
  for (const char* name : {"first_fixed", "aligned"}) {
    const std::vector<Json> sections = sections_of(trajectories, name);
    if (!sections.empty()) pooled[name] = pool_errors(sections);
  }
  std::size_t total = 0, with_estimate = 0;
  for (const Json& frames : sections_of(trajectories, "frames")) {
    total += frames.at("total").get<std::size_t>();
    with_estimate += frames.at("with_estimate").get<std::size_t>();
  }
  pooled["frames"] = {{"total", total}, {"with_estimate", with_estimate}};
  if (total > 0) pooled["frames"]["coverage"] = static_cast<double>(with_estimate) / static_cast<double>(total);
  return pooled;
}

Json pool(const std::vector<Json>& runs) {
  Json pooled;
  pooled["runs"] = runs.size();
  const std::vector<Json> trajectories = sections_of(runs, "trajectory");
  if (!trajectories.empty()) pooled["trajectory"] = pool_trajectories(trajectories);
  for (const char* name : {"events", "objects"}) {
    const std::vector<Json> sections = sections_of(runs, name);
    if (sections.empty()) continue;
    pooled[name] = sum_counts(sections, kVerdictCounts);
    for (const char* part : {"each_box", "knowable"}) {
      const std::vector<Json> parts = sections_of(sections, part);
      if (!parts.empty()) pooled[name][part] = sum_counts(parts, kVerdictCounts);
    }
  }
  for (const char* name : {"voxels", "voxels_against_reference_map"}) {
    const std::vector<Json> sections = sections_of(runs, name);
    if (sections.empty()) continue;
    pooled[name] = sum_counts(sections, kVoxelCounts);
    const char* kept = "unseen_true_surface_excused";
    const std::vector<Json> excused = sections_of(sections, kept);
    if (!excused.empty()) pooled[name][kept] = sum_counts(excused, kVoxelCounts);
  }
  return pooled;
}

}  // namespace

Result<Json> pool_scores(const std::vector<std::string>& files) {
  std::vector<Json> runs;
  for (const std::string& file : files) {
    std::ifstream in(file, std::ios::binary);
    if (!in || !std::filesystem::is_regular_file(file)) return Error{file + ": cannot read"};
    try {
      runs.push_back(Json::parse(in));
      pool({runs.back()});  // what is wrong with one file is said with its name
    } catch (const Json::parse_error& error) {
      return Error{file + ": byte " + std::to_string(error.byte) + ": not JSON"};
    } catch (const Json::exception& error) {
      return Error{file + ": not what `povslam evaluate` writes: " + error.what()};
    }
  }
  return pool(runs);
}

}  // namespace povslam::scores
