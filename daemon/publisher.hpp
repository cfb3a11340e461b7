// Poses and health as LCM messages: POVSLAM_POSE, POSE (bot_core) and POVSLAM_HEALTH. LCM's door in the daemon.
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

 private:
  struct Impl;
  explicit Publisher(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
