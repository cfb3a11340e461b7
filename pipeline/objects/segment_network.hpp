// A detector of common things (YOLOX-nano, or another YOLOX in ONNX without decoding) through OpenCV's DNN.
//
// Slow (0.15 core seconds an image): not for the tracking thread. A file that is broken in odd ways can crash OpenCV's
// importer: try it in another process first (daemon/config_file_network). One thread at a time.
#pragma once

#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/frames/image.hpp"
#include "pipeline/objects/segment_boxes.hpp"

namespace povslam {

// Class indices are those of the model: COCO's 80 classes in the usual order for the published ones.
class SegmentNetwork {
 public:
  // onnx: the content of the model's file. input_px: edge of the square input it was exported for, a multiple of 32.
  // Runs the network once, so that a model of another kind is refused here and the first image takes no longer than
  // others. The error's message lacks the file's name: the caller knows it.
  static Result<SegmentNetwork> load(std::span<const std::uint8_t> onnx, const BoxOptions& options, int input_px = 416);
  SegmentNetwork(SegmentNetwork&&) noexcept;
  SegmentNetwork& operator=(SegmentNetwork&&) noexcept;
  ~SegmentNetwork();

  // color: grey or R, G, B, any size. An error is the library's; the network can be asked again.
  Result<std::vector<DetectedBox>> detect(const ImageU8& color);

  int num_classes() const;

  // How many threads OpenCV may use for whatever it does: one setting for the process.
  static void limit_threads(int count);

 private:
  struct Impl;
  explicit SegmentNetwork(std::unique_ptr<Impl> impl);
  std::unique_ptr<Impl> impl_;
};

}  // namespace povslam
