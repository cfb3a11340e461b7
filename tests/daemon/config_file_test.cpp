#include "daemon/config_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <rapidcheck.h>

#include <fstream>
#include <sstream>

#include "daemon/config_keys.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::StartsWith;

constexpr const char* kSensor = "[[sensor]]\nname = \"front\"\ndriver = \"synthetic\"\n";

std::string with(const std::string& lines) {
  return lines + "\n" + kSensor;
}

std::string complaint(const std::string& text, std::vector<std::string> overrides = {}) {
  const auto config = parse_config(text, "robot.toml", overrides);
  return config ? "accepted" : config.error().message;
}

struct Parts {
  std::string section, name;
};
Parts parts_of(const std::string& path) {
  const std::size_t dot = path.find('.');
  return {path.substr(0, dot), path.substr(dot + 1)};
}

TEST(Config, FileInTheRepositoryIsWhatTheDaemonPrints) {
  std::ifstream stream(POVSLAM_SOURCE_DIR "/config/povslam.toml");
  std::stringstream text;
  text << stream.rdbuf();
  EXPECT_EQ(text.str(), default_config_text());
}

TEST(Config, PrintedDefaultsAreTheDefaults) {
  const auto printed = parse_config(default_config_text(), "defaults", {});
  ASSERT_TRUE(printed) << printed.error().message;
  const auto bare = parse_config(kSensor, "bare", {});
  ASSERT_TRUE(bare) << bare.error().message;
  AppConfig a = *printed, b = *bare;
  for (const Key<AppConfig>& key : config_keys()) {
    std::visit([&](auto member) { EXPECT_EQ(member(a), member(b)) << key.path; }, key.member);
  }
  EXPECT_EQ(a.sensors[0].options.at("scene"), "aisle");
}

TEST(Config, AnEnumerationTakesItsNamesOnly) {
  const auto config = parse_config(with("[vem]\nsolver = \"ceres\"\ngate = \"none\""), "robot.toml", {});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->pipeline.backend.vem.solver, VemSolver::ceres);
  EXPECT_EQ(config->pipeline.backend.vem.gate, VemGate::none);
  EXPECT_EQ(config->pipeline.backend.vem.pool, VemOptions{}.pool);
  EXPECT_THAT(complaint(with("[vem]\nsolver = \"dense\"")),
              AllOf(HasSubstr("robot.toml:2"), HasSubstr("one of \"structured\", \"ceres\""), HasSubstr("dense")));
}

TEST(Config, EveryKeyRefusesEveryOtherTypeWithFileLineAndKey) {
  const std::vector<std::string> values = {"\"\"",   "\"nonsense\"", "nan",        "-1e300",         "1e300", "[]",
                                           "[1, 2]", "{}",           "1979-05-27", "99999999999999", "-5"};
  for (const Key<AppConfig>& key : config_keys()) {
    const auto [section, name] = parts_of(key.path);
    int refused = 0;
    for (const std::string& value : values) {
      const std::string message = complaint(with("\n[" + section + "]\n" + name + " = " + value));
      if (message == "accepted") continue;
      ++refused;
      EXPECT_THAT(message, AllOf(StartsWith("robot.toml:3: " + key.path + ": expected"), HasSubstr("got")));
    }
    EXPECT_GE(refused, 9) << key.path;  // text takes the two texts, nothing takes more
  }
}

TEST(Config, EveryKeyCanBeSetOnTheCommandLineWithTheSameChecks) {
  for (const Key<AppConfig>& key : config_keys()) {
    const std::string message = complaint(kSensor, {key.path + "=[[]]"});
    const bool free_text = std::holds_alternative<std::string& (*)(AppConfig&)>(key.member) && key.choices.empty();
    if (free_text) {
      EXPECT_EQ(message, "accepted") << key.path;
    } else {
      EXPECT_THAT(message, StartsWith("--set: " + key.path + ": expected"));
    }
  }
}

TEST(Config, EveryNumberHoldsItsRange) {
  for (const Key<AppConfig>& key : config_keys()) {
    const bool number = std::holds_alternative<int& (*)(AppConfig&)>(key.member) ||
                        std::holds_alternative<double& (*)(AppConfig&)>(key.member);
    if (!number) continue;
    const auto [section, name] = parts_of(key.path);
    for (const double beyond : {key.min - 1.0, key.max + 1.0}) {
      std::ostringstream value;
      value << std::fixed << beyond;
      const std::string digits = value.str().substr(0, value.str().find('.'));  // reads as integer and as number
      if (std::stod(digits) >= key.min && std::stod(digits) <= key.max) continue;
      EXPECT_THAT(complaint(with("[" + section + "]\n" + name + " = " + digits)),
                  StartsWith("robot.toml:2: " + key.path + ": expected"));
    }
  }
}

TEST(Config, UnknownKeysNameTheirLineAndTheNearestKey) {
  for (const Key<AppConfig>& key : config_keys()) {
    const auto [section, name] = parts_of(key.path);
    EXPECT_THAT(
        complaint(with("[" + section + "]\n" + name + "x = 1")),
        AllOf(StartsWith("robot.toml:2: " + key.path + "x: unknown key"), HasSubstr("did you mean " + key.path)));
  }
  EXPECT_THAT(complaint(with("[trak]\nmin_inliers_ok = 3")),
              AllOf(StartsWith("robot.toml:1: trak"), HasSubstr("track")));
  EXPECT_THAT(complaint(with("zzzzzz = 3")), HasSubstr("--print-config"));
  EXPECT_THAT(complaint(kSensor, {"orb.num_fetures=3"}), HasSubstr("orb.num_features"));
}

TEST(Config, OrderBetweenKeysHolds) {
  EXPECT_THAT(complaint(with("[noise]\nmin_depth_m = 5.0\nmax_depth_m = 2.0")),
              AllOf(StartsWith("robot.toml:2: noise.min_depth_m"), HasSubstr("must not exceed noise.max_depth_m (2)")));
  EXPECT_THAT(complaint(kSensor, {"noise.max_depth_m=0.2"}), StartsWith("--set: noise.max_depth_m"));
}

TEST(Config, SyntaxErrorsAndDuplicatesNameTheirLine) {
  EXPECT_THAT(complaint("[orb]\nnum_features = \n"), StartsWith("robot.toml:2: "));
  EXPECT_THAT(complaint("[orb]\ncell_px = 8\ncell_px = 9\n"), StartsWith("robot.toml:3: "));
}

TEST(Config, SensorTablesSayWhatIsMissing) {
  EXPECT_THAT(complaint("[orb]\n"), AllOf(StartsWith("robot.toml: sensor"), HasSubstr("[[sensor]]")));
  EXPECT_THAT(complaint("\n[[sensor]]\nname = \"a\""),
              AllOf(StartsWith("robot.toml:2: "), HasSubstr("driver: missing")));
  EXPECT_THAT(complaint(std::string(kSensor) + kSensor), StartsWith("robot.toml:4: sensor: one camera"));
  EXPECT_THAT(complaint("[sensor]\ndriver = \"x\""), HasSubstr("[[sensor]] tables"));
  EXPECT_THAT(complaint(std::string(kSensor) + "scene = [1]"), StartsWith("robot.toml:4: scene: expected"));
  EXPECT_THAT(complaint(std::string(kSensor) + "q_xyzw = [0, 0, 0, 1]\nrpy_deg = [0, 0, 0]"), HasSubstr("not both"));
}

TEST(Config, DriverOptionsArriveAsText) {
  const auto config = parse_config(std::string(kSensor) + "seed = 7\nnoise = 0.5\nblur = true\nscene = \"boxsim\"\n",
                                   "robot.toml", std::vector<std::string>{"sensor.front.seed=8"});
  ASSERT_TRUE(config) << config.error().message;
  const DriverOptions expected{{"seed", "8"}, {"noise", "0.5"}, {"blur", "true"}, {"scene", "boxsim"}};
  EXPECT_EQ(config->sensors[0].options, expected);
  EXPECT_THAT(config->sensors[0].locate("'noise' is '0.5'"), StartsWith("robot.toml:5: sensor.front: "));
  EXPECT_THAT(config->sensors[0].locate("unknown key 'seed'; known are noise"), StartsWith("--set: "));
  EXPECT_THAT(config->sensors[0].locate("disk is full"), StartsWith("robot.toml:1: "));
}

TEST(Config, AnotherDriverOnTheCommandLineDropsTheOptionsOfTheOneBefore) {
  const auto config =
      load_config("", std::vector<std::string>{"sensor.front.driver=replay", "sensor.front.path=/data"});
  ASSERT_TRUE(config) << config.error().message;
  EXPECT_EQ(config->sensors[0].driver, "replay");
  EXPECT_EQ(config->sensors[0].options, (DriverOptions{{"path", "/data"}}));
  EXPECT_THAT(complaint(kSensor, {"sensor.rear.seed=3"}), HasSubstr("sensor.rear.seed"));
}

TEST(Config, MountsByAnglesTurnTheHousing) {
  const auto config =
      parse_config(std::string(kSensor) + "translation_m = [0.1, 0, 0.4]\nrpy_deg = [0, 90, 0]", "r", {});
  ASSERT_TRUE(config) << config.error().message;
  const Rigid3 T_body_camera = config->sensors[0].T_body_sensor();
  EXPECT_LT((T_body_camera.rotation * Eigen::Vector3d::UnitZ() - Eigen::Vector3d(0, 0, -1)).norm(),
            1e-9);  // looks down
  EXPECT_LT((T_body_camera.translation - Eigen::Vector3d(0.1, 0.0, 0.4)).norm(), 1e-12);
}

TEST(Config, UnreadableFileSaysHowToWriteOne) {
  const auto config = load_config("/nowhere/povslam.toml", {});
  ASSERT_FALSE(config);
  EXPECT_THAT(config.error().message, AllOf(StartsWith("/nowhere/povslam.toml: "), HasSubstr("--print-config")));
}

TEST(Config, SurvivesAnyDamageToTheFile) {
  const std::string whole = default_config_text();
  rc::check("each damaged file is read or refused with a message", [&whole] {
    std::string text = whole;
    const int damages = *rc::gen::inRange(1, 6);
    for (int i = 0; i < damages; ++i) {
      const std::size_t at = *rc::gen::inRange<std::size_t>(0, text.size());
      const std::size_t length = *rc::gen::inRange<std::size_t>(0, 20);
      text.replace(at, length, *rc::gen::arbitrary<std::string>());
    }
    const auto config = parse_config(text, "damaged.toml", {});
    if (!config) RC_ASSERT(config.error().message.starts_with("damaged.toml"));
  });
}

TEST(Pose, ReadsSevenNumbersAndNothingElse) {
  const auto pose = parse_pose(" 1 2 3 0 0 0 1 ");
  ASSERT_TRUE(pose);
  EXPECT_EQ(pose->translation, Eigen::Vector3d(1, 2, 3));
  for (const char* bad : {"", "1 2 3", "1 2 3 0 0 0 0", "1 2 3 0 0 0 1 9", "a 2 3 0 0 0 1", "nan 2 3 0 0 0 1"}) {
    EXPECT_FALSE(parse_pose(bad)) << bad;
  }
}

TEST(Config, AutoKeepsTheMapInTheServicesStateFolderAndNowhereWithoutOne) {
  EXPECT_EQ(store_file({}, "/var/lib/povslam"), "/var/lib/povslam/map.db");
  EXPECT_EQ(store_file({}, "/var/lib/povslam:/var/lib/other"), "/var/lib/povslam/map.db");
  EXPECT_EQ(store_file({}, nullptr), "");
  EXPECT_EQ(store_file({}, ""), "");
  EXPECT_EQ(store_file({"/data/hall.db"}, "/var/lib/povslam"), "/data/hall.db");
  EXPECT_EQ(store_file({""}, "/var/lib/povslam"), "");
}

}  // namespace
}  // namespace povslam
