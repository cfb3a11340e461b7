#include "daemon/config_file_network.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <fstream>
#include <iterator>

#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

namespace fs = std::filesystem;
using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

const fs::path kModel = fs::path(POVSLAM_SOURCE_DIR) / ".." / "shared/models/yolox_nano/yolox_nano.onnx";

std::string complaint(const std::string& file, const std::string& classes = "auto") {
  AppConfig config;
  config.network.file = file;
  config.labels.classes = classes;
  const auto namer = load_namer(config);
  return namer ? "accepted" : namer.error().message;
}

class NetworkFile : public testing::Test {
 protected:
  std::string write(const std::string& content) {
    const fs::path file = folder_.path() / "net.onnx";
    std::ofstream(file, std::ios::binary) << content;
    return file.string();
  }
  TempFolder folder_;
};

TEST_F(NetworkFile, IsAskedForByItsKey) {
  EXPECT_THAT(complaint(""), AllOf(StartsWith("network.file: "), HasSubstr("understanding.labels")));
  EXPECT_THAT(complaint("/nowhere/net.onnx"), StartsWith("network.file: /nowhere/net.onnx: there is no such file"));
  EXPECT_THAT(complaint(folder_.path().string()), HasSubstr("there is no such file")) << "a folder";
}

TEST_F(NetworkFile, ThatIsNoNetworkIsRefusedByName) {
  for (const std::string& content : {std::string(), std::string("no network"), std::string(5000, '\xFF')}) {
    const std::string file = write(content);
    EXPECT_THAT(complaint(file), StartsWith("network.file: " + file + ": "));
  }
}

TEST_F(NetworkFile, CutOffOrDamagedIsRefusedOrWorksButNeverEndsTheProgram) {
  if (!fs::exists(kModel)) GTEST_SKIP() << "no model in ../shared";
  std::ifstream stream(kModel, std::ios::binary);
  const std::string whole{std::istreambuf_iterator<char>(stream), {}};
  for (const std::size_t length : {whole.size() / 3, whole.size() - 1}) {
    EXPECT_THAT(complaint(write(whole.substr(0, length))), StartsWith("network.file: "));
  }
  for (const std::size_t at : {std::size_t{40}, whole.size() / 2, whole.size() - 300}) {
    std::string damaged = whole;
    for (std::size_t i = 0; i < 16; ++i) damaged[at + i] = static_cast<char>(0x5A + i);
    static_cast<void>(complaint(write(damaged)));
  }
}

TEST_F(NetworkFile, GoesWithTheTableOfItsClasses) {
  if (!fs::exists(kModel)) GTEST_SKIP() << "no model in ../shared";
  EXPECT_EQ(complaint(kModel.string()), "accepted");
  const fs::path table = folder_.path() / "many.toml";
  std::ofstream(table) << "name = \"many\"\nclass = [{id = 81, name = \"box\", kind = \"semi_static\"}]\n";
  EXPECT_THAT(complaint(kModel.string(), table.string()),
              AllOf(StartsWith("labels.classes: "), HasSubstr("81"), HasSubstr("80")));
}

TEST(NetworkInput, MustBeAMultipleOfItsLargestStride) {
  AppConfig config;
  config.pipeline.understanding.naming.input_px = 400;
  const auto namer = load_namer(config);
  ASSERT_FALSE(namer);
  EXPECT_THAT(namer.error().message, StartsWith("network.input_px: 400"));
}

}  // namespace
}  // namespace povslam
