#include "daemon/store_rows.hpp"

namespace povslam {
namespace {

constexpr std::uint8_t kLayout = 1;  // of all rows so far
constexpr std::size_t kBytesPerFeature = 5 * sizeof(float) + 1 + sizeof(Descriptor);

template <class T>
std::span<const T> view(const std::vector<T>& values) {
  return values;
}

std::span<const std::uint64_t> words_of(const std::vector<Descriptor>& descriptors) {
  return {descriptors.empty() ? nullptr : descriptors[0].data(), descriptors.size() * Descriptor{}.size()};
}

template <class T>
void read_all(ByteReader& in, std::size_t count, std::vector<T>& out) {
  out.resize(count);
  in.numbers(std::span<T>(out));
}

void write_pose(const Rigid3& T, ByteWriter& out) {
  out.numbers(std::span<const double>(T.rotation.coeffs().data(), 4));
  out.numbers(std::span<const double>(T.translation.data(), 3));
}

void read_pose(ByteReader& in, Rigid3& T) {
  in.numbers(std::span<double>(T.rotation.coeffs().data(), 4));
  in.numbers(std::span<double>(T.translation.data(), 3));
}

}  // namespace

void write_row(const StoredMeta& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.map.next_keyframe);
  out.number(row.map.next_landmark);
  out.number(row.map.map_version);
  out.number(row.map.vocabulary);
  for (const double value : {row.map.fx, row.map.fy, row.map.cx, row.map.cy, row.map.level_scale}) out.number(value);
  out.number(row.commits);
  out.number(row.created);
  out.number(row.committed);
}

std::optional<StoredMeta> read_meta(std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  StoredMeta row;
  row.map.next_keyframe = in.number<std::int64_t>();
  row.map.next_landmark = in.number<std::int64_t>();
  row.map.map_version = in.number<std::uint32_t>();
  row.map.vocabulary = in.number<std::uint64_t>();
  for (double* value : {&row.map.fx, &row.map.fy, &row.map.cx, &row.map.cy, &row.map.level_scale}) {
    *value = in.number<double>();
  }
  row.commits = in.number<std::uint64_t>();
  row.created = in.number<TimeNs>();
  row.committed = in.number<TimeNs>();
  return in.at_end() ? std::optional(row) : std::nullopt;
}

void write_row(const KeyframeFeatures& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.stamp);
  out.number(static_cast<std::uint32_t>(row.x.size()));
  out.number(static_cast<std::uint8_t>(row.word.empty() ? 0 : 1));
  for (const auto* values : {&row.x, &row.y, &row.sigma_px, &row.inverse_depth, &row.sigma_inverse_depth}) {
    out.numbers(view(*values));
  }
  out.numbers(view(row.level));
  out.numbers(words_of(row.descriptor));
  out.numbers(view(row.word));
}

std::optional<KeyframeFeatures> read_features(std::int64_t id, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  KeyframeFeatures row;
  row.keyframe = id;
  row.stamp = in.number<TimeNs>();
  const std::size_t count = in.number<std::uint32_t>();
  const auto words = in.number<std::uint8_t>();
  if (!in.ok() || words > 1 || in.left() != count * (kBytesPerFeature + words * sizeof(std::uint32_t))) {
    return std::nullopt;
  }
  for (auto* values : {&row.x, &row.y, &row.sigma_px, &row.inverse_depth, &row.sigma_inverse_depth}) {
    read_all(in, count, *values);
  }
  read_all(in, count, row.level);
  row.descriptor.resize(count);
  for (Descriptor& descriptor : row.descriptor) in.numbers(std::span<std::uint64_t>(descriptor));
  if (words != 0) read_all(in, count, row.word);
  return row;
}

void write_row(const KeyframeRow& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.parent);
  write_pose(row.T_world_camera, out);
  out.numbers(std::span<const double>(row.covariance.data(), 36));
  out.number(static_cast<std::uint32_t>(row.landmark.size()));
  for (const std::int64_t landmark : row.landmark) out.varint(static_cast<std::uint64_t>(landmark + 1));
}

std::optional<KeyframeRow> read_keyframe(std::int64_t id, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  KeyframeRow row;
  row.keyframe = id;
  row.parent = in.number<std::int64_t>();
  read_pose(in, row.T_world_camera);
  in.numbers(std::span<double>(row.covariance.data(), 36));
  const std::size_t count = in.number<std::uint32_t>();
  if (count > in.left()) return std::nullopt;  // each takes a byte at least
  row.landmark.resize(count);
  for (std::int64_t& landmark : row.landmark) landmark = static_cast<std::int64_t>(in.varint()) - 1;
  return in.at_end() ? std::optional(std::move(row)) : std::nullopt;
}

void write_row(const LandmarkRow& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.number(row.anchor);
  out.numbers(std::span<const double>(row.p_anchor.data(), 3));
  out.number(row.born_keyframe);
  out.number(row.visible);
  out.number(row.found);
  out.number(static_cast<std::uint8_t>(row.has_patch ? 1 : 0));
  out.numbers(std::span<const float>(row.tangent_x_anchor.data(), 3));
  out.numbers(std::span<const float>(row.tangent_y_anchor.data(), 3));
}

std::optional<LandmarkRow> read_landmark(std::int64_t id, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  LandmarkRow row;
  row.landmark = id;
  row.anchor = in.number<std::int64_t>();
  in.numbers(std::span<double>(row.p_anchor.data(), 3));
  row.born_keyframe = in.number<std::int64_t>();
  row.visible = in.number<std::int32_t>();
  row.found = in.number<std::int32_t>();
  const auto has_patch = in.number<std::uint8_t>();
  row.has_patch = has_patch == 1;
  in.numbers(std::span<float>(row.tangent_x_anchor.data(), 3));
  in.numbers(std::span<float>(row.tangent_y_anchor.data(), 3));
  return in.at_end() && has_patch <= 1 ? std::optional(row) : std::nullopt;
}

void write_row(const LandmarkLook& row, Bytes& bytes) {
  ByteWriter out(bytes);
  out.number(kLayout);
  out.numbers(std::span<const std::uint8_t>(row.patch.pixels));
}

std::optional<LandmarkLook> read_look(std::int64_t id, std::span<const std::uint8_t> bytes) {
  ByteReader in(bytes);
  if (in.number<std::uint8_t>() != kLayout) return std::nullopt;
  LandmarkLook row;
  row.landmark = id;
  in.numbers(std::span<std::uint8_t>(row.patch.pixels));
  return in.at_end() ? std::optional(row) : std::nullopt;
}

}  // namespace povslam
