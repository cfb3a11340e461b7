// The daemon towards systemd (sd_notify) and the log: ready, state, watchdog, stopping. systemd's door. Without
// systemd (no NOTIFY_SOCKET) only the log is written.
#pragma once

#include <string>

#include "daemon/sink.hpp"
#include "pipeline/base/result.hpp"

namespace povslam {

class Service : public Sink {
 public:
  void ready();  // sensors are open and the threads run
  void stopping();
  // Logs changes of state and of the sensors, tells them to systemd as status text, and feeds the watchdog as long as
  // tracking is alive: systemd then restarts a daemon whose tracking hangs, but not one whose camera was unplugged.
  void on_health(const Health& health) override;

 private:
  bool any_health_ = false;
  Health last_;
};

// "tracking OK, 29.9 frames/s, 812 landmarks, 0 dropped"
std::string status_text(const Health& health);

}  // namespace povslam
