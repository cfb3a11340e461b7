// The one table: driver name -> factory.
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "drivers/driver.hpp"

namespace povslam {

// Unknown name or bad option: an error that names the driver, the key and what is allowed. Opens nothing.
Result<std::unique_ptr<Driver>> make_driver(const std::string& name, const DriverOptions& options);
std::vector<std::string> driver_names();

}  // namespace povslam
