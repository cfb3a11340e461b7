// What povslamd and an external label source say to each other over a Unix stream socket: bytes <-> values, pure.
// docs/labels.md is the description for who writes a source. Every number is little endian, every message is
//
//   magic u32 "PVLB" | version u16 | type u16 | length u32 of what follows
//
// Nothing is read beyond the bytes given, and no length is believed before it was compared with what the type and the
// camera allow.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include "pipeline/base/result.hpp"
#include "pipeline/frames/label_frame.hpp"
#include "pipeline/frames/rgbd_frame.hpp"

namespace povslam {

inline constexpr std::uint16_t kLabelProtocolVersion = 1;
inline constexpr std::size_t kLabelHeaderBytes = 12;

enum class LabelMessage : std::uint16_t {
  hello = 1,    // source: flags u32 (bit 0: with depth), name of its class table (1 to 64 bytes, the rest)
  welcome = 2,  // daemon: width u32, height u32 of its images
  refused = 3,  // daemon: text, the reason; then it hangs up
  next = 4,     // source: nothing; asks for the newest image that it has not got yet
  image = 5,    // daemon: head (below), colour, depth if asked for
  labels = 6,   // source: head (below), classes u8, instances u16 if the format says so
};

// image: stamp i64 ns | width u32 | height u32 | format u8: 1 = RGB, 2 = grey | depth u8: 1 = follows | 0 u16 |
//        depth_scale f32 (units a metre)
// labels: stamp i64 ns of the image | width u32 | height u32 | format u8: 1 = classes, 2 = classes and instances | 0 *
// 7
inline constexpr std::size_t kLabelHeadBytes = 24;

struct LabelHeader {
  LabelMessage type = LabelMessage::hello;
  std::uint32_t length = 0;  // bytes that follow
};

struct LabelHello {
  bool with_depth = false;
  std::string table;
};

struct LabelLimits {
  int width = 0, height = 0;  // px, of the camera's images: labels are not larger
};

// bytes: kLabelHeaderBytes of them. Only what a source may say is accepted.
Result<LabelHeader> read_label_header(std::span<const std::uint8_t> bytes, const LabelLimits& limits);
// bytes: what follows the header.
Result<LabelHello> read_label_hello(std::span<const std::uint8_t> bytes);
Result<LabelFrame> read_labels(std::span<const std::uint8_t> bytes, const LabelLimits& limits);

// Append a whole message.
void write_welcome(const LabelLimits& limits, std::vector<std::uint8_t>& out);
void write_refused(const std::string& reason, std::vector<std::uint8_t>& out);
void write_image(const RgbdFrame& image, bool with_depth, std::vector<std::uint8_t>& out);

}  // namespace povslam
