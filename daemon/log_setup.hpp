// Where the log goes, from the configuration.
#pragma once

#include "daemon/config.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

// Standard error (without time stamps under systemd: the journal has its own) and, if named, a file.
Status set_up_log(const LogConfig& config);

}  // namespace povslam
