#include "tools/povslam/replay_run.hpp"

#include <memory>
#include <utility>

#include "daemon/app.hpp"
#include "daemon/config_file_classes.hpp"
#include "daemon/config_file_network.hpp"
#include "daemon/stop_signal.hpp"
#include "daemon/store.hpp"
#include "drivers/gap_counter.hpp"
#include "pipeline/base/log.hpp"
#include "pipeline/pipeline.hpp"
#include "tools/povslam/progress.hpp"
#include "tools/povslam/true_poses.hpp"

namespace povslam {
namespace {

// A published pose and what its corrected one is made of.
struct Anchor {
  std::int64_t keyframe = -1;
  Rigid3 T_keyframe_camera;
};

class Recorder {
 public:
  void add(const PoseEstimate& pose, const MapSize& map) {
    ++record_.frames;
    record_.map.push_back({pose.stamp, map});
    const auto stage = [this](Stage s, float ms) { record_.stages_ms[static_cast<std::size_t>(s)].push_back(ms); };
    stage(Stage::features, pose.times.features_ms);
    stage(Stage::track, pose.times.track_ms);
    stage(Stage::keyframe, pose.times.keyframe_ms);
    stage(Stage::total, pose.times.total_ms);
    if (pose.state != TrackState::ok && pose.state != TrackState::degraded) {
      ++record_.lost;
      return;
    }
    ++record_.tracked;
    record_.published.push_back({pose.stamp, pose.T_world_camera});
    anchors_.push_back({pose.reference_keyframe, pose.T_reference_camera});
  }

  void add_backend(const BackendJob& job, double ms) {
    Stage stage = std::holds_alternative<LoopProblem*>(job) ? Stage::close_loop : Stage::smooth;
    if (std::holds_alternative<VemProblem*>(job)) stage = Stage::vem;
    record_.stages_ms[static_cast<std::size_t>(stage)].push_back(static_cast<float>(ms));
  }

  // With true poses these are what there is to be known of a frame.
  void add_true(TimeNs stamp, const Rigid3& T_world_camera) { true_.push_back({stamp, T_world_camera}); }

  void add_understood(const Understood& done) {
    const auto stage = [this](Stage s, float ms) { record_.stages_ms[static_cast<std::size_t>(s)].push_back(ms); };
    stage(Stage::segment, done.times.segment_ms);
    if (done.times.asked) stage(Stage::name, done.times.name_ms);
    stage(Stage::associate, done.times.associate_ms);
    stage(Stage::integrate, done.times.integrate_ms);
    ++record_.views_understood;
    add_events(done);
  }
  void add_events(const Understood& done) {
    record_.events.insert(record_.events.end(), done.events.begin(), done.events.end());
  }

  void add_world(Understanding& understanding) {
    record_.objects = understanding.objects();
    record_.labels = understanding.labels();
    record_.naming = understanding.naming();
    if (record_.naming.failed > 0) log::warn("the network that names things failed: {}", understanding.naming_error());
    understanding.mesh(record_.mesh);
  }

  // Corrected poses from where the keyframes are now; a frame whose keyframe is unknown keeps its published pose.
  void correct(const Pipeline& pipeline) {
    record_.loops = pipeline.loops();
    record_.vem = pipeline.vem();
    record_.smoothed = record_.published;
    for (std::size_t i = 0; i < anchors_.size(); ++i) {
      const std::optional<Rigid3> T_world_keyframe = pipeline.keyframe_pose(anchors_[i].keyframe);
      if (T_world_keyframe) record_.smoothed[i].T_world_sensor = *T_world_keyframe * anchors_[i].T_keyframe_camera;
    }
    if (true_.empty()) return;
    record_.published = record_.smoothed = true_;
  }

  ReplayRecord& record() { return record_; }

 private:
  ReplayRecord record_;
  std::vector<Anchor> anchors_;
  std::vector<StampedPose> true_;
};

class RecordingSink : public Sink {
 public:
  RecordingSink(Recorder& recorder, Progress& progress) : recorder_(recorder), progress_(progress) {}
  void on_frame(const TrackedFrame& frame) override {
    recorder_.add(frame.pose, frame.map);
    progress_.step();
  }
  void on_event(const ObjectEvent& event) override { recorder_.record().events.push_back(event); }

 private:
  Recorder& recorder_;
  Progress& progress_;
};

// The journey in one thread: background jobs are solved when they are asked for.
class SingleThread {
 public:
  SingleThread(const ReplaySettings& settings, const SensorCalibration& calibration, const Rigid3& T_world_body,
               ClassTable classes, std::unique_ptr<SegmentNamer> namer, OpenedStore* map)
      : backend_options_(settings.config.pipeline.backend),
        store_(map == nullptr ? nullptr : &map->store),
        pipeline_(pipeline_options(settings), calibration, T_world_body, begun_with(map)),
        true_poses_(settings.true_poses),
        view_period_(from_seconds(settings.config.pipeline.understanding.period_s)) {
    if (settings.config.pipeline.understanding.labels == "off") return;
    understanding_.emplace(settings.config.pipeline.understanding, calibration, std::move(classes),
                           map == nullptr ? nullptr : &map->world, std::move(namer));
    understanding_->keep_loose_surface();
    pipeline_.take_restored(*understanding_);
  }

  void track(const RgbdFrame& frame, Recorder& recorder) {
    const TimeNs begun = thread_cpu_now();
    const PoseEstimate& pose = pipeline_.localise(frame);
    recorder.add(pose, pipeline_.map_size());
    tracking_cpu_ += thread_cpu_now() - begun;
    while (const auto job = pipeline_.take_job()) run(*job, recorder);
    if (store_ != nullptr) store(pipeline_.take_change(), understanding_ ? understanding_->take_change() : nullptr);
    if (true_poses_.empty()) {
      if (understanding_ && pipeline_.view_due()) understand_from(frame, std::nullopt, recorder);
    } else if (const auto T_world_camera = true_poses_.at(frame.stamp)) {
      recorder.add_true(frame.stamp, *T_world_camera);
      if (understanding_ && frame.stamp >= next_true_view_) understand_from(frame, T_world_camera, recorder);
    }
  }

  void take(const LabelFrame& labels, Recorder& recorder) {
    if (!understanding_) return;
    understanding_->add(labels);
    understand(recorder);
  }

  void understand_rest(Recorder& recorder) {
    if (!understanding_) return;
    understanding_->stop_waiting();
    understand(recorder);
    recorder.add_events(understanding_->finish());
    recorder.add_world(*understanding_);
  }

  void store_rest() {
    if (store_ != nullptr) {
      store(pipeline_.collect_change(), understanding_ ? understanding_->collect_change() : nullptr);
    }
  }
  const std::string& store_failure() const { return store_failure_; }  // empty: none

  const Pipeline& pipeline() const { return pipeline_; }
  TimeNs tracking_cpu() const { return tracking_cpu_; }

 private:
  void understand_from(const RgbdFrame& frame, const std::optional<Rigid3>& T_world_camera, Recorder& recorder) {
    pipeline_.fill_view(frame, view_);
    if (T_world_camera) {
      view_.T_world_camera = *T_world_camera;
      view_.trusted = true;
      view_.reference_keyframe = -1;  // the truth needs no correction
      view_.corrections.clear();
      next_true_view_ = frame.stamp + view_period_;
    }
    understanding_->add(std::move(view_));
    understand(recorder);
  }
  void understand(Recorder& recorder) {
    while (const Understood* done = understanding_->step()) {
      recorder.add_understood(*done);
      pipeline_.take_owners(done->owners);
      pipeline_.take_beliefs(done->beliefs);
    }
  }

  void run(const BackendJob& job, Recorder& recorder) {
    const TimeNs begun = thread_cpu_now();
    solve(job, backend_options_);
    recorder.add_backend(job, to_ms(thread_cpu_now() - begun));
    pipeline_.give_back(job);
  }

  void store(MapChange* map, WorldChange* world) {
    if (map == nullptr && world == nullptr) return;
    const Result<CommitReport> done = store_->commit(map, world);
    if (!done && store_failure_.empty()) store_failure_ = done.error().message;
    if (done && done->rows_left_out > 0) log::warn("{} rows not stored: {}", done->rows_left_out, done->why_left_out);
    if (map != nullptr) pipeline_.give_back(map);
    if (world != nullptr) understanding_->give_back(world);
  }

  // Objects that stand in the true world say nothing of where tracking's is.
  static PipelineOptions pipeline_options(const ReplaySettings& settings) {
    PipelineOptions options = settings.config.pipeline;
    if (!settings.true_poses.empty()) options.mode = "static";
    return options;
  }
  static const MapContent* begun_with(const OpenedStore* map) {
    return map != nullptr && map->content.meta.next_keyframe > 0 ? &map->content : nullptr;
  }

  BackendOptions backend_options_;
  MapStore* store_;
  std::string store_failure_;
  Pipeline pipeline_;
  std::optional<Understanding> understanding_;
  View view_;
  TruePoses true_poses_;
  TimeNs view_period_, next_true_view_ = 0;
  TimeNs tracking_cpu_ = 0;
};

struct Clocks {
  TimeNs wall = monotonic_now(), cpu = process_cpu_now();
  void stop(ReplayRecord& record) const {
    record.wall_s = to_seconds(monotonic_now() - wall);
    record.cpu_s = to_seconds(process_cpu_now() - cpu);
  }
};

// Frames of the main camera until the stream ends, fails or a signal comes.
void feed(Driver& driver, SingleThread& journey, Recorder& recorder, Progress& progress, StopSignal& stop) {
  ReplayRecord& record = recorder.record();
  SensorFrame frame;
  TimeNs feeder_cpu = 0;
  GapCounter gaps;
  const auto drop = [&record](DropReason reason, std::int64_t count = 1) {
    record.drops[static_cast<std::size_t>(reason)] += count;
  };
  while (!stop.stopped() && journey.store_failure().empty()) {
    const TimeNs begun = thread_cpu_now();
    const Next next = driver.next(frame);
    feeder_cpu += thread_cpu_now() - begun;
    if (next.kind == Next::Kind::end) break;
    if (next.kind == Next::Kind::failed) {
      record.failure = next.message;
      break;
    }
    if (next.kind == Next::Kind::bad) {
      log::warn("{}", next.message);
      drop(DropReason::bad_frame);
      gaps.bad();
    } else if (frame.kind == SensorKind::labels) {
      journey.take(frame.labels, recorder);
    } else if (frame.kind != SensorKind::rgbd || frame.sensor != 0) {
      drop(DropReason::unused);
    } else {
      drop(DropReason::gap, gaps.missing_before(frame.rgbd.seq));
      journey.track(frame.rgbd, recorder);
      progress.step();
    }
  }
  if (stop.stopped()) record.failure = "interrupted";
  record.feeder_cpu_s = to_seconds(feeder_cpu);
}

}  // namespace

Result<ReplayRecord> replay_in_one_thread(const ReplaySettings& settings, Driver& driver) {
  const Clocks clocks;
  StopSignal stop;
  Result<DriverSetup> setup = driver.open();
  if (!setup) return setup.error();
  SensorCalibration calibration = setup->sensors[0];
  calibration.T_body_sensor = mount_of(settings.config.sensors[0], calibration);
  const Rigid3 T_world_body = settings.T_world_camera_start
                                  ? *settings.T_world_camera_start * calibration.T_body_sensor.inverse()
                                  : settings.config.start.rigid();
  std::optional<OpenedStore> map;
  if (!settings.map.empty()) {
    Result<OpenedStore> opened = open_or_quarantine(settings.map);
    if (!opened) return Error{"--map " + opened.error().message};
    map.emplace(std::move(*opened));
  }
  Result<ClassTable> classes = choose_class_table(settings.config.labels, setup->label_table);
  if (!classes) return classes.error();
  ReplaySettings chosen = settings;
  std::string& labels = chosen.config.pipeline.understanding.labels;
  if (labels == "auto") labels = setup->label_table ? "replay" : "geometric";
  std::unique_ptr<SegmentNamer> namer;
  if (labels == "dnn") {
    auto loaded = load_namer(chosen.config);
    if (!loaded) return loaded.error();
    namer = std::move(*loaded);
  }
  SingleThread journey(chosen, calibration, T_world_body, std::move(*classes), std::move(namer), map ? &*map : nullptr);
  Recorder recorder;
  {
    Progress progress("replay", setup->num_frames.value_or(0));
    feed(driver, journey, recorder, progress, stop);
  }
  driver.close();
  journey.understand_rest(recorder);
  journey.store_rest();
  if (!journey.store_failure().empty()) recorder.record().failure = journey.store_failure();
  recorder.correct(journey.pipeline());
  recorder.record().tracking_cpu_s = to_seconds(journey.tracking_cpu());
  clocks.stop(recorder.record());
  return std::move(recorder.record());
}

Result<ReplayRecord> replay_in_real_time(const ReplaySettings& settings, std::unique_ptr<Driver> driver) {
  const Clocks clocks;
  StopSignal stop;
  Recorder recorder;
  Progress progress("replay in real time", 0);
  RecordingSink sink(recorder, progress);
  std::atomic<bool> ended{false};
  AppOptions options;
  options.driver = std::move(driver);
  options.sinks = {&sink};
  options.T_world_camera_start = settings.T_world_camera_start;
  options.map_store = settings.map;
  options.mesh_wanted = true;
  options.on_end = [&stop, &ended] {
    ended = true;
    stop.request();
  };
  auto app = App::start(settings.config, std::move(options));
  if (!app) return app.error();
  stop.wait();
  (*app)->stop();
  ReplayRecord& record = recorder.record();
  recorder.correct((*app)->pipeline());
  if (Understanding* understanding = (*app)->understanding()) recorder.add_world(*understanding);
  const Counters& counters = (*app)->counters();
  for (std::size_t i = 0; i < kNumDropReasons; ++i) record.drops[i] = counters.drops[i].load();
  record.tracking_cpu_s = to_seconds(counters.tracking_cpu.load());
  record.feeder_cpu_s = to_seconds(counters.feeder_cpu.load());
  record.labels_dropped = counters.labels_dropped.load();
  record.views_dropped = counters.views_dropped.load();
  record.views_understood = counters.views.load();  // what was handed over is understood before the end
  if (!ended) record.failure = "interrupted";
  clocks.stop(record);
  return std::move(record);
}

}  // namespace povslam
