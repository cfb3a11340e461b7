// Writes a recorded sequence: a folder in the layout of the TUM RGB-D benchmark with optional extras.
#pragma once

#include <Eigen/Core>
#include <filesystem>
#include <fstream>
#include <map>
#include <span>
#include <string>
#include <vector>

#include "drivers/synthetic/surface.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/frames/calibration.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/frames/lidar_frame.hpp"
#include "pipeline/frames/rgbd_frame.hpp"

namespace povslam {

class SequenceWriter {
 public:
  // Makes the folder. One that is not empty is refused; with `force` an earlier sequence written by this class gives
  // way, anything else is still refused.
  static Result<SequenceWriter> create(const std::filesystem::path& folder, bool force);

  Status write_calibration(const SensorCalibration& camera, std::span<const SensorCalibration> others);
  Status add(const RgbdFrame& frame, const Rigid3& T_world_camera);
  void add_truth(TimeNs stamp, const Rigid3& T_world_camera);  // done by the one above already
  Status add(const LabelFrame& labels, std::uint64_t seq);
  Status add(const LidarFrame& scan);
  Status write_text(const std::string& name, const std::string& text);
  // PLY, binary little endian, with normals.
  Status write_points(const std::string& name, std::span<const synthetic::SurfacePoint> points);
  Status finish();  // closes the lists; says whether all of them reached the disk

 private:
  explicit SequenceWriter(std::filesystem::path folder) : folder_(std::move(folder)) {}
  std::ofstream& list(const std::string& name, const char* header);
  Status make_folder(const std::string& name);

  std::filesystem::path folder_;
  std::map<std::string, std::ofstream> lists_;
};

}  // namespace povslam
