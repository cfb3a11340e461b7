#include "daemon/log_setup.hpp"

#include <spdlog/sinks/basic_file_sink.h>
#include <spdlog/sinks/stdout_color_sinks.h>
#include <spdlog/spdlog.h>

#include <cstdlib>

namespace povslam {

Status set_up_log(const LogConfig& config) {
  std::vector<spdlog::sink_ptr> sinks;
  sinks.push_back(std::make_shared<spdlog::sinks::stderr_color_sink_mt>());
  const bool journal = std::getenv("JOURNAL_STREAM") != nullptr;
  sinks[0]->set_pattern(journal ? "%l: %v" : "%H:%M:%S.%e %^%l%$: %v");
  if (!config.file.empty()) {
    try {
      sinks.push_back(std::make_shared<spdlog::sinks::basic_file_sink_mt>(config.file));
    } catch (const spdlog::spdlog_ex& error) {
      return Error{"log.file: " + std::string(error.what()) + "; the file must be writable"};
    }
    sinks[1]->set_pattern("%Y-%m-%dT%H:%M:%S.%e%z %l: %v");
  }
  auto logger = std::make_shared<spdlog::logger>("povslam", sinks.begin(), sinks.end());
  logger->set_level(spdlog::level::from_str(config.level));
  logger->flush_on(spdlog::level::info);
  spdlog::set_default_logger(std::move(logger));
  return Done{};
}

}  // namespace povslam
