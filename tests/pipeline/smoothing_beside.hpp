// Does what a tracker or a pipeline wants done beside it and gives the answers back some frames later, as replay does.
#pragma once

#include <deque>
#include <optional>
#include <variant>

#include "pipeline/backend_job.hpp"

namespace povslam {

template <class Asker>
class SmoothingBeside {
 public:
  explicit SmoothingBeside(Asker& asker, int delay_frames = 5) : asker_(asker), delay_frames_(delay_frames) {}

  // After each frame. True: an answer was given back and enters with the next frame.
  bool frame_done() {
    ++frame_;
    bool answered = false;
    while (!waiting_.empty() && waiting_.front().due <= frame_) {
      give_back(waiting_.front().job);
      waiting_.pop_front();
      ++answers_;
      answered = true;
    }
    while (const auto job = next_job()) {
      solve(*job, {});
      waiting_.push_back({*job, frame_ + delay_frames_});
    }
    return answered;
  }
  int answers() const { return answers_; }

 private:
  struct Waiting {
    BackendJob job;
    int due;
  };
  void give_back(const BackendJob& job) {
    if constexpr (requires { asker_.take_job(); }) {
      asker_.give_back(job);
    } else if (LoopProblem* const* loop = std::get_if<LoopProblem*>(&job)) {
      asker_.give_back(*loop);
    } else {
      asker_.give_back(std::get<SmoothProblem*>(job));
    }
  }
  std::optional<BackendJob> next_job() {
    if constexpr (requires { asker_.take_job(); }) {
      return asker_.take_job();
    } else {
      if (LoopProblem* loop = asker_.take_loop()) return loop;
      if (SmoothProblem* window = asker_.take_problem()) return window;
      return std::nullopt;
    }
  }

  Asker& asker_;
  int delay_frames_, frame_ = 0, answers_ = 0;
  std::deque<Waiting> waiting_;
};

}  // namespace povslam
