// What the configuration says, as plain values. config_file reads it, config_keys describes every key.
#pragma once

#include <array>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include "drivers/driver.hpp"
#include "pipeline/options.hpp"

namespace povslam {

struct PoseConfig {
  std::array<double, 3> translation_m{};
  std::array<double, 4> q_xyzw{0.0, 0.0, 0.0, 1.0};  // unit

  Rigid3 rigid() const;
};

struct SensorConfig {
  std::string name = "front";
  std::string driver;
  std::array<double, 3> translation_m{};
  // At most one of the two; neither: a camera level and forward.
  std::optional<std::array<double, 4>> q_xyzw;  // of T_body_sensor as it is
  std::optional<std::array<double, 3>>
      rpy_deg;             // roll, pitch, yaw of the housing (x out of the lens, z up) in the body
  bool has_mount = false;  // any of the three was given
  DriverOptions options;   // every other key of the table

  std::string where;                                // "file:line" of the table
  std::map<std::string, std::string> option_where;  // and of `driver` and each option

  Rigid3 T_body_sensor() const;
  // A driver's complaint about its options, with the place it stands at.
  std::string locate(const std::string& message) const;
};

struct LcmConfig {
  std::string url = "udpm://239.255.76.67:7667?ttl=0";
  std::string robot_id = "robot";
};

struct LogConfig {
  std::string level = "info";
  std::string file;  // empty: standard error only
};

struct DaemonConfig {
  int frame_slots = 6;            // frames in flight between a sensor and tracking
  double health_period_s = 1.0;   // also how often the watchdog is fed
  double objects_period_s = 2.0;  // between two lists of all objects
  bool exit_at_end = true;        // stop once a source that ends (a recording) has ended
};

struct MapConfig {
  std::string store = "auto";  // file; empty: none; auto: see store_file()
};

// Where map.store says the map is; `state_folder`: what systemd gives a service ($STATE_DIRECTORY), or null.
std::string store_file(const MapConfig& config, const char* state_folder);

struct LabelConfig {
  std::string socket;            // path a label source connects to; empty: off
  std::string lcm_channel;       // empty: off
  std::string classes = "auto";  // built-in table or file; auto: see choose_class_table(), load_namer()
};

struct NetworkConfig {
  std::string file;  // weights of the network that names segments (understanding.labels = "dnn")
};

struct AppConfig {
  LcmConfig lcm;
  LogConfig log;
  DaemonConfig daemon;
  LabelConfig labels;
  NetworkConfig network;
  PoseConfig start;  // T_world_body at the first frame
  MapConfig map;
  PipelineOptions pipeline;
  std::vector<SensorConfig> sensors;
};

}  // namespace povslam
