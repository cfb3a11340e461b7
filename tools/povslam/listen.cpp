// povslam listen: what the daemon says over LCM, on the terminal and into a trajectory file.
#include "tools/povslam/listen.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cmath>
#include <cstdio>
#include <lcm/lcm-cpp.hpp>
#include <memory>

#include "daemon/config_file.hpp"
#include "daemon/messages/channels.hpp"
#include "daemon/stop_signal.hpp"
#include "pipeline/frames/calibration.hpp"
#include "tools/povslam/message_text.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

double percentile(std::vector<double> values, double share) {
  std::sort(values.begin(), values.end());
  const auto rank = static_cast<std::size_t>(std::ceil(share * static_cast<double>(values.size())));
  return values[std::max<std::size_t>(rank, 1) - 1];
}

Rigid3 pose_of(const double* position, const double* wxyz) {
  return {Eigen::Quaterniond(wxyz[0], wxyz[1], wxyz[2], wxyz[3]).normalized(), {position[0], position[1], position[2]}};
}

}  // namespace

Listener::Listener(const ListenOptions& options) : options_(options) {}

bool Listener::shows(const char* channel) const {
  return options_.channel.empty() || options_.channel == channel;
}

bool Listener::due(TimeNs& last_shown) const {
  const TimeNs now = monotonic_now();
  if (options_.rate_hz <= 0.0 || now - last_shown < from_seconds(1.0 / options_.rate_hz)) return false;
  last_shown = now;
  return true;
}

void Listener::on_pose(const pose_t& message) {
  ++poses_;
  latency_ms_.push_back(message.latency_s * 1e3);
  const double transport_s = static_cast<double>(wall_now() / kNsPerUs - message.sent_utime) * 1e-6;
  receipt_ms_.push_back((message.latency_s + transport_s) * 1e3);
  const bool changed = state_ != message.state;
  state_ = message.state;
  const bool tracked = message.state == pose_t::OK || message.state == pose_t::DEGRADED;
  if (tracked) {
    const Rigid3 T_world_body = pose_of(message.world_body_position, message.world_body_quaternion);
    trajectory_.push_back({message.utime * kNsPerUs, T_world_body * options_.T_body_tracked});
  }
  if (shows(kPoseChannel) && (changed || due(pose_shown_))) std::printf("%s\n", pose_line(message).c_str());
}

void Listener::on_bot_core_pose(const bot_core::pose_t& message) {
  if (options_.channel == kBotCorePoseChannel && due(bot_core_shown_)) {
    std::printf("%s\n", bot_core_pose_line(message).c_str());
  }
}

void Listener::on_health(const health_t& message) {
  if (shows(kHealthChannel)) std::printf("%s\n", health_line(message).c_str());
}

void Listener::on_event(const object_event_t& message) {
  if (!shows(kObjectEventChannel)) return;
  if (message.session_id == event_session_ && next_event_ >= 0 && message.seq > next_event_) {
    std::printf("%lld events missed: the datagrams were lost\n", static_cast<long long>(message.seq - next_event_));
  }
  event_session_ = message.session_id;
  next_event_ = message.seq + 1;
  std::printf("%s\n", event_line(message).c_str());
}

void Listener::on_objects(const object_list_t& message) {
  const std::optional<std::vector<object_t>> objects = snapshots_.add(message);
  if (!objects) return;
  const bool all = options_.channel == kObjectsChannel;
  const bool changed = num_objects_ != objects->size();
  num_objects_ = objects->size();
  if (!all && !(changed && options_.channel.empty())) return;
  std::printf("%14.3f s  %s objects: %zu\n", static_cast<double>(message.utime) * 1e-6, message.robot_id.c_str(),
              objects->size());
  for (const object_t& object : *objects) {
    if (all) std::printf("%s\n", object_line(object).c_str());
  }
}

Status Listener::finish() const {
  if (poses_ > 0) {
    std::printf(
        "%zu poses; latency p50 %.1f p99 %.1f ms from frame to hand-over, p50 %.1f p99 %.1f ms from frame to here\n",
        poses_, percentile(latency_ms_, 0.5), percentile(latency_ms_, 0.99), percentile(receipt_ms_, 0.5),
        percentile(receipt_ms_, 0.99));
  }
  if (options_.out.empty()) return Done{};
  // A daemon that was restarted, or two robots on one bus, would mix two clocks in one file.
  const bool ordered = std::is_sorted(trajectory_.begin(), trajectory_.end(),
                                      [](const StampedPose& a, const StampedPose& b) { return a.stamp < b.stamp; });
  if (!ordered)
    return Error{options_.out + ": stamps went back while listening: more than one daemon, or one restarted?"};
  return write_trajectory(options_.out, trajectory_);
}

namespace {

using Buffer = const lcm::ReceiveBuffer*;

// Functions and not LCM's handler methods: GCC 12 with both address and undefined sanitizers miscompiles the latter.
void subscribe(lcm::LCM& lcm, Listener& listener) {
  lcm.subscribeFunction<pose_t, Listener*>(
      kPoseChannel, [](Buffer, const std::string&, const pose_t* m, Listener* l) { l->on_pose(*m); }, &listener);
  lcm.subscribeFunction<bot_core::pose_t, Listener*>(
      kBotCorePoseChannel,
      [](Buffer, const std::string&, const bot_core::pose_t* m, Listener* l) { l->on_bot_core_pose(*m); }, &listener);
  lcm.subscribeFunction<health_t, Listener*>(
      kHealthChannel, [](Buffer, const std::string&, const health_t* m, Listener* l) { l->on_health(*m); }, &listener);
  lcm.subscribeFunction<object_event_t, Listener*>(
      kObjectEventChannel, [](Buffer, const std::string&, const object_event_t* m, Listener* l) { l->on_event(*m); },
      &listener);
  lcm.subscribeFunction<object_list_t, Listener*>(
      kObjectsChannel, [](Buffer, const std::string&, const object_list_t* m, Listener* l) { l->on_objects(*m); },
      &listener);
}

int complain(const std::string& message, int exit_code) {
  std::fprintf(stderr, "povslam listen: %s\n", message.c_str());
  return exit_code;
}

int listen(const ListenOptions& options) {
  lcm::LCM lcm(options.url);
  if (!lcm.good()) return complain("LCM cannot use " + options.url + "; is there a multicast route?", 1);
  std::setvbuf(stdout, nullptr, _IOLBF, 0);
  StopSignal stop;
  Listener listener(options);
  subscribe(lcm, listener);
  TimeNs last_message = monotonic_now();
  bool silent = false;
  while (!stop.stopped() && !silent && (options.count == 0 || listener.poses() < options.count)) {
    const int handled = lcm.handleTimeout(100);
    if (handled < 0) break;  // the end of a log file
    if (handled > 0) last_message = monotonic_now();
    silent = options.timeout_s > 0.0 && to_seconds(monotonic_now() - last_message) > options.timeout_s;
  }
  const Status done = listener.finish();
  if (!done) return complain(done.error().message, 1);
  return silent ? complain("nothing came for the time of --timeout-s", 1) : 0;
}

int run(ListenOptions options, const std::string& camera) {
  if (!camera.empty()) {
    const Result<Rigid3> T = camera == "forward" ? Result<Rigid3>(level_forward_camera()) : parse_pose(camera);
    if (!T) return complain("--camera " + T.error().message, 2);
    options.T_body_tracked = *T;
  }
  return listen(options);
}

}  // namespace

void add_listen(CLI::App& app, int& exit_code) {
  CLI::App* command = app.add_subcommand("listen", "Poses, objects, events and health of a running povslamd");
  const auto options = std::make_shared<ListenOptions>();
  const auto camera = std::make_shared<std::string>();
  command->add_option("--lcm-url", options->url, "LCM URL, as the daemon's lcm.url")->capture_default_str();
  command->add_option("--channel", options->channel, "Show this channel only")
      ->check(CLI::IsMember({kPoseChannel, kHealthChannel, kObjectEventChannel, kObjectsChannel, kBotCorePoseChannel}));
  command->add_option("--rate", options->rate_hz, "Poses shown per second at most; changes of state at once")
      ->capture_default_str()
      ->check(CLI::NonNegativeNumber);
  command->add_option("--count", options->count, "Stop after so many poses");
  command->add_option("--timeout-s", options->timeout_s, "Fail when nothing came for so long");
  command->add_option("--out", options->out, "Write tracked poses here: TUM lines of T_world_body");
  command->add_option("--camera", *camera,
                      "With --out: \"x y z qx qy qz qw\" of T_body_camera, or `forward`; writes T_world_camera");
  command->callback([options, camera, &exit_code] { exit_code = run(*options, *camera); });
}

}  // namespace povslam
