// povslam.label_image_t, from the bytes of a datagram to labels. Decoded here and not by what lcm-gen makes, which
// believes the lengths it is told: anybody on the network can send a datagram.
#pragma once

#include <cstdint>
#include <span>
#include <string>

#include "daemon/label_protocol.hpp"
#include "pipeline/base/result.hpp"
#include "pipeline/frames/label_frame.hpp"

namespace povslam {

struct LabelImage {
  LabelFrame labels;
  std::string robot_id;
};

// labels.produced stays 0. An error says what is wrong with the message.
Result<LabelImage> read_label_image(std::span<const std::uint8_t> bytes, const LabelLimits& limits);

}  // namespace povslam
