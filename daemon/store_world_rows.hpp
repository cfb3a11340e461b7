// Rows of objects, voxels, empty cells and events as bytes and back, in the manners of store_rows.hpp.
#pragma once

#include <optional>
#include <string>

#include "daemon/store_bytes.hpp"
#include "pipeline/objects/world_rows.hpp"

namespace povslam {

// A block's number in its table says volume and place; so does a cell's. Of blocks of the structure >= 0, x and y
// within 2^23 of the origin and z within 2^13; of an object's < 0, one range an object, each within 2^10. Nothing:
// farther out.
std::optional<std::int64_t> number_of(const VoxelBlockRow& row);
std::optional<std::int64_t> number_of(const EmptyCellRow& row);
struct NumberRange {
  std::int64_t first = 0, last = 0;
};
NumberRange blocks_of_object(std::int64_t object);

// What is wrong with a row's values, nothing when they can be.
std::optional<std::string> fault_in(const WorldMeta& meta);
std::optional<std::string> fault_in(const ObjectRow& row, const WorldMeta& meta);
std::optional<std::string> fault_in(const VoxelBlockRow& row, const WorldMeta& meta);
std::optional<std::string> fault_in(const EmptyCellRow& row, const WorldMeta& meta);
std::optional<std::string> fault_in(const ObjectEvent& row, const WorldMeta& meta);

// Replace what is in `out`. Of a block only voxels that were seen are kept; the others are read back as zeros.
void write_row(const WorldMeta& row, Bytes& out);
void write_row(const ObjectRow& row, Bytes& out);
void write_row(const VoxelBlockRow& row, Bytes& out);
void write_row(const EmptyCellRow& row, Bytes& out);
void write_row(const ObjectEvent& row, Bytes& out);

std::optional<WorldMeta> read_world_meta(std::span<const std::uint8_t> bytes);
std::optional<ObjectRow> read_object(std::int64_t id, std::span<const std::uint8_t> bytes);
std::optional<VoxelBlockRow> read_block(std::int64_t number, std::span<const std::uint8_t> bytes);
std::optional<EmptyCellRow> read_empty_cell(std::int64_t number, std::span<const std::uint8_t> bytes);
std::optional<ObjectEvent> read_event(std::int64_t seq, std::span<const std::uint8_t> bytes);

}  // namespace povslam
