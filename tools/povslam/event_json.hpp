// An object event as one line of events.jsonl.
#pragma once

#include <nlohmann/json_fwd.hpp>

#include "daemon/store.hpp"

namespace povslam {

nlohmann::ordered_json event_json(const ObjectEvent& event);

}  // namespace povslam
