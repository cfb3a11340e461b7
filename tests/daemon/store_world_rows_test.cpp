#include "daemon/store_world_rows.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <set>

#include "tests/support/made_world.hpp"

namespace povslam {
namespace {

constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

struct Rows {
  WorldMeta meta;
  ObjectRow object;
  VoxelBlockRow block;
  EmptyCellRow cell{-3, 4, -5, 10, 20, 6};
  ObjectEvent event;
};

Rows some_rows() {
  made::WorldMaker maker({.blocks = 20});
  for (int i = 0; i < 5; ++i) maker.next();
  Rows rows;
  rows.meta = maker.truth().meta;
  rows.object = maker.truth().objects.rbegin()->second;
  rows.object.object.first_absent = 5;
  rows.object.object.landmarks = {3, 300, 70000};
  rows.block = maker.truth().blocks.rbegin()->second;
  for (const auto& [seq, event] : maker.truth().events) {
    if (event.from) rows.event = event;
  }
  EXPECT_TRUE(rows.event.from);
  return rows;
}

std::vector<Bytes> bytes_of(const Rows& rows) {
  std::vector<Bytes> all(5);
  write_row(rows.meta, all[0]);
  write_row(rows.object, all[1]);
  write_row(rows.block, all[2]);
  write_row(rows.cell, all[3]);
  write_row(rows.event, all[4]);
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
      return rewrite(read_world_meta(bytes));
    case 1:
      return rewrite(read_object(7, bytes));
    case 2:
      return rewrite(read_block(-7, bytes));
    case 3:
      return rewrite(read_empty_cell(7, bytes));
    default:
      return rewrite(read_event(7, bytes));
  }
}

TEST(StoreWorldRows, ComeBackAsTheyWereWritten) {
  const Rows rows = some_rows();
  const std::vector<Bytes> written = bytes_of(rows);
  for (std::size_t kind = 0; kind < written.size(); ++kind) {
    EXPECT_EQ(again(kind, written[kind]), written[kind]) << kind;
  }
  const auto object = read_object(3, written[1]);
  ASSERT_TRUE(object);
  EXPECT_EQ(object->object.class_name, rows.object.object.class_name);
  EXPECT_EQ(object->object.landmarks, rows.object.object.landmarks);
  EXPECT_EQ(object->object.first_absent, 5);
  EXPECT_EQ(object->object.belief.alpha, rows.object.object.belief.alpha);
  EXPECT_EQ(object->T_world_volume.translation, rows.object.T_world_volume.translation);
  EXPECT_EQ(object->announced, rows.object.announced);
  const auto event = read_event(rows.event.seq, written[4]);
  ASSERT_TRUE(event);
  EXPECT_EQ(event->type, ObjectEventType::moved);
  EXPECT_EQ(event->from->position, rows.event.from->position);
  EXPECT_EQ(event->evidence.last_present, rows.event.evidence.last_present);
  EXPECT_EQ(event->probability, rows.event.probability);
}

TEST(StoreWorldRows, KeepOnlyTheVoxelsThatWereSeen) {
  Rows rows = some_rows();
  const auto seen = static_cast<std::size_t>(
      std::count_if(rows.block.weight.begin(), rows.block.weight.end(), [](int weight) { return weight > 0; }));
  ASSERT_LT(seen, static_cast<std::size_t>(kBlockVoxels));
  EXPECT_EQ(bytes_of(rows)[2].size(), 1 + 64 + 7 * seen);
  rows.block.distance[7] = 3;  // of a voxel never seen: means nothing
  ASSERT_EQ(rows.block.weight[7], 0);
  const auto back = read_block(*number_of(rows.block), bytes_of(rows)[2]);
  ASSERT_TRUE(back);
  EXPECT_EQ(back->distance[7], 0);
  EXPECT_EQ(back->weight, rows.block.weight);
  EXPECT_EQ(back->color, rows.block.color);
  EXPECT_EQ(back->volume, rows.block.volume);
}

VoxelBlockRow empty_block(std::int64_t volume, std::int32_t x, std::int32_t y, std::int32_t z) {
  VoxelBlockRow row;
  row.volume = volume;
  row.x = x;
  row.y = y;
  row.z = z;
  return row;
}

TEST(StoreWorldRows, KeepTheirLayoutForEver) {
  Rows rows = some_rows();
  rows.object.object.class_name = "box";
  rows.event.class_name = "box";
  const std::vector<Bytes> written = bytes_of(rows);
  EXPECT_EQ(written[0].size(), 1u + 3 * 8);
  EXPECT_EQ(written[1].size(), 1u + 3 + (1 + 3) + 4 * 8 + 3 * 8 + 4 * 8 + 4 * 8 + 4 + 2 * 8 + 7 * 8 + 4 + (1 + 2 + 3));
  EXPECT_EQ(written[3], (Bytes{1, 10, 0, 0, 0, 0, 0, 0, 0, 20, 0, 0, 0, 0, 0, 0, 0, 6, 0, 0, 0}));
  EXPECT_EQ(written[4].size(), 1u + 2 + 8 + 8 + (1 + 3) + 4 * 8 + 3 * 8 + 4 * 8 + 2 * 8 + 4 * 8);
  EXPECT_EQ(number_of(EmptyCellRow{.x = 1, .y = 2, .z = 3}), (1LL << 38) + (2LL << 14) + 3);
  EXPECT_EQ(number_of(empty_block(5, 1, 2, 3)),
            std::numeric_limits<std::int64_t>::min() + (5LL << 33) + (1LL << 22) + (2LL << 11) + 3);
}

TEST(StoreWorldRows, OfEachPlaceHaveTheirOwnNumber) {
  std::set<std::int64_t> numbers;
  std::size_t count = 0;
  for (const std::int64_t volume : {kStructureVolume, std::int64_t{0}, std::int64_t{1}, std::int64_t{1} << 29}) {
    const std::int32_t far = volume == kStructureVolume ? 8191 : 1023;
    for (const std::int32_t x : {-far - 1, -1, 0, 1, far}) {
      for (const std::int32_t y : {-far - 1, -1, 0, 1, far}) {
        for (const std::int32_t z : {-far - 1, -1, 0, 1, far}) {
          VoxelBlockRow row = empty_block(volume, x, y, z);
          row.distance.resize(kBlockVoxels);
          row.weight.resize(kBlockVoxels);
          row.color.resize(3 * kBlockVoxels);
          const auto number = number_of(row);
          ASSERT_TRUE(number);
          numbers.insert(*number);
          ++count;
          Bytes bytes;
          write_row(row, bytes);
          const auto back = read_block(*number, bytes);
          ASSERT_TRUE(back);
          EXPECT_EQ(std::tuple(back->volume, back->x, back->y, back->z), std::tuple(volume, x, y, z));
          if (volume < 0) continue;
          EXPECT_GE(*number, blocks_of_object(volume).first);
          EXPECT_LE(*number, blocks_of_object(volume).last);
        }
      }
    }
  }
  EXPECT_EQ(numbers.size(), count);
}

TEST(StoreWorldRows, AreNotReadWhenCutShortOrTooLong) {
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

TEST(StoreWorldRows, SurviveAnyFlippedBit) {
  const std::vector<Bytes> written = bytes_of(some_rows());
  for (std::size_t kind = 0; kind < written.size(); ++kind) {
    for (std::size_t bit = 0; bit < written[kind].size() * 8; ++bit) {
      Bytes flipped = written[kind];
      flipped[bit / 8] ^= static_cast<std::uint8_t>(1U << (bit % 8));
      const auto back = again(kind, flipped);
      // A varint may be longer than it needs to be: the number counts, not the bytes.
      if (back && kind != 1 && kind != 4) {
        EXPECT_EQ(*back, flipped) << kind << " " << bit;
      }
    }
  }
}

template <class Row, class Spoil>
void expect_fault(const Row& row, const WorldMeta& meta, Spoil&& spoil, const char* what) {
  Row bad = row;
  spoil(bad);
  EXPECT_FALSE(fault_in(row, meta)) << *fault_in(row, meta);
  const auto fault = fault_in(bad, meta);
  ASSERT_TRUE(fault) << what;
  EXPECT_NE(fault->find(what), std::string::npos) << *fault;
}

TEST(StoreWorldRows, SayWhatIsWrongWithAnObject) {
  const auto [meta, object, block, cell, event] = some_rows();
  const auto spoilt = [&, &row = object, &m = meta](auto&& spoil, const char* what) {
    expect_fault(row, m, spoil, what);
  };
  spoilt([](auto& row) { row.object.id = 1 << 20; }, "not in use");
  spoilt([](auto& row) { row.object.class_name.assign(300, 'x'); }, "name");
  spoilt([](auto& row) { row.object.place.yaw = kNan; }, "place");
  spoilt([](auto& row) { row.object.size_m.x() = -1.0; }, "size");
  spoilt([](auto& row) { row.object.belief.sigma2 = 0.0; }, "belief");
  spoilt([](auto& row) { row.object.belief.alpha = kNan; }, "belief");
  spoilt([](auto& row) { row.object.observations = -1; }, "counts");
  spoilt([](auto& row) { row.T_world_volume.rotation.w() += 0.5; }, "volume");
  spoilt([](auto& row) { row.voxel_size_m = 0.0; }, "voxels");
  spoilt([](auto& row) { row.object.landmarks[0] = -1; }, "landmark");
}

TEST(StoreWorldRows, SayWhatIsWrongWithVoxelsCellsAndEvents) {
  const auto [meta, object, block, cell, event] = some_rows();
  expect_fault(
      block, meta, [](auto& row) { row.volume = 1 << 20; }, "not in use");
  expect_fault(
      block, meta, [](auto& row) { row.x = 1 << 20; }, "too far");
  expect_fault(
      block, meta, [](auto& row) { row.color.pop_back(); }, "lengths");
  expect_fault(
      cell, meta, [](auto& row) { row.z = 1 << 20; }, "too far");
  expect_fault(
      cell, meta, [](auto& row) { row.first = 99; }, "times");
  expect_fault(
      event, meta, [](auto& row) { row.seq = 1 << 20; }, "not in use");
  expect_fault(
      event, meta, [](auto& row) { row.object = -1; }, "not in use");
  expect_fault(
      event, meta, [](auto& row) { row.from->yaw = kNan; }, "place");
  expect_fault(
      event, meta, [](auto& row) { row.probability = 1.5; }, "figures");
  EXPECT_TRUE(fault_in(WorldMeta{.next_object = -1}));
  EXPECT_TRUE(fault_in(WorldMeta{.next_event_seq = -1}));
}

}  // namespace
}  // namespace povslam
