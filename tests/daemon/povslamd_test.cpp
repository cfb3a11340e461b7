// The built daemon as a process.
#include <fcntl.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/wait.h>
#include <unistd.h>

#include <csignal>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <thread>

#include "pipeline/base/time.hpp"
#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::AllOf;
using testing::HasSubstr;

// A child process whose output (both streams) is read through a pipe.
class Process {
 public:
  explicit Process(std::vector<std::string> arguments) {
    int ends[2];
    EXPECT_EQ(pipe2(ends, O_CLOEXEC), 0);
    arguments.insert(arguments.begin(), POVSLAM_BINARY_DIR "/povslamd");
    std::vector<char*> argv;
    for (std::string& argument : arguments) argv.push_back(argument.data());
    argv.push_back(nullptr);
    pid_ = fork();
    if (pid_ == 0) {
      dup2(ends[1], STDOUT_FILENO);
      dup2(ends[1], STDERR_FILENO);
      execv(argv[0], argv.data());
      _exit(127);
    }
    close(ends[1]);
    output_fd_ = ends[0];
  }
  ~Process() {
    if (pid_ > 0) {
      ::kill(pid_, SIGKILL);
      waitpid(pid_, nullptr, 0);
    }
    close(output_fd_);
  }

  bool wait_for(const std::string& text) {
    while (output_.find(text) == std::string::npos) {
      if (!read_some()) return false;
    }
    return true;
  }
  void signal(int number) const { ::kill(pid_, number); }
  int exit_code() {
    while (read_some()) {
    }
    int status = -1;
    waitpid(pid_, &status, 0);
    pid_ = -1;
    return WIFEXITED(status) ? WEXITSTATUS(status) : -WTERMSIG(status);
  }
  const std::string& output() const { return output_; }

 private:
  bool read_some() {
    char buffer[4096];
    const ssize_t n = read(output_fd_, buffer, sizeof buffer);
    if (n > 0) output_.append(buffer, static_cast<std::size_t>(n));
    return n > 0;
  }
  pid_t pid_ = -1;
  int output_fd_ = -1;
  std::string output_;
};

std::vector<std::string> simulated(const std::string& lcm_url) {
  return {"--config", "",
          "--set",    "lcm.url=" + lcm_url,
          "--set",    "sensor.front.width=160",
          "--set",    "sensor.front.height=120"};
}

class Povslamd : public testing::Test {
 protected:
  std::string write(const std::string& text) {
    const std::string file = (folder_.path() / "povslam.toml").string();
    std::ofstream(file) << text;
    return file;
  }
  TempFolder folder_;
};

TEST_F(Povslamd, StopsCleanlyWithinTwoSecondsOfEitherSignal) {
  for (const int signal : {SIGTERM, SIGINT}) {
    Process daemon(simulated("file://" + (folder_.path() / "out.lcm").string() + "?mode=w"));
    ASSERT_TRUE(daemon.wait_for("tracking OK")) << daemon.output();
    const TimeNs begun = monotonic_now();
    daemon.signal(signal);
    EXPECT_EQ(daemon.exit_code(), 0) << daemon.output();
    EXPECT_LT(to_seconds(monotonic_now() - begun), 2.0);
    EXPECT_THAT(daemon.output(), HasSubstr("stopping"));
  }
}

TEST_F(Povslamd, EndsByItselfWithARecording) {
  std::vector<std::string> arguments = simulated("");
  for (const char* more : {"--set", "sensor.front.frames=10", "--set", "sensor.front.realtime=false"}) {
    arguments.emplace_back(more);
  }
  Process daemon(arguments);
  EXPECT_EQ(daemon.exit_code(), 0) << daemon.output();
  EXPECT_THAT(daemon.output(), HasSubstr("the stream is over"));
}

TEST_F(Povslamd, StaysAfterARecordingWhenTold) {
  std::vector<std::string> arguments = simulated("");
  for (const char* more : {"--set", "sensor.front.frames=10", "--set", "sensor.front.realtime=false", "--set",
                           "daemon.exit_at_end=false", "--set", "daemon.health_period_s=0.05"}) {
    arguments.emplace_back(more);
  }
  Process daemon(arguments);
  ASSERT_TRUE(daemon.wait_for("the stream is over")) << daemon.output();
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  daemon.signal(SIGTERM);
  EXPECT_EQ(daemon.exit_code(), 0) << daemon.output();
  EXPECT_THAT(daemon.output(), HasSubstr("stopping"));
}

TEST_F(Povslamd, KeepsItsMapInTheServicesStateFolder) {
  const auto state = folder_.path() / "state";
  setenv("STATE_DIRECTORY", state.c_str(), 1);
  std::vector<std::string> arguments = simulated("");
  for (const char* more : {"--set", "sensor.front.frames=10", "--set", "sensor.front.realtime=false"}) {
    arguments.emplace_back(more);
  }
  Process daemon(arguments);
  EXPECT_EQ(daemon.exit_code(), 0) << daemon.output();
  EXPECT_TRUE(std::filesystem::exists(state / "map.db")) << daemon.output();
  std::filesystem::remove_all(state);
  for (const char* more : {"--set", "map.store="}) arguments.emplace_back(more);
  Process without(arguments);
  EXPECT_EQ(without.exit_code(), 0) << without.output();
  EXPECT_FALSE(std::filesystem::exists(state));
  unsetenv("STATE_DIRECTORY");
}

TEST_F(Povslamd, ExitsWithTwoAndThePlaceOnABadConfiguration) {
  Process bad_value({"--config", write("[orb]\nnum_levels = 99\n")});
  EXPECT_EQ(bad_value.exit_code(), 2);
  EXPECT_THAT(bad_value.output(), AllOf(HasSubstr("povslam.toml:2: orb.num_levels"), HasSubstr("99")));
  Process bad_driver({"--config", write("[[sensor]]\nname = \"a\"\ndriver = \"synthetic\"\nscane = \"aisle\"\n")});
  EXPECT_EQ(bad_driver.exit_code(), 2);
  EXPECT_THAT(bad_driver.output(), AllOf(HasSubstr("povslam.toml:4: "), HasSubstr("scane")));
  Process bad_usage({"--nonsense"});
  EXPECT_EQ(bad_usage.exit_code(), 2);
  Process bad_start({"--config", "", "--start", "1 2 3"});
  EXPECT_EQ(bad_start.exit_code(), 2);
  EXPECT_THAT(bad_start.output(), HasSubstr("--start"));
}

TEST_F(Povslamd, ExitsWithOneWhenTheWorldFails) {
  Process no_camera({"--config", write("[lcm]\nurl = \"\"\n[[sensor]]\ndriver = \"replay\"\npath = \"/nowhere\"\n")});
  EXPECT_EQ(no_camera.exit_code(), 1);
  EXPECT_THAT(no_camera.output(), HasSubstr("/nowhere"));
  std::vector<std::string> arguments = simulated("");
  for (const char* more : {"--set", "map.store=/proc/nowhere/map.db"}) arguments.emplace_back(more);
  Process no_map(arguments);
  EXPECT_EQ(no_map.exit_code(), 1);
  EXPECT_THAT(no_map.output(), HasSubstr("map.store: /proc/nowhere: the folder of the map cannot be made"));
}

TEST_F(Povslamd, SaysWhatItIs) {
  Process version({"--version"});
  EXPECT_EQ(version.exit_code(), 0);
  EXPECT_THAT(version.output(), HasSubstr(POVSLAM_VERSION));
  Process help({"--help"});
  EXPECT_EQ(help.exit_code(), 0);
  EXPECT_THAT(help.output(), AllOf(HasSubstr("--config"), HasSubstr("--print-config")));
  Process check({"--config", "", "--check"});
  EXPECT_EQ(check.exit_code(), 0) << check.output();
}

}  // namespace
}  // namespace povslam
