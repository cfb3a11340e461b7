#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>

#include "tools/povslam/scores/frame_list.hpp"
#include "tools/povslam/scores/ply_file.hpp"
#include "tools/povslam/scores/pool.hpp"
#include "tools/povslam/scores/scene_files.hpp"

#include "tests/support/temp_folder.hpp"

namespace povslam::scores {
namespace {

class ScoreFiles : public ::testing::Test {
 protected:
  void SetUp() override {
    folder_ = temp_folder() /
              (std::string("povslam_scores_") + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::remove_all(folder_);
    std::filesystem::create_directories(folder_);
  }
  void TearDown() override { std::filesystem::remove_all(folder_); }

  std::string write(const std::string& name, const std::string& content) {
    std::ofstream(folder_ / name, std::ios::binary) << content;
    return (folder_ / name).string();
  }
  std::filesystem::path folder_;
};

const char* kMoved =
    R"({"seq":1,"t":2.0,"type":"moved","object":3,"class":"box","position":[1,2,3],"yaw":0.5,"size":[1,1,1],)"
    R"("from":{"position":[4,5,6],"yaw":0.1},"consistency":0.9,"probability":0.9})";

std::string binary_triangle(std::size_t cut = 0) {
  std::string file =
      "ply\nformat binary_little_endian 1.0\ncomment x\nelement vertex 3\nproperty float x\n"
      "property float y\nproperty float z\nproperty uchar red\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n";
  const auto put = [&file](auto value) { file.append(reinterpret_cast<const char*>(&value), sizeof value); };
  for (int i = 0; i < 3; ++i) {
    put(static_cast<float>(i));
    put(0.5F);
    put(-1.0F);
    put(static_cast<unsigned char>(200));
  }
  put(static_cast<unsigned char>(3));
  for (const int index : {0, 1, 2}) put(index);
  return file.substr(0, file.size() - cut);
}

}  // namespace

TEST_F(ScoreFiles, AMoveHasBothPlaces) {
  const auto events = read_events(write("events.jsonl", std::string(kMoved) + "\n\n"));
  ASSERT_TRUE(events) << events.error().message;
  ASSERT_EQ(events->size(), 1u);
  EXPECT_EQ(events->front().from->center_world, Eigen::Vector3d(4.0, 5.0, 6.0));
}

TEST_F(ScoreFiles, ABrokenEventNamesFileAndLine) {
  const std::string file = write("events.jsonl", std::string(kMoved) + "\n{\"type\": \"moved\"}\n");
  const auto events = read_events(file);
  ASSERT_FALSE(events);
  EXPECT_EQ(events.error().message.rfind(file + ":2: ", 0), 0u) << events.error().message;
}

TEST_F(ScoreFiles, ABrokenTruthNamesTheByteOrTheKey) {
  const auto cut = read_scene_truth(write("a.json", "{\"lap1_end\": 1.0, \"objects\": ["));
  ASSERT_FALSE(cut);
  EXPECT_NE(cut.error().message.find("byte 31"), std::string::npos) << cut.error().message;
  const auto wrong = read_scene_truth(write("b.json", "{\"objects\": []}"));
  ASSERT_FALSE(wrong);
  EXPECT_NE(wrong.error().message.find("lap1_end"), std::string::npos) << wrong.error().message;
  EXPECT_FALSE(read_scene_truth(folder_ / "missing.json"));
  EXPECT_FALSE(read_scene_truth(folder_));
}

TEST_F(ScoreFiles, AnObjectThatIsNotThereHasNoPlace) {
  const auto truth = read_scene_truth(write(
      "truth.json",
      R"({"t0":0,"lap1_end":30.5,"objects":[{"id":7,"class":"box","size":[1,2,3],"change":"removed","switch_time":20,)"
      R"("before":{"present":true,"position":[1,2,3],"yaw":0.1},"after":{"present":false}}]})"));
  ASSERT_TRUE(truth) << truth.error().message;
  EXPECT_EQ(truth->lap1_end, from_seconds(30.5));
  EXPECT_TRUE(truth->objects[0].before);
  EXPECT_FALSE(truth->objects[0].after);
}

TEST_F(ScoreFiles, ObjectsComeAsAListOrUnderTheirKey) {
  const std::string object = R"({"id":1,"class":"box","position":[0,0,0],"yaw":0,"size":[1,1,1]})";
  EXPECT_EQ(read_reported_objects(write("a.json", "[" + object + "]"))->size(), 1u);
  EXPECT_EQ(read_reported_objects(write("b.json", "{\"objects\":[" + object + "]}"))->size(), 1u);
}

TEST_F(ScoreFiles, FrameListsPreferAssociationsAndNameABadLine) {
  write("rgb.txt", "1.5 rgb/b.png\n0.5 rgb/a.png\n");
  ASSERT_EQ(read_frame_list(folder_)->size(), 2u);
  EXPECT_EQ(read_frame_list(folder_)->front().stamp, from_seconds(0.5));
  write("associations.txt", "# t\n0.5 rgb/a.png 0.5 depth/a.png\nnonsense\n");
  const auto frames = read_frame_list(folder_);
  ASSERT_FALSE(frames);
  EXPECT_NE(frames.error().message.find("associations.txt:3"), std::string::npos);
}

TEST_F(ScoreFiles, PoolingSumsCountsAndNotRatios) {
  const std::string a = write("a.json", R"({"events":{"truth":10,"reported":10,"matched":10,"excused":0},
      "trajectory":{"first_fixed":{"ate_rmse_m":0.01,"ate_mean_m":0.01,"mpe_m":0.02,"rotation_rmse_deg":1},
      "frames":{"total":100,"with_estimate":100}}})");
  const std::string b = write("b.json", R"({"events":{"truth":2,"reported":4,"matched":1,"excused":1},
      "trajectory":{"first_fixed":{"ate_rmse_m":0.03,"ate_mean_m":0.01,"mpe_m":0.02,"rotation_rmse_deg":1},
      "frames":{"total":100,"with_estimate":50}}})");
  const auto pooled = pool_scores({a, b});
  ASSERT_TRUE(pooled) << pooled.error().message;
  EXPECT_NEAR(pooled->at("events").at("precision").get<double>(), 11.0 / 14.0, 1e-12);
  EXPECT_NEAR(pooled->at("events").at("recall").get<double>(), 11.0 / 12.0, 1e-12);
  EXPECT_NEAR(pooled->at("trajectory").at("first_fixed").at("ate_rmse_m").at("median").get<double>(), 0.02, 1e-12);
  EXPECT_NEAR(pooled->at("trajectory").at("frames").at("coverage").get<double>(), 0.75, 1e-12);
}

TEST_F(ScoreFiles, PoolingABrokenFileNamesIt) {
  const std::string file = write("a.json", "{\"events\": {\"truth\": \"many\"}}");
  const auto pooled = pool_scores({file});
  ASSERT_FALSE(pooled);
  EXPECT_EQ(pooled.error().message.rfind(file, 0), 0u);
}

TEST(PlyFile, BinaryMeshWithFurtherPropertiesIsRead) {
  const auto mesh = parse_ply(binary_triangle(), "m.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  EXPECT_EQ(mesh->vertices[2], Eigen::Vector3d(2.0, 0.5, -1.0));
  ASSERT_EQ(mesh->triangles.size(), 1u);
  EXPECT_EQ(mesh->triangles[0][2], 2u);
}

TEST(PlyFile, AsciiPolygonsBecomeFans) {
  const auto mesh = parse_ply(
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\n"
      "property double z\nelement face 1\nproperty list uchar int vertex_index\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n",
      "m.ply");
  ASSERT_TRUE(mesh) << mesh.error().message;
  ASSERT_EQ(mesh->triangles.size(), 2u);
  EXPECT_EQ(mesh->triangles[1], (std::array<std::uint32_t, 3>{0, 2, 3}));
}

TEST(PlyFile, EveryCutIsAnErrorAndNeverACrash) {
  const std::size_t size = binary_triangle().size();
  for (std::size_t cut = 1; cut <= size; ++cut) EXPECT_FALSE(parse_ply(binary_triangle(cut), "m.ply")) << cut;
}

TEST(PlyFile, ImpossibleContentIsRefusedWithItsPlace) {
  const auto refused = [](const std::string& header, const std::string& body) {
    return !parse_ply("ply\nformat ascii 1.0\n" + header + "end_header\n" + body, "m.ply");
  };
  const std::string xyz = "property float x\nproperty float y\nproperty float z\n";
  const std::string faces = "element face 1\nproperty list uchar int vertex_indices\n";
  EXPECT_TRUE(refused("element vertex 1\n" + xyz, "nan 0 0\n"));
  EXPECT_TRUE(refused("element vertex 1\n" + xyz, "1e30 0 0\n"));
  EXPECT_TRUE(refused("element vertex 1\nproperty float x\n", "1\n"));
  EXPECT_TRUE(refused("element vertex 99999999999\n" + xyz, "1 2 3\n"));
  EXPECT_TRUE(refused("element vertex 1\n" + xyz + faces, "0 0 0\n3 0 0 7\n"));
  EXPECT_TRUE(refused("element vertex 1\n" + xyz + faces, "0 0 0\n-3 0 0 0\n"));
  const auto big = parse_ply("ply\nformat binary_big_endian 1.0\nend_header\n", "m.ply");
  ASSERT_FALSE(big);
  EXPECT_EQ(big.error().message.rfind("m.ply:2: ", 0), 0u) << big.error().message;
}

}  // namespace povslam::scores
