// SIGTERM and SIGINT as something to wait for. Make one before any thread starts: they inherit the blocked signals.
#pragma once

namespace povslam {

class StopSignal {
 public:
  StopSignal();
  ~StopSignal();
  StopSignal(const StopSignal&) = delete;
  StopSignal& operator=(const StopSignal&) = delete;

  void request();  // as if the signal had come; any thread
  void wait();     // until a signal came or request() was called
  bool stopped();  // the same, without waiting

 private:
  bool poll_for(int timeout_ms);
  int signals_ = -1;  // signalfd
  int request_ = -1;  // eventfd
};

}  // namespace povslam
