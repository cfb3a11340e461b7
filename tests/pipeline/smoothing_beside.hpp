// Solves what a tracker or a pipeline asks and gives the answer back some frames later, as replay does.
#pragma once

#include <utility>

#include "pipeline/backend/smooth.hpp"

namespace povslam {

template <class Asker>
class SmoothingBeside {
 public:
  explicit SmoothingBeside(Asker& asker, int delay_frames = 5) : asker_(asker), delay_frames_(delay_frames) {}

  // After each frame. True: an answer was given back and enters with the next frame.
  bool frame_done() {
    if (problem_ == nullptr) {
      problem_ = asker_.take_problem();
      waited_ = 0;
      if (problem_ != nullptr) smooth(*problem_, {});
    } else if (++waited_ >= delay_frames_) {
      asker_.give_back(std::exchange(problem_, nullptr));
      ++answers_;
      return true;
    }
    return false;
  }
  int answers() const { return answers_; }

 private:
  Asker& asker_;
  int delay_frames_, waited_ = 0, answers_ = 0;
  SmoothProblem* problem_ = nullptr;
};

}  // namespace povslam
