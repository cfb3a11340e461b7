#include "tools/povslam/simulate.hpp"

#include <CLI/CLI.hpp>
#include <cstdio>
#include <memory>
#include <nlohmann/json.hpp>

#include "drivers/synthetic/lidar.hpp"
#include "drivers/synthetic/renderer.hpp"
#include "drivers/synthetic/surface.hpp"
#include "drivers/synthetic/synthetic_driver.hpp"
#include "drivers/synthetic/world.hpp"
#include "tools/povslam/progress.hpp"
#include "tools/povslam/sequence_writer.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {

namespace {

using synthetic::World;

constexpr double kSurfaceSpacing_m = 0.02;
constexpr double kSimulateFps = 15.0;

nlohmann::json vector_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

nlohmann::json placement_json(const synthetic::Placement& place) {
  return {{"present", place.present}, {"position", vector_json(place.position)}, {"yaw", place.yaw}};
}

// Structure (walls, racks) and people are no objects of the truth: neither can be an event of change.
std::string truth_json(const World& world) {
  const double t0 = to_seconds(world.start_stamp());
  nlohmann::json objects = nlohmann::json::array();
  for (const synthetic::Object& object : world.scene().objects) {
    const auto& row = synthetic::class_table()[static_cast<std::size_t>(object.class_id)];
    if (std::string(row.kind) != "semi_static") continue;
    objects.push_back({{"id", object.id},
                       {"class", row.name},
                       {"size", vector_json(object.size_m)},
                       {"change", to_string(object.change())},
                       {"switch_time", t0 + object.switch_time_s},
                       {"before", placement_json(object.before)},
                       {"after", placement_json(object.after)}});
  }
  return nlohmann::json{{"t0", t0}, {"lap1_end", t0 + world.lap_end_s(1.0)}, {"objects", objects}}.dump(1) + "\n";
}

std::string classes_csv() {
  std::string text = "id,name,kind\n";
  for (const synthetic::ClassRow& row : synthetic::class_table()) {
    text += std::to_string(static_cast<int>(row.id)) + "," + row.name + "," + row.kind + "\n";
  }
  return text;
}

Status write_truth(SequenceWriter& writer, const World& world) {
  const bool lidar = world.options().lidar;
  const std::vector<SensorCalibration> sensors = synthetic::sensor_calibrations(world.options());
  std::vector<SensorCalibration> others;
  for (const SensorCalibration& sensor : sensors) {
    if (lidar && sensor.kind == SensorKind::lidar) others.push_back(sensor);
  }
  Status status = writer.write_calibration(sensors.front(), others);
  if (status) status = writer.write_text("objects_truth.json", truth_json(world));
  if (status && world.options().labels) status = writer.write_text("classes.csv", classes_csv());
  if (status)
    status = writer.write_points("final_surface.ply", synthetic::final_surface(world.scene(), kSurfaceSpacing_m));
  return status;
}

void write_poses(SequenceWriter& writer, const World& world) {
  for (std::uint64_t seq = 0; seq < world.num_frames(); ++seq) {
    const TimeNs time = world.frame_time(seq);
    writer.add_truth(world.start_stamp() + time, world.T_world_camera(to_seconds(time)));
  }
}

Status write_frames(SequenceWriter& writer, const World& world) {
  synthetic::Renderer renderer(world);
  RgbdFrame frame;
  LabelFrame labels;
  Progress progress("simulate " + world.options().scene, world.num_frames());
  for (frame.seq = 0; frame.seq < world.num_frames(); ++frame.seq) {
    const double time_s = to_seconds(world.frame_time(frame.seq));
    renderer.render_at(time_s, frame);
    frame.stamp = frame.depth_stamp = labels.stamp = world.start_stamp() + world.frame_time(frame.seq);
    Status status = writer.add(frame, world.T_world_camera(time_s));
    if (status && world.options().labels) {
      renderer.label(labels);
      status = writer.add(labels, frame.seq);
    }
    if (!status) return status;
    progress.step();
  }
  return Done{};
}

Status write_scans(SequenceWriter& writer, const World& world) {
  synthetic::Lidar lidar(world);
  LidarFrame scan;
  const TimeNs end = world.frame_time(world.num_frames() - 1), period = from_seconds(1.0 / synthetic::Lidar::kRate_hz);
  for (scan.seq = 0; static_cast<TimeNs>(scan.seq) * period <= end; ++scan.seq) {
    const TimeNs time = static_cast<TimeNs>(scan.seq) * period;
    lidar.scan(to_seconds(time), scan);
    scan.stamp = world.start_stamp() + time;
    const Status status = writer.add(scan);
    if (!status) return status;
  }
  return Done{};
}

int failed(const Error& error, int code) {
  std::fprintf(stderr, "povslam simulate: %s\n", error.message.c_str());
  return code;
}

}  // namespace

int run_simulate(const SimulateOptions& options) {
  if (options.out.empty()) return failed({"--out is empty; give a folder"}, 2);
  const Status valid = synthetic::validate(options.world);
  if (!valid) return failed(valid.error(), 2);
  const Result<World> world = World::create(options.world);
  if (!world) return failed(world.error(), 2);
  Result<SequenceWriter> writer = SequenceWriter::create(options.out, options.force);
  if (!writer) return failed(writer.error(), 2);
  Status status = write_truth(*writer, *world);
  if (options.truth_only) {
    write_poses(*writer, *world);
    if (status) status = writer->finish();
    return status ? 0 : failed(status.error(), 1);
  }
  if (status) status = write_frames(*writer, *world);
  if (status && options.world.lidar) status = write_scans(*writer, *world);
  if (status) status = writer->finish();
  return status ? 0 : failed(status.error(), 1);
}

void add_simulate(CLI::App& app, int& exit_code) {
  struct Given {
    DriverOptions keys;
    SimulateOptions simulate;
  };
  auto given = std::make_shared<Given>();
  CLI::App* command = app.add_subcommand("simulate", "Write a simulated sequence with ground truth");
  command->add_flag("--truth-only", given->simulate.truth_only, "Write the ground truth, but no images and scans");
  const auto key = [&](const std::string& name, const std::string& help) {
    command->add_option_function<std::string>(
        "--" + name, [given, name](const std::string& text) { given->keys[name] = text; }, help);
  };
  command
      ->add_option("scene", given->keys["scene"], "boxsim, static, aisle, majority, adversarial, twins, rooms or hall")
      ->required();
  command->add_option("--out", given->simulate.out, "Folder to write")->required();
  command->add_flag("--force", given->simulate.force, "Replace an earlier simulated sequence in --out");
  key("seed", "Another world of the same kind (1)");
  key("laps", "Laps to drive (2)");
  key("width", "Camera's image, pixels (640)");
  key("height", "Camera's image, pixels (480)");
  for (const char* name : {"fx", "fy"}) key(name, "Focal length, pixels (525 for a width of 640)");
  for (const char* name : {"cx", "cy"}) key(name, "Principal point, pixels (the image's middle)");
  key("fps", "Camera frames a second (15)");
  key("speed_mps", "Speed of the robot, m/s (0.6)");
  key("noise", "Factor on all sensor noise, 0: perfect images (1)");
  key("noise_seed", "Other noise in the same world (0: as the seed says)");
  key("max_depth_m", "Depth beyond it reads 0 (8)");
  key("changes", "false: nothing moves, goes or comes after the first lap (true)");
  key("movers", "People walking about (0)");
  key("start_time_s", "Stamp of the first frame (0)");
  key("frames", "Stop after so many frames (0: all laps)");
  const auto flag = [&](const std::string& name, const std::string& help) {
    command->add_flag_function(
        "--" + name, [given, name](std::int64_t) { given->keys[name] = "true"; }, help);
  };
  flag("blur", "Blur images as the camera moves while it exposes");
  flag("labels", "Write class labels and instances of each pixel, too");
  flag("lidar", "Write scans of a spinning LiDAR, too");
  command->callback([given, &exit_code] {
    given->keys.try_emplace("fps", std::to_string(kSimulateFps));
    const Result<synthetic::SyntheticOptions> world = synthetic::parse_options(given->keys);
    if (!world) {
      exit_code = failed(world.error(), 2);
      return;
    }
    given->simulate.world = *world;
    exit_code = run_simulate(given->simulate);
  });
}

}  // namespace povslam
