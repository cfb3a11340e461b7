// What is told of objects: that one appeared, moved or went, and the list of all.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "pipeline/base/time.hpp"
#include "pipeline/geometry/rigid.hpp"

namespace povslam {

enum class ObjectEventType : std::uint8_t { appeared, moved, removed };
inline const char* to_string(ObjectEventType type) {
  constexpr const char* kNames[] = {"appeared", "moved", "removed"};
  return kNames[static_cast<std::size_t>(type)];
}

struct ObjectPlace {                                   // of the box's centre; the box is upright
  Eigen::Vector3d position = Eigen::Vector3d::Zero();  // world, m
  double yaw = 0.0;                                    // rad, in (-pi/2, pi/2]
};

struct Evidence {                                   // stamps; of the place the event speaks of
  std::optional<TimeNs> first_absent, last_absent;  // it was seen empty
  TimeNs first_present = 0, last_present = 0;       // the object was seen there
};

struct ObjectEvent {
  std::int64_t seq = 0;  // counts events for ever within one store
  TimeNs stamp = 0;      // of the view that decided it
  ObjectEventType type = ObjectEventType::appeared;
  std::int64_t object = -1;
  std::string class_name;
  ObjectPlace place;  // removed: where it stood
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();
  std::optional<ObjectPlace> from;  // moved only
  double consistency = 0.0;         // E[v] of the object it speaks of, when it was decided
  double probability = 0.0;         // that the event is true
  Evidence evidence;
};

// Gaussian x Beta over geometric change l [m] and consistency v (POCD, see the design's method 1.1).
struct Belief {
  double mu = 0.0, sigma2 = 0.25;
  double alpha = 2.0, beta = 1.0;
  double expected_consistency() const { return alpha / (alpha + beta); }
};

enum class ObjectPhase : std::uint8_t { tentative, confirmed, removed };

struct ObjectRecord {  // one object of the library as others see it
  std::int64_t id = -1;
  ObjectPhase phase = ObjectPhase::tentative;
  std::string class_name;
  ObjectPlace place;
  Eigen::Vector3d size_m = Eigen::Vector3d::Zero();  // along the object's axes
  Belief belief;
  TimeNs first_seen = 0, last_seen = 0;
  std::optional<TimeNs> first_absent, last_absent;  // its place was seen through since it was last seen there
  int observations = 0;
  std::vector<std::int64_t> landmarks;  // of the tracker's map that are its own
};

}  // namespace povslam
