// A progress bar on a terminal; silent when standard error is not one.
#pragma once

#include <cstddef>
#include <string>

#include "pipeline/base/time.hpp"

namespace povslam {

class Progress {
 public:
  Progress(std::string title, std::size_t total);  // total 0: unknown, a counter is shown instead of a bar
  ~Progress();                                     // ends the line
  Progress(const Progress&) = delete;
  Progress& operator=(const Progress&) = delete;

  void step();  // one more done; redraws at most ten times a second

 private:
  void draw();
  std::string title_;
  std::size_t total_ = 0, done_ = 0;
  TimeNs started_ = 0, drawn_ = 0;
  bool terminal_ = false;
};

}  // namespace povslam
