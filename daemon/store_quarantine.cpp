// Damaged stores out of the way; store_open.hpp says what set_aside is for.
#include <algorithm>
#include <cstdio>
#include <ctime>
#include <vector>

#include "daemon/store_lock.hpp"
#include "daemon/store_open.hpp"
#include "pipeline/base/log.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {
namespace {

constexpr std::size_t kKept = 3;  // damaged stores; each may be as large as a map
constexpr const char* kMark = ".damaged-";
constexpr const char* kEndings[] = {"", "-wal", "-shm"};

std::string utc_now() {
  const TimeNs now = wall_now();
  const std::time_t second = now / kNsPerSecond;
  std::tm parts{};
  gmtime_r(&second, &parts);
  char text[32], part[16];
  std::strftime(text, sizeof text, "%Y%m%dT%H%M%S", &parts);
  std::snprintf(part, sizeof part, ".%03dZ", static_cast<int>(now % kNsPerSecond / kNsPerMs));
  return std::string(text) + part;
}

std::filesystem::path free_name(const std::filesystem::path& file) {
  std::filesystem::path name;
  std::error_code none;
  do {
    name = file.string() + kMark + utc_now();
  } while (std::filesystem::exists(name, none) || std::filesystem::exists(beside(name, "-wal"), none));
  return name;
}

std::string without_ending(const std::string& name) {
  return name.ends_with("-wal") || name.ends_with("-shm") ? name.substr(0, name.size() - 4) : name;
}

// Never the newest, whatever the clock said when the others were set aside.
void remove_oldest(const std::filesystem::path& file, const std::filesystem::path& newest) {
  const std::string mark = file.filename().string() + kMark;
  std::vector<std::string> kept;
  std::error_code failed;
  for (const auto& entry : std::filesystem::directory_iterator(file.parent_path(), failed)) {
    const std::string name = without_ending(entry.path().filename().string());
    if (name.starts_with(mark) && name != newest.filename()) kept.push_back(name);
  }
  std::sort(kept.begin(), kept.end());
  kept.erase(std::unique(kept.begin(), kept.end()), kept.end());
  for (std::size_t i = 0; i + kKept <= kept.size(); ++i) {
    for (const char* ending : kEndings) std::filesystem::remove(beside(file.parent_path() / kept[i], ending), failed);
  }
}

}  // namespace

std::filesystem::path set_aside(const std::filesystem::path& file, const std::string& why) {
  const std::filesystem::path aside = free_name(file);
  std::error_code none;
  std::filesystem::remove(beside(file, "-shm"), none);  // an index of the log: made anew from it
  if (!has_log(file)) std::filesystem::remove(beside(file, "-wal"), none);
  for (const char* ending : {"", "-wal"}) {
    std::error_code failed;
    if (!std::filesystem::exists(beside(file, ending), none)) continue;
    std::filesystem::rename(beside(file, ending), beside(aside, ending), failed);
    if (failed) {
      throw StoreFault{false, file.string() + ": is damaged and cannot be renamed: " + failed.message() +
                                  "; the folder must be writable by this user"};
    }
  }
  sync_folder_of(file);
  log::error("map store damaged: {}", why);
  log::error("it is kept as {} and an EMPTY map begins at {}; if you have a copy: stop the daemon, put it there, start",
             aside.string(), file.string());
  remove_oldest(file, aside);
  return aside;
}

}  // namespace povslam
