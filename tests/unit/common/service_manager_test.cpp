// SPDX-License-Identifier: Apache-2.0
#include "core/common/service_manager.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <atomic>
#include <cstdlib>
#include <string>

#include "tests/support/notify_socket.hpp"

namespace tessera::common {
namespace {

using testing::HasSubstr;
using testing::StartsWith;

class ServiceManagerTest : public testing::Test {
 protected:
  ServiceManagerTest() { setenv("NOTIFY_SOCKET", name_.c_str(), 1); }
  ~ServiceManagerTest() override {
    for (const char* name : {"NOTIFY_SOCKET", "WATCHDOG_USEC", "WATCHDOG_PID"}) unsetenv(name);
  }

  const std::string name_ = "@tessera-test-" + std::to_string(::getpid());
  test::NotifySocket socket_{name_};
  std::atomic<int> calls_ = 0;
};

TEST_F(ServiceManagerTest, IsFoundInTheEnvironment) {
  EXPECT_TRUE(ServiceManager::from_environment().is_present());
  EXPECT_FALSE(ServiceManager::from_environment().watchdog());
  setenv("WATCHDOG_USEC", "3000000", 1);
  EXPECT_EQ(ServiceManager::from_environment().watchdog(), std::chrono::seconds(3));
  setenv("WATCHDOG_PID", std::to_string(getpid()).c_str(), 1);
  EXPECT_EQ(ServiceManager::from_environment().watchdog(), std::chrono::seconds(3));
}

TEST_F(ServiceManagerTest, HasNoWatchdogForOtherProcessesAndWithoutANumber) {
  setenv("WATCHDOG_USEC", "3000000", 1);
  setenv("WATCHDOG_PID", "1", 1);
  EXPECT_FALSE(ServiceManager::from_environment().watchdog());
  unsetenv("WATCHDOG_PID");
  for (const char* text : {"", "0", "-1", "soon", "3s"}) {
    setenv("WATCHDOG_USEC", text, 1);
    EXPECT_FALSE(ServiceManager::from_environment().watchdog()) << text;
  }
}

TEST_F(ServiceManagerTest, TakesMessagesAtAPath) {
  const std::string path = testing::TempDir() + "notify." + std::to_string(::getpid());
  const test::NotifySocket at_path(path);
  setenv("NOTIFY_SOCKET", path.c_str(), 1);
  EXPECT_TRUE(ServiceManager::from_environment().send("READY=1"));
  EXPECT_EQ(at_path.receive(), "READY=1");
  ::unlink(path.c_str());
  const auto sent = ServiceManager::from_environment().send("READY=1");
  ASSERT_FALSE(sent);
  EXPECT_EQ(sent.error().message,
            "the service manager at " + path + " does not take messages: No such file or directory");
}

TEST_F(ServiceManagerTest, MustHaveAShortName) {
  setenv("NOTIFY_SOCKET", std::string(200, '/').c_str(), 1);
  const auto sent = ServiceManager::from_environment().send("READY=1");
  ASSERT_FALSE(sent);
  EXPECT_THAT(sent.error().message, HasSubstr("File name too long"));
}

TEST_F(ServiceManagerTest, LearnsOfTheLifeOfAProcess) {
  ServiceReport report([] { return "idle\nSTOPPING=1"; });
  EXPECT_EQ(socket_.receive(), "READY=1");
  EXPECT_EQ(socket_.receive(), "STATUS=idle\\x0aSTOPPING=1");
  report.reloading();
  EXPECT_THAT(socket_.receive(), StartsWith("RELOADING=1\nMONOTONIC_USEC="));
  report.reloaded();
  EXPECT_EQ(socket_.receive(), "READY=1");
  report.stopping();
  EXPECT_EQ(socket_.receive(), "STOPPING=1\nSTATUS=stopping");
  report.stopping();
  report.reloaded();
  EXPECT_EQ(socket_.receive(0), "") << "nothing is sent after the stop";
}

TEST_F(ServiceManagerTest, GetsSignsOfLifeAndTheStatusOnlyWhenItChanges) {
  setenv("WATCHDOG_USEC", "3000", 1);
  ServiceReport report([this] { return ++calls_ < 3 ? "starting" : "idle"; });
  EXPECT_EQ(socket_.receive(), "READY=1");
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1\nSTATUS=starting");
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1");
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1\nSTATUS=idle");
  EXPECT_EQ(socket_.receive(), "WATCHDOG=1");
}

TEST_F(ServiceManagerTest, GetsNoSignOfLifeOfAProcessThatDoesNotWork) {
  setenv("WATCHDOG_USEC", "3000", 1);
  {
    ServiceReport report([this]() -> std::optional<std::string> {
      if (++calls_ == 1) return "idle";
      return std::nullopt;
    });
    EXPECT_EQ(socket_.receive(), "READY=1");
    EXPECT_EQ(socket_.receive(), "WATCHDOG=1\nSTATUS=idle");
    while (calls_ < 5) std::this_thread::yield();
  }
  EXPECT_EQ(socket_.receive(), "STOPPING=1\nSTATUS=stopping");
}

TEST_F(ServiceManagerTest, IsOptional) {
  unsetenv("NOTIFY_SOCKET");
  EXPECT_TRUE(ServiceManager::from_environment().send("READY=1"));
  {
    ServiceReport report([this] {
      ++calls_;
      return "idle";
    });
    report.reloading();
    report.reloaded();
  }
  EXPECT_EQ(calls_, 0);
}

}  // namespace
}  // namespace tessera::common
