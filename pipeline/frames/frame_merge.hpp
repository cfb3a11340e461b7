// Time-ordered merge of several sensors' streams: hands out frames by stamp once no stream can still deliver an
// earlier one. Single-threaded; the frames themselves stay with the caller, here they are indices ("tickets").
#pragma once

#include <cstddef>
#include <cstdint>
#include <deque>
#include <optional>
#include <vector>

#include "pipeline/base/time.hpp"

namespace povslam {

class FrameMerge {
 public:
  struct Item {
    TimeNs stamp = 0;
    int stream = 0;
    std::uint64_t ticket = 0;
  };

  // A stream silent for longer than max_wait_s behind the newest stamp is no longer waited for.
  FrameMerge(int num_streams, double max_wait_s);

  // False (and counted): the stamp is not after the last of its stream, or before what was already handed out.
  bool push(int stream, TimeNs stamp, std::uint64_t ticket);
  void finish(int stream);  // the stream will deliver nothing more

  std::optional<Item> pop();  // next in time order (equal stamps: lower stream first), nothing while undecided

  std::uint64_t rejected() const { return rejected_; }
  std::size_t pending() const;

 private:
  struct Stream {
    std::deque<Item> waiting;
    std::optional<TimeNs> last;
    bool finished = false;
  };
  std::vector<Stream> streams_;
  TimeNs max_wait_ = 0;
  std::optional<TimeNs> newest_;
  std::optional<TimeNs> handed_out_;
  std::uint64_t rejected_ = 0;
};

}  // namespace povslam
