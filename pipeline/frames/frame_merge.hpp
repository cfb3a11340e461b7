// Time-ordered merge of several sensors' streams: hands out frames by stamp once no stream can still deliver an
// earlier one. Single-threaded; the frames themselves stay with the caller, here they are indices ("tickets").
// All streams share one clock; what a stream promises is that its stamps increase.
#pragma once

#include <cstddef>
#include <cstdint>
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

  // A stream whose last stamp lies more than max_wait_s behind the newest of all is silent: nobody waits for it until
  // it is heard again. (A stream never heard counts from the first stamp of all.) A stream that delivers later than
  // max_wait_s therefore loses frames; choose it above the worst latency between sensors.
  FrameMerge(int num_streams, double max_wait_s);

  // False (and counted): the stamp is not after the last of its stream, or before what was already handed out.
  bool push(int stream, TimeNs stamp, std::uint64_t ticket);
  void finish(int stream);  // the stream will deliver nothing more

  std::optional<Item> pop();  // next in time order (equal stamps: lower stream first), nothing while undecided

  std::uint64_t rejected() const { return rejected_; }
  std::size_t pending() const;

 private:
  struct Stream {
    std::vector<Item> items;  // waiting from `head` on; the front is cut off now and then, so nothing is allocated
    std::size_t head = 0;     // once the vector has grown to the usual queue
    std::optional<TimeNs> last;
    bool finished = false;

    bool empty() const { return head == items.size(); }
    const Item& front() const { return items[head]; }
    Item take();
  };
  Stream& at(int stream);
  bool may_deliver_before(const Stream& stream, TimeNs stamp) const;

  std::vector<Stream> streams_;
  std::uint64_t max_wait_ns_ = 0;
  TimeNs first_ = 0, newest_ = 0;  // of all streams; meaningful once anything was heard
  std::optional<TimeNs> handed_out_;
  bool heard_ = false;
  std::uint64_t rejected_ = 0;
};

}  // namespace povslam
