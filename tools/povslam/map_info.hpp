// What is known about a store, for people and for programs.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "daemon/store.hpp"

namespace povslam {

struct MapReport {
  std::filesystem::path file;
  StoreInfo store;
  MapContent content;
  WorldContent world;
};

nlohmann::ordered_json map_info_json(const MapReport& report);
std::string map_info_text(const MapReport& report);

}  // namespace povslam
