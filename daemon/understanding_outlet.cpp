#include "daemon/understanding_outlet.hpp"

namespace povslam {

void UnderstandingOutlet::flush() {
  while (!events_.empty()) {
    WorldReport report(std::move(events_.front()));
    if (!reports_.try_push(std::move(report))) {
      events_.front() = std::get<ObjectEvent>(std::move(report));  // a full ring leaves the value
      break;
    }
    events_.pop_front();
  }
  while (!unsent_owners_.empty() && owners_.try_push(LandmarkOwner(unsent_owners_.front()))) unsent_owners_.pop_front();
  while (!unsent_beliefs_.empty() && beliefs_.try_push(ObjectBelief(unsent_beliefs_.front())))
    unsent_beliefs_.pop_front();
}

}  // namespace povslam
