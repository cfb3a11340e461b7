// Which jobs are out, and when their answers enter: a fixed number of frames after they were asked for, however fast
// they were solved. So the daemon, whose backend is a thread, gives what `povslam replay` gives in one thread; only an
// answer that is late enters later. Does not allocate.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "pipeline/backend_job.hpp"

namespace povslam {

class JobsOut {
 public:
  explicit JobsOut(int capacity) { out_.reserve(static_cast<std::size_t>(capacity)); }

  // Asked for now, its answer wanted at frame `due`. There must be room for it.
  void add(const BackendJob& job, std::int64_t due);
  // Came back, solved or not. Must be out.
  void answer(const BackendJob& job);
  // The next answer that is there and due at this frame, in the order they were asked for.
  std::optional<BackendJob> take_due(std::int64_t frame);

 private:
  struct Out {
    BackendJob job;
    std::int64_t due;
    bool answered;
  };
  std::vector<Out> out_;
};

}  // namespace povslam
