#include "daemon/store_world_rows.hpp"

#include <algorithm>
#include <array>
#include <utility>

#include "pipeline/mapping/volume.hpp"

namespace povslam {
namespace {

constexpr std::uint8_t kLayout = 1;  // of all rows so far
constexpr std::uint8_t kHasFirst = 1, kHasLast = 2, kHasFrom = 4;
constexpr unsigned kObjectBits = 11;                             // of each coordinate of an object's block
constexpr std::int64_t kBlocksOfOne = 1LL << (3 * kObjectBits);  // numbers an object has
constexpr std::int64_t kMaxObjects = 1LL << (63 - 3 * kObjectBits);

// Two's complement of `bits` bits: whether the value fits, as those bits, and back.
bool fits(std::int32_t value, unsigned bits) {
  return value >= -(1 << (bits - 1)) && value < 1 << (bits - 1);
}
std::uint64_t pack(std::int32_t value, unsigned bits) {
  return static_cast<std::uint32_t>(value) & ((1ULL << bits) - 1);
}
std::int32_t unpack(std::uint64_t number, unsigned shift, unsigned bits) {
  return static_cast<std::int32_t>(static_cast<std::int64_t>(number << (64 - shift - bits)) >> (64 - bits));
}

constexpr unsigned kWideBits = 24, kHighBits = 14;  // x and y, z of what lies in the world

std::optional<std::int64_t> number_in_world(std::int32_t x, std::int32_t y, std::int32_t z) {
  if (!fits(x, kWideBits) || !fits(y, kWideBits) || !fits(z, kHighBits)) return std::nullopt;
  return static_cast<std::int64_t>(pack(x, kWideBits) << (kWideBits + kHighBits) | pack(y, kWideBits) << kHighBits |
                                   pack(z, kHighBits));
}
template <class Row>
void set_place_in_world(std::int64_t number, Row& row) {
  const auto bits = static_cast<std::uint64_t>(number);
  row.x = unpack(bits, kWideBits + kHighBits, kWideBits);
  row.y = unpack(bits, kHighBits, kWideBits);
  row.z = unpack(bits, 0, kHighBits);
}

void write_text(const std::string& text, ByteWriter& out) {
  out.varint(text.size());
  out.numbers(std::span<const char>(text));
}
std::string read_text(ByteReader& in) {
  const std::uint64_t size = in.varint();
  std::string text(std::min<std::uint64_t>(size, in.left()), '\0');
  in.numbers(std::span<char>(text));
  if (size != text.size()) in.fail();
  return text;
}

void write_vector(const Eigen::Vector3d& v, ByteWriter& out) {
  out.numbers(std::span<const double>(v.data(), 3));
}
void write_place(const ObjectPlace& place, ByteWriter& out) {
  write_vector(place.position, out);
  out.number(place.yaw);
}
void read_vector(ByteReader& in, Eigen::Vector3d& v) {
  in.numbers(std::span<double>(v.data(), 3));
}
void read_place(ByteReader& in, ObjectPlace& place) {
  read_vector(in, place.position);
  place.yaw = in.number<double>();
}

std::uint8_t flags_of(const std::optional<TimeNs>& first, const std::optional<TimeNs>& last) {
  return static_cast<std::uint8_t>((first ? kHasFirst : 0) | (last ? kHasLast : 0));
}
void write_stamps(const std::optional<TimeNs>& first, const std::optional<TimeNs>& last, ByteWriter& out) {
  out.number(first.value_or(0));
  out.number(last.value_or(0));
}
void read_stamps(ByteReader& in, std::uint8_t flags, std::optional<TimeNs>& first, std::optional<TimeNs>& last) {
  for (const auto& [flag, stamp] : {std::pair{kHasFirst, &first}, std::pair{kHasLast, &last}}) {
    const auto value = in.number<TimeNs>();
    if ((flags & flag) != 0) *stamp = value;
    if ((flags & flag) == 0 && value != 0) in.fail();
  }
}

}  // namespace

std::optional<std::int64_t> number_of(const EmptyCellRow& row) {
  return number_in_world(row.x, row.y, row.z);
}

std::optional<std::int64_t> number_of(const VoxelBlockRow& row) {
  if (row.volume == kStructureVolume) return number_in_world(row.x, row.y, row.z);
  const bool known = row.volume >= 0 && row.volume < kMaxObjects;
  if (!known || !fits(row.x, kObjectBits) || !fits(row.y, kObjectBits) || !fits(row.z, kObjectBits))
    return std::nullopt;
  const std::uint64_t place = pack(row.x, kObjectBits) << (2 * kObjectBits) | pack(row.y, kObjectBits) << kObjectBits |
                              pack(row.z, kObjectBits);
  return blocks_of_object(row.volume).first + static_cast<std::int64_t>(place);
}

NumberRange blocks_of_object(std::int64_t object) {
  const std::int64_t first = (object - kMaxObjects) * kBlocksOfOne;
  return {first, first + kBlocksOfOne - 1};
}

void write_row(const WorldMeta& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.next_object);
  out.number(row.next_event_seq);
  out.number(row.first_visit_end);
}

std::optional<WorldMeta> read_world_meta(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  WorldMeta row;
  row.next_object = in.number<std::int64_t>();
  row.next_event_seq = in.number<std::int64_t>();
  row.first_visit_end = in.number<TimeNs>();
  return in.at_end() ? std::optional(row) : std::nullopt;
}

void write_row(const ObjectRow& row, Bytes& bytes) {
  const ObjectRecord& object = row.object;
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(flags_of(object.first_absent, object.last_absent));
  out.number(static_cast<std::uint8_t>(object.phase));
  out.number(static_cast<std::uint8_t>(row.announced ? 1 : 0));
  write_text(object.class_name, out);
  write_place(object.place, out);
  write_vector(object.size_m, out);
  const Belief& belief = object.belief;
  for (const double value : {belief.mu, belief.sigma2, belief.alpha, belief.beta}) out.number(value);
  out.number(object.first_seen);
  out.number(object.last_seen);
  write_stamps(object.first_absent, object.last_absent, out);
  out.number(static_cast<std::int32_t>(object.observations));
  out.number(row.voxel_size_m);
  out.number(row.truncation_m);
  out.numbers(std::span<const double>(row.T_world_volume.rotation.coeffs().data(), 4));
  write_vector(row.T_world_volume.translation, out);
  out.number(static_cast<std::uint32_t>(object.landmarks.size()));
  for (const std::int64_t landmark : object.landmarks) out.varint(static_cast<std::uint64_t>(landmark));
}

std::optional<ObjectRow> read_object(std::int64_t id, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  ObjectRow row;
  ObjectRecord& object = row.object;
  object.id = id;
  const auto flags = in.number<std::uint8_t>(), phase = in.number<std::uint8_t>(),
             announced = in.number<std::uint8_t>();
  if (flags > (kHasFirst | kHasLast) || phase > static_cast<std::uint8_t>(ObjectPhase::removed) || announced > 1) {
    return std::nullopt;
  }
  object.phase = static_cast<ObjectPhase>(phase);
  row.announced = announced == 1;
  object.class_name = read_text(in);
  read_place(in, object.place);
  read_vector(in, object.size_m);
  Belief& belief = object.belief;
  for (double* value : {&belief.mu, &belief.sigma2, &belief.alpha, &belief.beta}) *value = in.number<double>();
  object.first_seen = in.number<TimeNs>();
  object.last_seen = in.number<TimeNs>();
  read_stamps(in, flags, object.first_absent, object.last_absent);
  object.observations = in.number<std::int32_t>();
  row.voxel_size_m = in.number<double>();
  row.truncation_m = in.number<double>();
  in.numbers(std::span<double>(row.T_world_volume.rotation.coeffs().data(), 4));
  read_vector(in, row.T_world_volume.translation);
  const std::size_t count = in.number<std::uint32_t>();
  if (count > in.left()) return std::nullopt;  // each takes a byte at least
  object.landmarks.resize(count);
  for (std::int64_t& landmark : object.landmarks) landmark = static_cast<std::int64_t>(in.varint());
  return in.at_end() ? std::optional(std::move(row)) : std::nullopt;
}

void write_row(const VoxelBlockRow& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  std::array<std::uint8_t, kBlockVoxels / 8> seen{};
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    if (row.weight[i] > 0) seen[i / 8] |= static_cast<std::uint8_t>(1U << (i % 8));
  }
  out.numbers(std::span<const std::uint8_t>(seen));
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    if (row.weight[i] == 0) continue;
    out.number(row.distance[i]);
    out.number(row.weight[i]);
    out.numbers(std::span<const std::uint8_t>(row.color).subspan(3 * i, 3));
  }
}

std::optional<VoxelBlockRow> read_block(std::int64_t number, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  VoxelBlockRow row;
  if (number >= 0) {
    row.volume = kStructureVolume;
    set_place_in_world(number, row);
  } else {
    const auto bits = static_cast<std::uint64_t>(number);
    row.volume = (number >> (3 * kObjectBits)) + kMaxObjects;
    row.x = unpack(bits, 2 * kObjectBits, kObjectBits);
    row.y = unpack(bits, kObjectBits, kObjectBits);
    row.z = unpack(bits, 0, kObjectBits);
  }
  std::array<std::uint8_t, kBlockVoxels / 8> seen{};
  in.numbers(std::span<std::uint8_t>(seen));
  row.distance.resize(kBlockVoxels);
  row.weight.resize(kBlockVoxels);
  row.color.resize(3 * kBlockVoxels);
  for (std::size_t i = 0; i < kBlockVoxels; ++i) {
    if ((seen[i / 8] >> (i % 8) & 1U) == 0) continue;
    row.distance[i] = in.number<std::int16_t>();
    row.weight[i] = in.number<std::uint16_t>();
    in.numbers(std::span<std::uint8_t>(row.color).subspan(3 * i, 3));
    if (row.weight[i] == 0) return std::nullopt;
  }
  return in.at_end() ? std::optional(std::move(row)) : std::nullopt;
}

void write_row(const EmptyCellRow& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.first);
  out.number(row.last);
  out.number(row.times);
}

std::optional<EmptyCellRow> read_empty_cell(std::int64_t number, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  EmptyCellRow row;
  set_place_in_world(number, row);
  row.first = in.number<TimeNs>();
  row.last = in.number<TimeNs>();
  row.times = in.number<std::int32_t>();
  return in.at_end() ? std::optional(row) : std::nullopt;
}

void write_row(const ObjectEvent& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  const std::uint8_t flags = flags_of(row.evidence.first_absent, row.evidence.last_absent);
  out.number(static_cast<std::uint8_t>(flags | (row.from ? kHasFrom : 0)));
  out.number(static_cast<std::uint8_t>(row.type));
  out.number(row.stamp);
  out.number(row.object);
  write_text(row.class_name, out);
  write_place(row.place, out);
  write_vector(row.size_m, out);
  if (row.from) write_place(*row.from, out);
  out.number(row.consistency);
  out.number(row.probability);
  write_stamps(row.evidence.first_absent, row.evidence.last_absent, out);
  out.number(row.evidence.first_present);
  out.number(row.evidence.last_present);
}

std::optional<ObjectEvent> read_event(std::int64_t seq, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  ObjectEvent row;
  row.seq = seq;
  const auto flags = in.number<std::uint8_t>(), type = in.number<std::uint8_t>();
  if (flags > (kHasFirst | kHasLast | kHasFrom) || type > static_cast<std::uint8_t>(ObjectEventType::removed)) {
    return std::nullopt;
  }
  row.type = static_cast<ObjectEventType>(type);
  row.stamp = in.number<TimeNs>();
  row.object = in.number<std::int64_t>();
  row.class_name = read_text(in);
  read_place(in, row.place);
  read_vector(in, row.size_m);
  if ((flags & kHasFrom) != 0) read_place(in, row.from.emplace());
  row.consistency = in.number<double>();
  row.probability = in.number<double>();
  read_stamps(in, flags, row.evidence.first_absent, row.evidence.last_absent);
  row.evidence.first_present = in.number<TimeNs>();
  row.evidence.last_present = in.number<TimeNs>();
  return in.at_end() ? std::optional(std::move(row)) : std::nullopt;
}

}  // namespace povslam
