#include "daemon/world_report.hpp"

#include <spdlog/fmt/fmt.h>

namespace povslam {
namespace {

std::string place(const ObjectPlace& place) {
  const Eigen::Vector3d& p = place.position;
  return fmt::format("({:.2f}, {:.2f}, {:.2f})", p.x(), p.y(), p.z());
}

}  // namespace

std::string to_text(const ObjectEvent& event) {
  const std::string where = event.from ? fmt::format("from {} to {}", place(*event.from), place(event.place))
                            : event.type == ObjectEventType::removed ? "from " + place(event.place)
                                                                     : "at " + place(event.place);
  return fmt::format("object {} ({}) {} {} m, probability {:.2f}", event.object, event.class_name,
                     to_string(event.type), where, event.probability);
}

}  // namespace povslam
