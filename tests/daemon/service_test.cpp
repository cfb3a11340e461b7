#include "daemon/service.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/un.h>
#include <unistd.h>

#include <cstdlib>
#include <fstream>
#include <sstream>

#include "tests/support/temp_folder.hpp"

namespace povslam {
namespace {

using testing::HasSubstr;

// Stands in for systemd: a datagram socket that NOTIFY_SOCKET names.
class NotifySocket {
 public:
  NotifySocket() {
    fd_ = socket(AF_UNIX, SOCK_DGRAM | SOCK_NONBLOCK | SOCK_CLOEXEC, 0);
    sockaddr_un address{};
    address.sun_family = AF_UNIX;
    const std::string path = (folder_.path() / "notify").string();
    path.copy(address.sun_path, sizeof address.sun_path - 1);
    EXPECT_EQ(bind(fd_, reinterpret_cast<const sockaddr*>(&address), sizeof address), 0);
    setenv("NOTIFY_SOCKET", path.c_str(), 1);
  }
  ~NotifySocket() {
    unsetenv("NOTIFY_SOCKET");
    close(fd_);
  }
  std::string received() {
    std::string all;
    char buffer[1024];
    for (ssize_t n = 0; (n = recv(fd_, buffer, sizeof buffer, 0)) > 0;) all += std::string(buffer, n) + "\n";
    return all;
  }

 private:
  TempFolder folder_;
  int fd_ = -1;
};

Health healthy() {
  Health health;
  health.state = TrackState::ok;
  health.sensors_up = 1;
  return health;
}

TEST(Service, TellsSystemdWhatHappens) {
  NotifySocket systemd;
  Service service;
  service.ready();
  EXPECT_THAT(systemd.received(), HasSubstr("READY=1"));
  service.on_health(healthy());
  EXPECT_THAT(systemd.received(), testing::AllOf(HasSubstr("WATCHDOG=1"), HasSubstr("STATUS=tracking OK")));
  service.on_health(healthy());
  EXPECT_THAT(systemd.received(), testing::Not(HasSubstr("STATUS")));  // once per change
  Health lost = healthy();
  lost.state = TrackState::lost;
  service.on_health(lost);
  EXPECT_THAT(systemd.received(), HasSubstr("STATUS=tracking LOST"));
  service.stopping();
  EXPECT_THAT(systemd.received(), HasSubstr("STOPPING=1"));
}

TEST(Service, StarvesTheWatchdogOnlyWhenTrackingHangs) {
  NotifySocket systemd;
  Service service;
  Health unplugged = healthy();
  unplugged.sensors_up = 0;
  unplugged.sensors_down = 1;
  service.on_health(unplugged);
  EXPECT_THAT(systemd.received(), testing::AllOf(HasSubstr("WATCHDOG=1"), HasSubstr("1 sensor down")));
  Health hanging = healthy();
  hanging.tracking_alive = false;
  service.on_health(hanging);
  EXPECT_THAT(systemd.received(), testing::AllOf(testing::Not(HasSubstr("WATCHDOG=1")), HasSubstr("tracking hangs")));
}

TEST(Service, SaysWhenTheMapIsNotStoredAndWhenItIsAgain) {
  NotifySocket systemd;
  Service service;
  Health health = healthy();
  health.store.state = StoreState::ok;
  service.on_health(health);
  EXPECT_THAT(systemd.received(), testing::Not(HasSubstr("DEGRADED")));
  health.store.state = StoreState::failing;
  service.on_health(health);
  EXPECT_THAT(systemd.received(), HasSubstr("DEGRADED: the map is not being stored"));
  service.on_health(health);
  EXPECT_THAT(systemd.received(), testing::Not(HasSubstr("STATUS")));
  health.store.state = StoreState::ok;
  service.on_health(health);
  EXPECT_THAT(systemd.received(), testing::AllOf(HasSubstr("STATUS"), testing::Not(HasSubstr("DEGRADED"))));
}

// systemd-analyze on the unit, with ExecStart pointing at a program that exists here.
class Unit : public testing::Test {
 protected:
  void SetUp() override {
    if (std::system("command -v systemd-analyze >/dev/null") != 0) GTEST_SKIP() << "no systemd-analyze here";
    std::ifstream stream(POVSLAM_SOURCE_DIR "/systemd/povslamd.service");
    std::stringstream text;
    text << stream.rdbuf();
    std::string unit = text.str();
    const std::string program = "/usr/bin/povslamd";
    ASSERT_NE(unit.find(program), std::string::npos);
    unit.replace(unit.find(program), program.size(), "/bin/true");
    std::ofstream(file_) << unit;
  }
  std::string output_of(const std::string& command, int& exit_code) {
    std::FILE* pipe = popen((command + " 2>&1").c_str(), "r");
    std::string all;
    char buffer[512];
    while (std::fgets(buffer, sizeof buffer, pipe) != nullptr) all += buffer;
    exit_code = pclose(pipe);
    return all;
  }
  TempFolder folder_;
  std::string file_ = (folder_.path() / "povslamd.service").string();
};

TEST_F(Unit, IsAcceptedWithoutAWarning) {
  int exit_code = -1;
  const std::string output = output_of("systemd-analyze verify " + file_, exit_code);
  EXPECT_EQ(exit_code, 0);
  EXPECT_THAT(output, testing::Not(HasSubstr("povslamd.service:"))) << "unknown keys are only warned about";
}

TEST_F(Unit, IsASandbox) {
  int exit_code = -1;
  const std::string output =
      output_of("systemd-analyze security --offline=true --threshold=20 --no-pager " + file_, exit_code);
  EXPECT_EQ(exit_code, 0) << output;
}

}  // namespace
}  // namespace povslam
