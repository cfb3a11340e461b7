#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <CLI/CLI.hpp>
#include <fstream>
#include <nlohmann/json.hpp>
#include <sstream>

#include "daemon/store.hpp"
#include "tests/support/made_map.hpp"
#include "tests/support/made_world.hpp"
#include "tests/support/temp_folder.hpp"
#include "tools/povslam/map_occupancy.hpp"
#include "tools/povslam/map_ply.hpp"
#include "tools/povslam/scores/ply_file.hpp"
#include "tools/povslam/subcommands.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string content(const std::filesystem::path& file) {
  std::ifstream stream(file, std::ios::binary);
  std::stringstream text;
  text << stream.rdbuf();
  return text.str();
}

struct Outcome {
  int exit_code = -1;
  std::string output, errors;
};

Outcome run(std::vector<std::string> arguments) {
  CLI::App app;
  Outcome outcome;
  add_map(app, outcome.exit_code);
  arguments.insert(arguments.begin(), "map");
  std::reverse(arguments.begin(), arguments.end());
  testing::internal::CaptureStdout();
  testing::internal::CaptureStderr();
  try {
    app.parse(arguments);
  } catch (const CLI::ParseError& error) {
    outcome.errors = error.what();
  }
  outcome.output = testing::internal::GetCapturedStdout();
  outcome.errors += testing::internal::GetCapturedStderr();
  return outcome;
}

OccupancyOptions between(double min_height_m, double max_height_m) {
  OccupancyOptions options;
  options.min_height_m = min_height_m;
  options.max_height_m = max_height_m;
  return options;
}

// Two keyframes at height 0.8 that look along +x: one at the origin, one at x = 1, y = 2. Landmarks: a post three
// metres ahead of the first, a lamp high above it, a mark on the floor half-way to it, and one that only the second
// sees, straight ahead.
class Map : public testing::Test {
 protected:
  Map() {
    map_.meta.next_keyframe = 2;
    map_.meta.next_landmark = 4;
    for (std::int64_t id = 0; id < 2; ++id) {
      KeyframeFeatures features;
      features.keyframe = id;
      features.stamp = (id + 1) * kNsPerSecond;
      KeyframeRow row;
      row.keyframe = id;
      row.parent = id - 1;
      const double along = static_cast<double>(id);
      row.T_world_camera.translation = Eigen::Vector3d(along, 2.0 * along, 0.8);
      for (const std::int64_t seen : id == 0 ? std::vector<std::int64_t>{0, 1, 2} : std::vector<std::int64_t>{3}) {
        for (auto* list :
             {&features.x, &features.y, &features.sigma_px, &features.inverse_depth, &features.sigma_inverse_depth}) {
          list->push_back(1.0F);
        }
        features.level.push_back(0);
        features.descriptor.push_back({});
        row.landmark.push_back(seen);
      }
      map_.features.push_back(features);
      map_.keyframes.push_back(row);
    }
    add_landmark(0, {3.01, 0.01, 1.0});
    add_landmark(0, {3.01, 0.51, 4.0});
    add_landmark(0, {1.51, 0.01, 0.0});
    add_landmark(1, {4.01, 2.01, 0.8});
    LandmarkLook look{.landmark = 0, .patch = {}};
    std::fill(std::begin(look.patch.pixels), std::end(look.patch.pixels), std::uint8_t{77});
    map_.looks.push_back(look);
  }

  void add_landmark(std::int64_t anchor, const Eigen::Vector3d& p_world) {
    LandmarkRow row;
    row.landmark = static_cast<std::int64_t>(map_.landmarks.size());
    row.anchor = anchor;
    row.p_anchor = map_.keyframes[static_cast<std::size_t>(anchor)].T_world_camera.inverse() * p_world;
    map_.landmarks.push_back(row);
  }

  std::string stored() {
    auto store = MapStore::open(folder_.path() / "map.db", StoreMode::read_write);
    EXPECT_TRUE(store);
    EXPECT_TRUE(store->commit(map_));
    return (folder_.path() / "map.db").string();
  }
  std::string out(const char* name) const { return (folder_.path() / name).string(); }

  MapContent map_;
  TempFolder folder_;
};

TEST(MapWorld, ShowsWhatStandsInAStoreAndItsEvents) {
  const TempFolder folder;
  const std::string file = (folder.path() / "map.db").string();
  made::WorldMaker worlds({});
  {
    auto store = MapStore::open(file, StoreMode::read_write);
    ASSERT_TRUE(store);
    for (int i = 0; i < 6; ++i) ASSERT_TRUE(store->commit(worlds.next()));
  }
  const WorldContent truth = worlds.truth().content();
  const auto json = nlohmann::json::parse(run({"info", file, "--json"}).output);
  EXPECT_EQ(json["tables"]["objects"]["rows"], truth.objects.size());
  EXPECT_EQ(json["tables"]["empty_cells"]["rows"], truth.empty_cells.size());
  EXPECT_EQ(json["voxel_blocks"], truth.blocks.size());
  EXPECT_EQ(json["next_event"], truth.meta.next_event_seq);
  EXPECT_THAT(run({"info", file}).output, HasSubstr(std::to_string(truth.events.size()) + " events\n"));
  EXPECT_THAT(run({"verify", file}).output, HasSubstr(std::to_string(truth.objects.size()) + " objects, "));
  std::istringstream lines(run({"events", file}).output);
  std::string line;
  std::int64_t seq = 0;
  while (std::getline(lines, line)) EXPECT_EQ(nlohmann::json::parse(line)["seq"], seq++);
  EXPECT_EQ(seq, truth.meta.next_event_seq);
}

TEST_F(Map, InfoSaysWhatAStoreHolds) {
  const std::string store = stored();
  const Outcome text = run({"info", store});
  EXPECT_EQ(text.exit_code, 0) << text.errors;
  EXPECT_THAT(text.output, AllOf(HasSubstr("2 keyframes, 4 landmarks"), HasSubstr("commit 1"),
                                 HasSubstr("x 0.00 to 1.00, y 0.00 to 2.00, z 0.80 to 0.80 m"),
                                 HasSubstr("1.000 to 2.000 s"), HasSubstr("voxel_blocks")));
  const auto json = nlohmann::json::parse(run({"info", store, "--json"}).output);
  EXPECT_EQ(json["keyframes"], 2);
  EXPECT_EQ(json["tables"]["looks"]["rows"], 1);
  EXPECT_EQ(json["extent_max_m"][1], 2.0);
  EXPECT_GT(json["file_bytes"], 4096);
  EXPECT_EQ(json["schema_version"], 3);
}

TEST_F(Map, VerifyTellsASoundStoreFromADamagedOne) {
  const std::string store = stored();
  const Outcome sound = run({"verify", store});
  EXPECT_EQ(sound.exit_code, 0) << sound.errors;
  EXPECT_THAT(sound.output, HasSubstr("sound; commit 1, 2 keyframes, 4 landmarks, 0 objects, 0 events\n"));
  std::string bytes = content(store);
  const std::size_t patch = bytes.find(std::string(100, char{77}));
  ASSERT_NE(patch, std::string::npos);
  bytes[patch + 50] ^= 4;
  std::ofstream(store, std::ios::binary) << bytes;
  const Outcome damaged = run({"verify", store});
  EXPECT_EQ(damaged.exit_code, 1);
  EXPECT_THAT(damaged.errors, HasSubstr("map.db: table looks, row 0: the checksum differs"));
  EXPECT_EQ(run({"verify", out("nowhere.db")}).exit_code, 1);
}

TEST_F(Map, VerifySaysWhatIsNotUsed) {
  map_.keyframes.pop_back();
  EXPECT_THAT(run({"verify", stored()}).output, HasSubstr("2 rows without their other half"));
}

TEST_F(Map, IsReadWhileTheDaemonWrites) {
  auto writer = MapStore::open(folder_.path() / "map.db", StoreMode::read_write);
  ASSERT_TRUE(writer && writer->commit(map_));
  EXPECT_EQ(run({"verify", out("map.db")}).exit_code, 0);
  EXPECT_EQ(run({"info", out("map.db")}).exit_code, 0);
  EXPECT_EQ(run({"export", out("map.db"), "--ply", out("map.ply")}).exit_code, 0);
  EXPECT_TRUE(writer->commit(map_));
}

TEST_F(Map, PointsComeOutWhereTheyAre) {
  const std::string store = stored();
  ASSERT_EQ(run({"export", store, "--ply", out("map.ply"), "--keyframes"}).exit_code, 0);
  const std::string ply = content(out("map.ply"));
  const std::size_t header = ply.find("end_header\n") + 11;
  ASSERT_EQ(ply.size(), header + 6 * 15);
  float point[3];
  std::memcpy(point, ply.data() + header + 3 * 15, sizeof point);
  EXPECT_NEAR(point[0], 4.01, 1e-6);
  EXPECT_NEAR(point[1], 2.01, 1e-6);
  EXPECT_EQ(static_cast<std::uint8_t>(ply[header + 12]), 77);
  const auto parsed = scores::parse_ply(ply, "map.ply");
  ASSERT_TRUE(parsed) << parsed.error().message;
  EXPECT_EQ(parsed->vertices.size(), 6u);
}

TEST_F(Map, FloorPlanIsFreeWhereRaysPassAndOccupiedWhereTheyEnd) {
  const auto grid = occupancy_of(map_, {});
  ASSERT_TRUE(grid) << grid.error().message;
  EXPECT_EQ(grid->at(3.01, 0.01), OccupancyGrid::occupied);
  EXPECT_EQ(grid->at(4.01, 2.01), OccupancyGrid::occupied);
  EXPECT_EQ(grid->at(0.01, 0.01), OccupancyGrid::free);
  EXPECT_EQ(grid->at(2.5, 0.01), OccupancyGrid::free);
  EXPECT_EQ(grid->at(2.0, 2.01), OccupancyGrid::free);
  EXPECT_EQ(grid->at(0.5, 2.01), OccupancyGrid::unknown);   // behind the second camera
  EXPECT_EQ(grid->at(3.2, 0.01), OccupancyGrid::unknown);   // behind the post
  EXPECT_EQ(grid->at(3.01, 0.51), OccupancyGrid::unknown);  // under the lamp, where its ray is above all heights
  EXPECT_EQ(grid->at(1.51, -0.2), OccupancyGrid::unknown);
}

TEST_F(Map, FloorPlanFollowsTheHeights) {
  const auto high = occupancy_of(map_, between(3.0, 5.0));
  ASSERT_TRUE(high);
  EXPECT_EQ(high->at(3.01, 0.51), OccupancyGrid::occupied);
  EXPECT_EQ(high->at(2.5, 0.42), OccupancyGrid::free);  // where the ray to the lamp is above 3 m
  EXPECT_EQ(high->at(0.5, 0.08), OccupancyGrid::unknown);
  EXPECT_EQ(high->at(3.01, 0.01), OccupancyGrid::unknown);
  EXPECT_FALSE(occupancy_of(map_, between(30.0, 50.0)));
  EXPECT_FALSE(occupancy_of({}, {}));
}

TEST_F(Map, FloorPlanIsWrittenAsMapServerReadsIt) {
  const std::string store = stored();
  ASSERT_EQ(run({"export", store, "--occupancy", out("plan"), "--resolution", "0.1"}).exit_code, 0);
  const std::string yaml = content(out("plan.yaml"));
  EXPECT_THAT(yaml, AllOf(HasSubstr("image: plan.pgm\n"), HasSubstr("resolution: 0.1\n"), HasSubstr("negate: 0\n"),
                          HasSubstr("origin: [-0.5, -0.5, 0.0]"), HasSubstr("occupied_thresh: 0.65\n"),
                          HasSubstr("free_thresh: 0.196\n")));
  std::istringstream pgm(content(out("plan.pgm")));
  std::string magic;
  int width = 0, height = 0, white = 0;
  pgm >> magic >> width >> height >> white;
  pgm.get();
  ASSERT_EQ(magic, "P5");
  std::string pixels(static_cast<std::size_t>(width * height), '\0');
  pgm.read(pixels.data(), static_cast<std::streamsize>(pixels.size()));
  ASSERT_TRUE(pgm);
  // The post, 3.01 m east and 0.01 m north: column 35, row 5 from the bottom.
  EXPECT_EQ(static_cast<std::uint8_t>(pixels[static_cast<std::size_t>((height - 1 - 5) * width + 35)]), 0);
  EXPECT_EQ(static_cast<std::uint8_t>(pixels[static_cast<std::size_t>((height - 1 - 5) * width + 34)]), 254);
}

TEST_F(Map, FloorPlanRefusesToFillTheMemory) {
  map_.landmarks[0].p_anchor.x() += 1e6;
  const auto grid = occupancy_of(map_, {});
  ASSERT_FALSE(grid);
  EXPECT_THAT(grid.error().message, HasSubstr("--resolution"));
  map_.landmarks[0].p_anchor.x() = 1e300;
  EXPECT_FALSE(occupancy_of(map_, {}));
}

TEST_F(Map, FloorPlanStaysWithinItsCellsWhateverTheRays) {
  made::MapMaker maker(made::small_pace(5));
  for (int i = 0; i < 20; ++i) maker.next();
  for (const double resolution : {0.05, 0.07, 0.33, 5.0}) {
    OccupancyOptions options;
    options.resolution_m = resolution;
    const auto grid = occupancy_of(maker.truth().content(), options);
    ASSERT_TRUE(grid) << grid.error().message;
    EXPECT_GT(std::count(grid->cells.begin(), grid->cells.end(), OccupancyGrid::free), 0);
  }
}

TEST_F(Map, SaysWhatIsMissing) {
  EXPECT_EQ(run({"export", stored()}).exit_code, 2);
  EXPECT_EQ(run({"export", stored(), "--occupancy", out("x"), "--min-height", "3"}).exit_code, 2);
  EXPECT_EQ(run({"export", stored(), "--ply", "/nowhere/map.ply"}).exit_code, 1);
  EXPECT_THAT(run({}).errors, HasSubstr("ubcommand"));
}

}  // namespace
}  // namespace povslam
