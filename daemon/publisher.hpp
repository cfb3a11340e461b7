// Poses, objects, their events and health as LCM messages: POVSLAM_POSE, POSE (bot_core), POVSLAM_OBJECTS,
// POVSLAM_OBJECT_EVENT and POVSLAM_HEALTH. LCM's door in the daemon.
#pragma once

#include <memory>
#include <optional>
#include <string>

#include "daemon/config.hpp"
#include "daemon/sink.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

class Publisher : public Sink {
 public:
  // Fails when the URL cannot be used, with the remedy.
  static Result<std::unique_ptr<Publisher>> open(const LcmConfig& config);
  ~Publisher() override;

  void on_frame(const TrackedFrame& frame) override;
  void on_health(const Health& health) override;
  void on_event(const ObjectEvent& event) override;
  void on_objects(const ObjectSnapshot& objects) override;

 private:
  struct Impl;
  explicit Publisher(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
