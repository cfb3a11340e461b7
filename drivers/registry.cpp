#include "drivers/registry.hpp"

#include "drivers/replay/replay_driver.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"

namespace povslam {

namespace {

struct Row {
  const char* name;
  Result<std::unique_ptr<Driver>> (*make)(const DriverOptions& options);
};

constexpr Row kTable[] = {
    {"replay", make_replay_driver},
    {"synthetic", make_synthetic_driver},
};

}  // namespace

Result<std::unique_ptr<Driver>> make_driver(const std::string& name, const DriverOptions& options) {
  std::string known;
  for (const Row& row : kTable) {
    if (name == row.name) return row.make(options);
    known += std::string(known.empty() ? "" : ", ") + row.name;
  }
  return Error{"driver '" + name + "' is unknown; known are " + known};
}

std::vector<std::string> driver_names() {
  std::vector<std::string> names;
  for (const Row& row : kTable) names.emplace_back(row.name);
  return names;
}

}  // namespace povslam
