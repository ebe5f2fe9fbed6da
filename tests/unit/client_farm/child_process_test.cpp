// SPDX-License-Identifier: Apache-2.0
#include "client/farm/child_process.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <fstream>
#include <optional>
#include <string>
#include <thread>

namespace tessera::client {
namespace {

using std::chrono::seconds;
using ::testing::HasSubstr;

class ChildProcesses : public ::testing::Test {
 protected:
  core::Result<ChildProcess> start(const std::string& script) {
    return ChildProcess::start("/bin/sh", {"-c", script}, log_);
  }
  const std::string log_ = testing::TempDir() + "child_process." + std::to_string(::getpid()) + "." +
                           testing::UnitTest::GetInstance()->current_test_info()->name();
};

TEST_F(ChildProcesses, SayALine) {
  auto child = start("echo hello there; sleep 100");
  ASSERT_TRUE(child);
  EXPECT_EQ(child->wait_for_line("hello ", seconds(20)).value_or(""), "there");
  EXPECT_TRUE(child->is_running());
  const auto other = child->wait_for_line("good ", seconds(0));
  ASSERT_FALSE(other);
  EXPECT_THAT(other.error().message, HasSubstr("does not start"));
}

TEST_F(ChildProcesses, ThatEndAreExplainedByTheirOutput) {
  auto child = start("echo the disk is full >&2; exit 1");
  ASSERT_TRUE(child);
  const auto line = child->wait_for_line("hello", seconds(20));
  ASSERT_FALSE(line);
  EXPECT_EQ(line.error().message, "sh has ended:\nthe disk is full");
  EXPECT_FALSE(child->is_running());
}

TEST_F(ChildProcesses, ThatAreMissingAreNamed) {
  const auto child = ChildProcess::start("/nowhere/tessera-worker", {}, log_);
  ASSERT_FALSE(child);
  EXPECT_THAT(child.error().message, HasSubstr("there is no program '/nowhere/tessera-worker'"));
}

pid_t pid_in(const std::string& log) {
  for (int i = 0; i < 400; ++i) {
    std::ifstream file(log);
    pid_t pid = 0;
    if (std::string rest; file >> pid && std::getline(file, rest)) return pid;
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return 0;
}

bool is_gone_soon(pid_t pid) {
  for (int i = 0; i < 400; ++i) {
    if (::kill(pid, 0) != 0 && errno == ESRCH) return true;
    std::ifstream stat("/proc/" + std::to_string(pid) + "/stat");
    std::string number, name, state;
    if (stat >> number >> name >> state && state == "Z") return true;  // nobody waits for it
    std::this_thread::sleep_for(std::chrono::milliseconds(50));
  }
  return false;
}

TEST_F(ChildProcesses, DieWithTheProcessThatStartedThem) {
  const pid_t parent = ::fork();
  if (parent == 0) {
    const auto child = start("echo $$; sleep 1000");
    ::pause();
    ::_exit(0);
  }
  const pid_t child = pid_in(log_);
  ASSERT_GT(child, 0);
  ::kill(parent, SIGKILL);
  ::waitpid(parent, nullptr, 0);
  EXPECT_TRUE(is_gone_soon(child));
}

}  // namespace
}  // namespace tessera::client
