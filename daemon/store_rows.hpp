// One row of the map as bytes and back. Each begins with the version of its layout, so that rows of different age lie
// in one store. Reading accepts exactly what writing makes: lengths that fit, numbers that mean something.
#pragma once

#include <optional>
#include <string>

#include "daemon/store_bytes.hpp"
#include "pipeline/frontend/map_rows.hpp"

namespace povslam {

// What is wrong with a row's values, nothing when they can be: finite, unit quaternions, one length, ids below the
// first unused one.
std::optional<std::string> fault_in(const MapMeta& meta);
std::optional<std::string> fault_in(const KeyframeFeatures& row, const MapMeta& meta);
std::optional<std::string> fault_in(const KeyframeRow& row, const MapMeta& meta);
std::optional<std::string> fault_in(const LandmarkRow& row, const MapMeta& meta);
std::optional<std::string> fault_in(const LandmarkLook& row, const MapMeta& meta);

// The store's own beside the map's: when it was made and last written.
struct StoredMeta {
  MapMeta map;
  std::uint64_t commits = 0;
  TimeNs created = 0;    // wall clock
  TimeNs committed = 0;  // wall clock, of the last commit
};

// Replace what is in `out`.
void write_row(const StoredMeta& row, Bytes& out);
void write_row(const KeyframeFeatures& row, Bytes& out);
void write_row(const KeyframeRow& row, Bytes& out);
void write_row(const LandmarkRow& row, Bytes& out);
void write_row(const LandmarkLook& row, Bytes& out);

// Nothing when the bytes are not such a row (its values are for fault_in to judge). Allocates no more than a small
// multiple of the bytes given.
std::optional<StoredMeta> read_meta(std::span<const std::uint8_t> bytes);
std::optional<KeyframeFeatures> read_features(std::int64_t id, std::span<const std::uint8_t> bytes);
std::optional<KeyframeRow> read_keyframe(std::int64_t id, std::span<const std::uint8_t> bytes);
std::optional<LandmarkRow> read_landmark(std::int64_t id, std::span<const std::uint8_t> bytes);
std::optional<LandmarkLook> read_look(std::int64_t id, std::span<const std::uint8_t> bytes);

}  // namespace povslam
