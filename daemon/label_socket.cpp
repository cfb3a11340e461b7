#include "daemon/label_socket.hpp"

#include <poll.h>
#include <sys/eventfd.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <system_error>

#include "pipeline/base/log.hpp"

namespace povslam {

namespace {

constexpr int kIdleWait_ms = 1000;
constexpr int kBusyWait_ms = 50;  // a source is there or the door is shut for a moment: times are to be kept
constexpr mode_t kMode = 0660;    // the service's user and group

Error cannot(const std::string& path, const std::string& why) {
  return Error{"labels.socket: " + path + ": " + why};
}
std::string reason_of(int code) {
  return std::generic_category().message(code);
}

std::optional<sockaddr_un> address_of(const std::string& path) {
  sockaddr_un address{};
  address.sun_family = AF_UNIX;
  if (path.empty() || path.size() >= sizeof address.sun_path) return std::nullopt;
  std::memcpy(address.sun_path, path.c_str(), path.size() + 1);
  return address;
}

const sockaddr* as_sockaddr(const sockaddr_un& address) {
  return reinterpret_cast<const sockaddr*>(&address);
}

// Whether a socket at the path belongs to nobody any more.
bool is_left_behind(const sockaddr_un& address) {
  struct stat status {};
  if (::lstat(address.sun_path, &status) != 0 || !S_ISSOCK(status.st_mode)) return false;
  const FileDescriptor probe(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  return ::connect(probe.get(), as_sockaddr(address), sizeof address) != 0 && errno == ECONNREFUSED;
}

Result<FileDescriptor> listen_at(const std::string& path) {
  const std::optional<sockaddr_un> address = address_of(path);
  if (!address) return cannot(path, "a path of 1 to 107 letters is needed");
  FileDescriptor listener(::socket(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
  if (!listener.open()) return cannot(path, reason_of(errno));
  if (is_left_behind(*address)) ::unlink(path.c_str());
  if (::bind(listener.get(), as_sockaddr(*address), sizeof *address) != 0) {
    if (errno != EADDRINUSE) return cannot(path, reason_of(errno) + "; its folder must exist and be writable");
    return cannot(path, "is in use by another program, or no socket; stop that program or choose another path");
  }
  if (::chmod(path.c_str(), kMode) != 0 || ::listen(listener.get(), 4) != 0) return cannot(path, reason_of(errno));
  return listener;
}

}  // namespace

Result<std::unique_ptr<LabelSocket>> LabelSocket::open(LabelSocketOptions options, LabelRing& ring,
                                                       LabelSourceCounters& counters) {
  Result<FileDescriptor> listener = listen_at(options.path);
  if (!listener) return listener.error();
  FileDescriptor wake(::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK));
  if (!wake.open()) return cannot(options.path, reason_of(errno));
  return std::unique_ptr<LabelSocket>(
      new LabelSocket(std::move(options), std::move(*listener), std::move(wake), ring, counters));
}

LabelSocket::LabelSocket(LabelSocketOptions options, FileDescriptor listener, FileDescriptor wake, LabelRing& ring,
                         LabelSourceCounters& counters)
    : options_(std::move(options)),
      listener_(std::move(listener)),
      wake_(std::move(wake)),
      ring_(ring),
      counters_(counters),
      silence_(options_.path, options_.silence) {}

LabelSocket::~LabelSocket() {
  client_.reset();
  ::unlink(options_.path.c_str());
}

void LabelSocket::offer(const RgbdFrame& image) {
  images_.draft() = image;
  images_.publish();
  counters_.offered.fetch_add(1, std::memory_order_relaxed);
  wake();
}

void LabelSocket::wake() {
  const std::uint64_t one = 1;
  static_cast<void>(::write(wake_.get(), &one, sizeof one));  // fails only when it is awake anyhow
}

void LabelSocket::step() {
  bool at_door = false, readable = false;
  wait_for_events(at_door, readable);
  const TimeNs now = monotonic_now();
  if (client_) serve(now, readable);
  if (at_door) accept_one(now);
  silence_.watch(counters_, now);
}

void LabelSocket::wait_for_events(bool& at_door, bool& readable) {
  const bool paused = monotonic_now() < paused_until_;
  std::array<pollfd, 3> events{{{wake_.get(), POLLIN, 0}, {listener_.get(), POLLIN, 0}, {-1, POLLIN, 0}}};
  if (paused) events[1].fd = -1;
  if (client_) {
    events[2].fd = client_->socket();
    if (client_->has_output()) events[2].events |= POLLOUT;
  }
  ::poll(events.data(), events.size(), client_ || paused ? kBusyWait_ms : kIdleWait_ms);
  if ((events[0].revents & POLLIN) != 0) {
    std::uint64_t count = 0;
    static_cast<void>(::read(wake_.get(), &count, sizeof count));
  }
  at_door = (events[1].revents & POLLIN) != 0;
  readable = (events[2].revents & (POLLIN | POLLHUP | POLLERR)) != 0;
}

void LabelSocket::accept_one(TimeNs now) {
  FileDescriptor socket(::accept4(listener_.get(), nullptr, nullptr, SOCK_CLOEXEC | SOCK_NONBLOCK));
  if (!socket.open()) {
    paused_until_ = now + options_.pause;  // no descriptors left, perhaps: do not spin
    return;
  }
  if (client_) {
    LabelClient(std::move(socket), options_.client, ring_, counters_, now)
        .refuse("another label source is connected; there can be one");
    paused_until_ = now + options_.pause;
    return;
  }
  client_.emplace(std::move(socket), options_.client, ring_, counters_, now);
}

void LabelSocket::serve(TimeNs now, bool readable) {
  const bool greeted_before = client_->greeted();
  Status status = readable ? client_->read(now) : Status(Done{});
  if (status && client_->wants_image()) {
    if (const RgbdFrame* image = images_.take()) client_->send_image(*image, now);
  }
  if (status) status = client_->write(now);
  if (status) status = client_->check_time(now);
  if (!status) {
    dismiss(status.error().message, now);
  } else if (!greeted_before && client_->greeted()) {
    counters_.connected.store(true, std::memory_order_relaxed);
    last_reason_.clear();
    log::info("labels: a source is connected at {}", options_.path);
  }
}

void LabelSocket::dismiss(const std::string& reason, TimeNs now) {
  if (!reason.empty()) {
    client_->refuse(reason);
    counters_.bad.fetch_add(1, std::memory_order_relaxed);
  }
  paused_until_ = now + options_.pause;
  if (client_->greeted()) {
    log::warn("labels: the source at {} is gone: {}", options_.path, reason.empty() ? "it hung up" : reason);
  } else if (!reason.empty() && reason != last_reason_) {  // one that tries again and again is told of once
    log::warn("labels: who called at {} was refused: {}", options_.path, reason);
    last_reason_ = reason;
  }
  counters_.connected.store(false, std::memory_order_relaxed);
  client_.reset();
}

}  // namespace povslam
