// The label sources that the configuration asks for: socket, LCM, both or none; each in its own thread with its own
// ring.
#pragma once

#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "daemon/config.hpp"
#include "daemon/label_lcm.hpp"
#include "daemon/label_thread.hpp"
#include "pipeline/geometry/camera.hpp"

namespace povslam {

class LabelSources {
 public:
  // table: name of the class table that choose_class_table() gave. camera: of the images. bell: rung when labels come,
  // outlives this; null: nobody sleeps for them.
  static Result<std::unique_ptr<LabelSources>> start(const LabelConfig& config, const LcmConfig& lcm,
                                                     const std::string& table, const PinholeCamera& camera,
                                                     Doorbell* bell = nullptr);

  bool any() const { return socket_ != nullptr || lcm_ != nullptr; }

  // Both from one thread, the one that understands views.
  void offer(const RgbdFrame& image);   // this image may be labelled; never waits
  std::optional<LabelFrame> try_pop();  // labels that came

  std::vector<LabelSourceHealth> health() const;                          // of those there are; any thread
  const LabelSourceCounters& socket() const { return socket_counters_; }  // any thread
  const LabelSourceCounters& lcm() const { return lcm_counters_; }

 private:
  explicit LabelSources(Doorbell* bell) : socket_ring_(kLabelRing, bell), lcm_ring_(kLabelRing, bell) {}

  LabelSourceCounters socket_counters_, lcm_counters_;
  LabelRing socket_ring_, lcm_ring_;
  std::unique_ptr<LabelThread> socket_;
  std::unique_ptr<LcmLabelThread> lcm_;  // threads last: they stop before what they use goes
};

}  // namespace povslam
