// One connected label source: reads its messages and sends it images, never waiting. One thread.
#pragma once

#include <array>
#include <optional>
#include <string>
#include <vector>

#include "daemon/file_descriptor.hpp"
#include "daemon/label_protocol.hpp"
#include "daemon/label_ring.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/base/time.hpp"

namespace povslam {

struct LabelClientOptions {
  std::string table;   // name of the class table that labels must refer to
  LabelLimits limits;  // the camera's images
  TimeNs hello_timeout = 5 * kNsPerSecond;
  TimeNs message_timeout = 5 * kNsPerSecond;  // for the rest of a message that was begun, either way
  TimeNs idle_timeout = 30 * kNsPerSecond;    // without a message while an image waits to be answered
  int max_messages_per_s = 100;
};

class LabelClient {
 public:
  LabelClient(FileDescriptor socket, const LabelClientOptions& options, LabelRing& ring, LabelSourceCounters& counters,
              TimeNs now);

  int socket() const { return socket_.get(); }
  bool greeted() const { return greeted_; }
  bool wants_image() const { return wants_image_ && out_.empty(); }
  bool has_output() const { return !out_.empty(); }

  // Each does what can be done now, within a bounded time. An error ends the connection: its text is for refuse(),
  // empty when the source itself hung up.
  Status read(TimeNs now);
  Status write(TimeNs now);
  Status check_time(TimeNs now) const;

  void send_image(const RgbdFrame& image, TimeNs now);
  void refuse(const std::string& reason);  // says why if that is possible at once

 private:
  Status handle_message(TimeNs now);
  Status handle_hello(std::span<const std::uint8_t> content, TimeNs now);
  Status handle_labels(std::span<const std::uint8_t> content);
  Status count_message(TimeNs now);
  bool was_asked(TimeNs stamp);

  FileDescriptor socket_;
  const LabelClientOptions& options_;
  LabelRing& ring_;
  LabelSourceCounters& counters_;

  bool greeted_ = false, wants_image_ = false, with_depth_ = false;
  std::vector<std::uint8_t> in_, out_;  // the message being read or written
  std::size_t in_fill_ = 0, out_sent_ = 0;
  std::optional<LabelHeader> header_;  // of the one being read
  TimeNs connected_at_, begun_at_ = 0, out_since_ = 0, last_turn_;
  TimeNs second_began_;
  int messages_this_second_ = 0;
  std::array<std::optional<TimeNs>, 64> asked_;  // ring of stamps of images sent and not answered
  std::size_t num_asked_ = 0;
};

}  // namespace povslam
