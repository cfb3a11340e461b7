#include "daemon/label_client.hpp"

#include <sys/socket.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace povslam {

namespace {

std::string seconds(TimeNs time) {
  return std::to_string(time / kNsPerSecond) + " s";
}

}  // namespace

LabelClient::LabelClient(FileDescriptor socket, const LabelClientOptions& options, LabelRing& ring,
                         LabelSourceCounters& counters, TimeNs now)
    : socket_(std::move(socket)),
      options_(options),
      ring_(ring),
      counters_(counters),
      in_(kLabelHeaderBytes),
      connected_at_(now),
      last_turn_(now),
      second_began_(now) {}

// One recv at a time: who floods gets no more of this thread than the others.
Status LabelClient::read(TimeNs now) {
  const ssize_t count = ::recv(socket(), in_.data() + in_fill_, in_.size() - in_fill_, MSG_DONTWAIT);
  if (count == 0) return Error{""};
  if (count < 0) {
    const bool later = errno == EAGAIN || errno == EINTR;
    return later ? Status(Done{}) : Status(Error{""});
  }
  if (in_fill_ == 0) begun_at_ = now;
  in_fill_ += static_cast<std::size_t>(count);
  if (in_fill_ < in_.size()) return Done{};
  if (!header_) {
    const Result<LabelHeader> header = read_label_header(in_, options_.limits);
    if (!header) return header.error();
    header_ = *header;
    in_.resize(kLabelHeaderBytes + header->length);
    if (header->length > 0) return Done{};
  }
  const Status handled = handle_message(now);
  header_.reset();
  in_.resize(kLabelHeaderBytes);
  in_fill_ = 0;
  last_turn_ = now;
  return handled;
}

Status LabelClient::handle_message(TimeNs now) {
  if (const Status status = count_message(now); !status) return status;
  const std::span<const std::uint8_t> content = std::span<const std::uint8_t>(in_).subspan(kLabelHeaderBytes);
  if (!greeted_ && header_->type != LabelMessage::hello) return Error{"the first message must be hello"};
  switch (header_->type) {
    case LabelMessage::hello:
      return handle_hello(content, now);
    case LabelMessage::labels:
      return handle_labels(content);
    default:
      wants_image_ = true;
      return Done{};
  }
}

Status LabelClient::handle_hello(std::span<const std::uint8_t> content, TimeNs now) {
  if (greeted_) return Error{"hello was said already"};
  const Result<LabelHello> hello = read_label_hello(content);
  if (!hello) return hello.error();
  if (hello->table != options_.table) {
    return Error{"the source labels with class table \"" + hello->table + "\", this daemon reads \"" + options_.table +
                 "\"; set labels.classes or the source's table"};
  }
  greeted_ = true;
  with_depth_ = hello->with_depth;
  counters_.clients.fetch_add(1, std::memory_order_relaxed);
  write_welcome(options_.limits, out_);
  out_since_ = now;
  return Done{};
}

Status LabelClient::handle_labels(std::span<const std::uint8_t> content) {
  Result<LabelFrame> labels = read_labels(content, options_.limits);
  if (!labels) return labels.error();
  if (!was_asked(labels->stamp)) {
    counters_.bad.fetch_add(1, std::memory_order_relaxed);
    return Done{};
  }
  labels->table_name = options_.table;
  labels->produced = monotonic_now();
  const bool taken = ring_.try_push(std::move(*labels));
  (taken ? counters_.labels : counters_.dropped).fetch_add(1, std::memory_order_relaxed);
  return Done{};
}

Status LabelClient::count_message(TimeNs now) {
  if (now - second_began_ >= kNsPerSecond) {
    second_began_ = now;
    messages_this_second_ = 0;
  }
  if (++messages_this_second_ <= options_.max_messages_per_s) return Done{};
  return Error{"more than " + std::to_string(options_.max_messages_per_s) + " messages a second"};
}

// Each image is answered once.
bool LabelClient::was_asked(TimeNs stamp) {
  const auto it = std::find(asked_.begin(), asked_.end(), std::optional(stamp));
  if (it == asked_.end()) return false;
  it->reset();
  return true;
}

void LabelClient::send_image(const RgbdFrame& image, TimeNs now) {
  EXPECTS(wants_image());
  write_image(image, with_depth_, out_);
  out_since_ = last_turn_ = now;
  wants_image_ = false;
  asked_[num_asked_++ % asked_.size()] = image.stamp;
  counters_.images.fetch_add(1, std::memory_order_relaxed);
}

Status LabelClient::write(TimeNs now) {
  if (out_.empty()) return Done{};
  const ssize_t count = ::send(socket(), out_.data() + out_sent_, out_.size() - out_sent_, MSG_DONTWAIT | MSG_NOSIGNAL);
  if (count < 0) {
    const bool later = errno == EAGAIN || errno == EINTR;
    return later ? Status(Done{}) : Status(Error{""});
  }
  out_sent_ += static_cast<std::size_t>(count);
  if (out_sent_ < out_.size()) return Done{};
  out_.clear();
  out_sent_ = 0;
  last_turn_ = now;
  return Done{};
}

Status LabelClient::check_time(TimeNs now) const {
  if (!greeted_ && now - connected_at_ > options_.hello_timeout) {
    return Error{"no hello within " + seconds(options_.hello_timeout)};
  }
  if (in_fill_ > 0 && now - begun_at_ > options_.message_timeout) {
    return Error{"a message was begun and not finished within " + seconds(options_.message_timeout)};
  }
  if (!out_.empty() && now - out_since_ > options_.message_timeout) {
    return Error{"the source does not take its image within " + seconds(options_.message_timeout)};
  }
  if (greeted_ && !wants_image_ && out_.empty() && now - last_turn_ > options_.idle_timeout) {
    return Error{"no message within " + seconds(options_.idle_timeout)};
  }
  return Done{};
}

void LabelClient::refuse(const std::string& reason) {
  if (!out_.empty()) return;  // the text would end up inside the image
  write_refused(reason, out_);
  static_cast<void>(::send(socket(), out_.data(), out_.size(), MSG_DONTWAIT | MSG_NOSIGNAL));
  out_.clear();
}

}  // namespace povslam
