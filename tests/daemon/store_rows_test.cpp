#include "daemon/store_rows.hpp"

#include <gtest/gtest.h>

#include <limits>

#include "tests/support/made_map.hpp"

namespace povslam {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
constexpr float kNanF = std::numeric_limits<float>::quiet_NaN();

// One row of each kind, and bytes of them all.
struct Rows {
  MapMeta meta;
  KeyframeFeatures features;
  KeyframeRow keyframe;
  LandmarkRow landmark;
  LandmarkLook look;
};

Rows some_rows() {
  made::MapMaker maker(made::small_pace(1));
  maker.next();
  const MapChange change = maker.next();
  return {change.meta, change.features[0], change.keyframes[0], change.landmarks[0], change.looks[0]};
}

std::vector<Bytes> bytes_of(const Rows& rows) {
  std::vector<Bytes> all(5);
  write_row(StoredMeta{.map = rows.meta, .commits = 3, .created = 1, .committed = 2}, all[0]);
  write_row(rows.features, all[1]);
  write_row(rows.keyframe, all[2]);
  write_row(rows.landmark, all[3]);
  write_row(rows.look, all[4]);
  return all;
}

// Reads as row number `kind` and writes again; nothing when it cannot be read.
std::optional<Bytes> again(std::size_t kind, std::span<const std::uint8_t> bytes) {
  Bytes out;
  const auto rewrite = [&out](const auto& row) {
    if (row) write_row(*row, out);
    return row ? std::optional(out) : std::nullopt;
  };
  switch (kind) {
    case 0:
      return rewrite(read_meta(bytes));
    case 1:
      return rewrite(read_features(7, bytes));
    case 2:
      return rewrite(read_keyframe(7, bytes));
    case 3:
      return rewrite(read_landmark(7, bytes));
    default:
      return rewrite(read_look(7, bytes));
  }
}

TEST(StoreRows, ComeBackAsTheyWereWritten) {
  const Rows rows = some_rows();
  const std::vector<Bytes> written = bytes_of(rows);
  for (std::size_t kind = 0; kind < written.size(); ++kind)
    EXPECT_EQ(again(kind, written[kind]), written[kind]) << kind;
  const auto landmark = read_landmark(rows.landmark.landmark, written[3]);
  ASSERT_TRUE(landmark);
  EXPECT_EQ(landmark->p_anchor, rows.landmark.p_anchor);
  EXPECT_EQ(landmark->tangent_y_anchor, rows.landmark.tangent_y_anchor);
  const auto keyframe = read_keyframe(rows.keyframe.keyframe, written[2]);
  ASSERT_TRUE(keyframe);
  EXPECT_EQ(keyframe->landmark, rows.keyframe.landmark);
  EXPECT_EQ(keyframe->T_world_camera.rotation.coeffs(), rows.keyframe.T_world_camera.rotation.coeffs());
  const auto features = read_features(rows.features.keyframe, written[1]);
  ASSERT_TRUE(features);
  EXPECT_EQ(features->descriptor, rows.features.descriptor);
  EXPECT_EQ(features->word, rows.features.word);
}

TEST(StoreRows, KeepTheirLayoutForEver) {
  Rows rows = some_rows();
  rows.landmark = {.landmark = 1, .anchor = 2, .p_anchor = {1, 2, 3}, .born_keyframe = 4, .visible = 5, .found = 6};
  const std::vector<Bytes> written = bytes_of(rows);
  EXPECT_EQ(written[0].size(), 1u + 8 + 8 + 4 + 8 + 5 * 8 + 8 + 8 + 8);
  EXPECT_EQ(written[1].size(), 1u + 8 + 4 + 1 + rows.features.x.size() * 57);
  EXPECT_EQ(written[4].size(), 1u + 576);
  const Bytes head = {1, 2, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0, 0xF0, 0x3F};  // layout, anchor, 1.0
  EXPECT_EQ(Bytes(written[3].begin(), written[3].begin() + 17), head);
  EXPECT_EQ(written[3].size(), 1u + 8 + 24 + 8 + 4 + 4 + 1 + 24);
}

TEST(StoreRows, WithoutWordsOrFeaturesAreRowsToo) {
  Rows rows = some_rows();
  rows.features.word.clear();
  rows.keyframe.landmark.clear();
  EXPECT_TRUE(read_features(1, bytes_of(rows)[1])->word.empty());
  EXPECT_TRUE(read_keyframe(1, bytes_of(rows)[2])->landmark.empty());
  rows.features = {};
  EXPECT_TRUE(read_features(1, bytes_of(rows)[1])->x.empty());
}

TEST(StoreRows, AreNotReadWhenCutShortOrTooLong) {
  const std::vector<Bytes> written = bytes_of(some_rows());
  for (std::size_t kind = 0; kind < written.size(); ++kind) {
    for (std::size_t size = 0; size < written[kind].size(); ++size) {
      EXPECT_FALSE(again(kind, std::span(written[kind]).first(size))) << kind << " " << size;
    }
    Bytes longer = written[kind];
    longer.push_back(0);
    EXPECT_FALSE(again(kind, longer)) << kind;
  }
}

TEST(StoreRows, SurviveAnyFlippedBitAndWhatIsReadWritesBackTheSame) {
  const std::vector<Bytes> written = bytes_of(some_rows());
  for (std::size_t kind = 0; kind < written.size(); ++kind) {
    for (std::size_t bit = 0; bit < written[kind].size() * 8; ++bit) {
      Bytes flipped = written[kind];
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      const auto back = again(kind, flipped);
      // A varint may be longer than it needs to be: the number counts, not the bytes.
      if (back && kind != 2) {
        EXPECT_EQ(*back, flipped) << kind << " " << bit;
      }
    }
  }
}

TEST(StoreRows, DoNotTrustALength) {
  Bytes huge = bytes_of(some_rows())[1];
  std::fill_n(huge.begin() + 9, 4, std::uint8_t{0xFF});  // the number of features
  EXPECT_FALSE(read_features(1, huge));
  huge = bytes_of(some_rows())[2];
  std::fill_n(huge.begin() + 1 + 8 + 7 * 8 + 36 * 8, 4, std::uint8_t{0xFF});
  EXPECT_FALSE(read_keyframe(1, huge));
}

template <class Row, class Spoil>
void expect_fault(const Row& row, const MapMeta& meta, Spoil&& spoil, const char* what) {
  Row bad = row;
  spoil(bad);
  EXPECT_FALSE(fault_in(row, meta)) << *fault_in(row, meta);
  const auto fault = fault_in(bad, meta);
  ASSERT_TRUE(fault) << what;
  EXPECT_NE(fault->find(what), std::string::npos) << *fault;
}

TEST(StoreRows, SayWhatIsWrongWithAKeyframe) {
  const auto [meta, features, keyframe, landmark, look] = some_rows();
  expect_fault(
      keyframe, meta, [](auto& row) { row.keyframe = 1 << 20; }, "not in use");
  expect_fault(
      keyframe, meta, [](auto& row) { row.parent = row.keyframe; }, "parent");
  expect_fault(
      keyframe, meta, [](auto& row) { row.T_world_camera.rotation.w() += 0.1; }, "pose");
  expect_fault(
      keyframe, meta, [](auto& row) { row.T_world_camera.rotation.w() = kNan; }, "pose");
  expect_fault(
      keyframe, meta, [](auto& row) { row.T_world_camera.translation.z() = kNan; }, "pose");
  expect_fault(
      keyframe, meta, [](auto& row) { row.covariance(3, 3) = kNan; }, "covariance");
  expect_fault(
      keyframe, meta, [](auto& row) { row.landmark[0] = 1 << 20; }, "landmark");
  expect_fault(
      keyframe, meta, [](auto& row) { row.landmark[0] = -2; }, "landmark");
  expect_fault(
      features, meta, [](auto& row) { row.y.pop_back(); }, "lengths");
  expect_fault(
      features, meta, [](auto& row) { row.word.pop_back(); }, "lengths");
  expect_fault(
      features, meta, [](auto& row) { row.level[3] = kMaxPyramidLevels; }, "level");
  expect_fault(
      features, meta, [](auto& row) { row.x[3] = kNanF; }, "position");
  expect_fault(
      features, meta, [](auto& row) { row.inverse_depth[3] = -1.0F; }, "negative");
  expect_fault(
      features, meta, [](auto& row) { row.keyframe = -1; }, "not in use");
}

TEST(StoreRows, SayWhatIsWrongWithALandmark) {
  const auto [meta, features, keyframe, landmark, look] = some_rows();
  expect_fault(
      landmark, meta, [](auto& row) { row.landmark = 1 << 20; }, "not in use");
  expect_fault(
      landmark, meta, [](auto& row) { row.anchor = -1; }, "anchor");
  expect_fault(
      landmark, meta, [](auto& row) { row.born_keyframe = 1 << 20; }, "first keyframe");
  expect_fault(
      landmark, meta, [](auto& row) { row.p_anchor.x() = kNan; }, "place");
  expect_fault(
      landmark, meta, [](auto& row) { row.tangent_x_anchor.x() = kNanF; }, "surface");
  expect_fault(
      landmark, meta, [](auto& row) { row.found = -1; }, "counts");
  expect_fault(
      look, meta, [](auto& row) { row.landmark = -1; }, "not in use");
}

}  // namespace
}  // namespace povslam
