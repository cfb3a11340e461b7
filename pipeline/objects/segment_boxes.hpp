// What a detector says about an image, and how YOLOX (Ge et al., 2021) writes it down.
#pragma once

#include <span>
#include <vector>

namespace povslam {

struct DetectedBox {
  int class_index = -1;                                   // of the network's own list
  float score = 0.0F;                                     // [0, 1]
  float x = 0.0F, y = 0.0F, width = 0.0F, height = 0.0F;  // px of the image, (x, y): top left corner

  float area() const { return width * height; }
};

float intersection_over_union(const DetectedBox& a, const DetectedBox& b);

struct BoxOptions {
  double min_score = 0.3;
  double max_overlap = 0.45;  // of two boxes of one class; the weaker is a double
};

// rows: for strides 8, 16, 32 the cells of a square input of input_px row by row, each x, y, log width, log height,
// objectness, then num_classes scores. scale: input pixels per image pixel. Rows that are not as many as that, or that
// hold no numbers, give no boxes. Best first.
std::vector<DetectedBox> decode_yolox(std::span<const float> rows, int input_px, int num_classes, float scale,
                                      const BoxOptions& options);

}  // namespace povslam
