// The other end of the label socket for tests: says what it is told to, right or wrong.
#pragma once

#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>

#include <cerrno>
#include <cstring>
#include <optional>
#include <string>
#include <vector>

#include "daemon/file_descriptor.hpp"
#include "daemon/label_protocol.hpp"
#include "pipeline/base/expects.hpp"

namespace povslam {

class LabelPeer {
 public:
  using Bytes = std::vector<std::uint8_t>;
  struct Message {
    LabelMessage type = LabelMessage::refused;
    Bytes content;
    std::string text() const { return {content.begin(), content.end()}; }
  };

  explicit LabelPeer(const std::string& path) : socket_(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0)) {
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    EXPECTS(path.size() < sizeof address.sun_path);
    std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
    connected_ = ::connect(socket_.get(), reinterpret_cast<const sockaddr*>(&address), sizeof address) == 0;
  }
  bool connected() const { return connected_; }

  template <class Number>
  static void put(Bytes& bytes, Number number) {
    bytes.resize(bytes.size() + sizeof number);
    std::memcpy(bytes.data() + bytes.size() - sizeof number, &number, sizeof number);
  }
  static Bytes message(LabelMessage type, const Bytes& content) {
    Bytes bytes = {'P', 'V', 'L', 'B'};
    put(bytes, kLabelProtocolVersion);
    put(bytes, static_cast<std::uint16_t>(type));
    put(bytes, static_cast<std::uint32_t>(content.size()));
    bytes.insert(bytes.end(), content.begin(), content.end());
    return bytes;
  }
  static Bytes hello(const std::string& table, std::uint32_t flags = 0) {
    Bytes content;
    put(content, flags);
    for (const char c : table) content.push_back(static_cast<std::uint8_t>(c));
    return message(LabelMessage::hello, content);
  }
  static Bytes next() { return message(LabelMessage::next, {}); }
  static Bytes labels(std::int64_t stamp, std::uint32_t width, std::uint32_t height, std::uint8_t format,
                      std::size_t num_bytes, std::uint8_t value = 1) {
    Bytes content;
    put(content, stamp);
    put(content, width);
    put(content, height);
    content.push_back(format);
    content.resize(kLabelHeadBytes, 0);
    content.resize(kLabelHeadBytes + num_bytes, value);
    return message(LabelMessage::labels, content);
  }

  // Whatever the daemon takes within a second; true if all.
  bool say(const Bytes& bytes) {
    for (std::size_t sent = 0; sent < bytes.size();) {
      if (!wait(POLLOUT)) return false;
      const ssize_t count =
          ::send(socket_.get(), bytes.data() + sent, bytes.size() - sent, MSG_NOSIGNAL | MSG_DONTWAIT);
      if (count < 0 && errno != EAGAIN) return false;
      if (count > 0) sent += static_cast<std::size_t>(count);
    }
    return true;
  }
  // The next message; nothing when there is none within two seconds or the daemon hung up.
  std::optional<Message> hear() {
    const std::optional<Bytes> header = read(kLabelHeaderBytes);
    if (!header) return std::nullopt;
    Message message;
    std::uint16_t type = 0;
    std::uint32_t length = 0;
    std::memcpy(&type, header->data() + 6, sizeof type);
    std::memcpy(&length, header->data() + 8, sizeof length);
    std::optional<Bytes> content = read(length);
    if (!content) return std::nullopt;
    message.type = static_cast<LabelMessage>(type);
    message.content = std::move(*content);
    return message;
  }
  bool hung_up_on() {  // after what it may have said before
    while (hear()) {
    }
    return closed_;
  }

 private:
  bool wait(short what) const {
    pollfd event{socket_.get(), what, 0};
    return ::poll(&event, 1, 2000) == 1;
  }
  std::optional<Bytes> read(std::size_t count) {
    Bytes bytes(count);
    for (std::size_t got = 0; got < count;) {
      if (!wait(POLLIN)) return std::nullopt;
      const ssize_t n = ::recv(socket_.get(), bytes.data() + got, count - got, 0);
      closed_ |= n <= 0;
      if (n <= 0) return std::nullopt;
      got += static_cast<std::size_t>(n);
    }
    return bytes;
  }

  FileDescriptor socket_;
  bool connected_ = false, closed_ = false;
};

}  // namespace povslam
