// SPDX-License-Identifier: Apache-2.0
// Coordinator and worker under a service manager: its socket, its journal, and files of options.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <netinet/in.h>
#include <signal.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>

#include <memory>
#include <stdexcept>
#include <string>
#include <vector>

#include "core/base/open_file.hpp"
#include "tests/integration/processes.hpp"
#include "tests/support/notify_socket.hpp"

namespace tessera::test {
namespace {

using ::testing::HasSubstr;
using ::testing::StartsWith;

constexpr auto kTimeout = std::chrono::seconds(60);

// A socket that listens on the loopback address, at this descriptor, for child processes.
class PassedOn {
 public:
  explicit PassedOn(int descriptor) : descriptor_(descriptor) {
    const core::OpenFile socket(::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0));
    sockaddr_in address{};
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    socklen_t size = sizeof address;
    auto* const any = reinterpret_cast<sockaddr*>(&address);
    if (::bind(socket.get(), any, size) != 0 || ::listen(socket.get(), 16) != 0 ||
        ::getsockname(socket.get(), any, &size) != 0 || ::dup2(socket.get(), descriptor) < 0)
      throw std::runtime_error("cannot listen on the loopback address");
    port_ = ntohs(address.sin_port);
  }
  ~PassedOn() { ::close(descriptor_); }
  PassedOn(const PassedOn&) = delete;
  PassedOn& operator=(const PassedOn&) = delete;
  int port() const { return port_; }
  bool listens() const {
    int accepts = 0;
    socklen_t size = sizeof accepts;
    return ::getsockopt(descriptor_, SOL_SOCKET, SO_ACCEPTCONN, &accepts, &size) == 0 && accepts != 0;
  }

 private:
  int descriptor_, port_ = 0;
};

class ServiceTest : public ::testing::Test {
 protected:
  // A program under a manager that expects signs of life.
  std::unique_ptr<Process> start(const std::string& program, const std::vector<std::string>& options) {
    std::vector<std::string> arguments{program};
    arguments.insert(arguments.end(), options.begin(), options.end());
    return std::make_unique<Process>(
        ProcessOptions{.arguments = arguments,
                       .out = folder_ / "out",
                       .err = folder_ / "err",
                       .environment = {{"NOTIFY_SOCKET", folder_ / "notify"}, {"WATCHDOG_USEC", "300000"}}});
  }
  std::unique_ptr<Process> start_coordinator() {
    return start(TESSERA_COORDINATOR_PROGRAM,
                 {"--state", folder_ / "state", "--listen", "127.0.0.1:0", "--http", "off"});
  }
  // The exit code and stderr of a program that ends by itself.
  std::pair<ExitCode, std::string> run(const std::vector<std::string>& arguments) {
    Process process({.arguments = arguments, .out = folder_ / "out", .err = folder_ / "err"});
    const auto exit_code = process.wait(kTimeout);
    return {exit_code.value_or(-1), process.err()};
  }

  TempFolder folder_;
  NotifySocket manager_{folder_ / "notify"};
};

TEST_F(ServiceTest, ACoordinatorTellsItsManagerHowItDoes) {
  const auto coordinator = start_coordinator();
  EXPECT_EQ(manager_.receive(), "READY=1");
  EXPECT_THAT(coordinator->out(), HasSubstr("listening on ")) << "it is ready before it can be called";
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1\nSTATUS=0 jobs running, 0 validating; 0 workers, 0 of them busy");
  EXPECT_TRUE(manager_.receives("WATCHDOG=1"));
  coordinator->signal(SIGHUP);
  EXPECT_TRUE(manager_.receives("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(manager_.receives("READY=1"));
  coordinator->signal(SIGTERM);
  EXPECT_TRUE(manager_.receives("STOPPING=1"));
  EXPECT_EQ(coordinator->wait(kTimeout), 0);
  EXPECT_EQ(manager_.receive(0), "");
}

TEST_F(ServiceTest, AWorkerTellsItsManagerHowItDoes) {
  const auto worker =
      start(TESSERA_WORKER, {"--coordinator", "127.0.0.1:1", "--cache", folder_ / "cache", "--threads", "1"});
  EXPECT_EQ(manager_.receive(), "READY=1");
  EXPECT_EQ(manager_.receive(), "WATCHDOG=1\nSTATUS=no connection to 127.0.0.1:1");
  EXPECT_TRUE(manager_.receives("WATCHDOG=1"));
  worker->signal(SIGHUP);
  EXPECT_TRUE(manager_.receives("RELOADING=1\nMONOTONIC_USEC="));
  EXPECT_TRUE(manager_.receives("READY=1"));
  worker->signal(SIGTERM);
  EXPECT_TRUE(manager_.receives("STOPPING=1"));
  EXPECT_EQ(worker->wait(kTimeout), 0);
}

// Descriptors 8 and 9, which a shell moves to where a manager passes them on.
TEST_F(ServiceTest, ACoordinatorListensAtTheSocketsOfItsManager) {
  const PassedOn grpc(8), page(9);
  const std::string script =
      "LISTEN_PID=$$ LISTEN_FDS=2 LISTEN_FDNAMES=grpc:http exec \"$0\" \"$@\" 3<&8 4<&9 8<&- 9<&-";
  const auto coordinator = start("/bin/sh", {"-c", script, TESSERA_COORDINATOR_PROGRAM, "--state",
                                             folder_ / "state", "--listen", "127.0.0.1:1"});
  EXPECT_EQ(manager_.receive(), "READY=1") << coordinator->err();
  EXPECT_THAT(coordinator->out(), HasSubstr("listening on 127.0.0.1:" + std::to_string(grpc.port()) + "\n"));
  EXPECT_THAT(coordinator->out(), HasSubstr("http://127.0.0.1:" + std::to_string(page.port()) + "/"));
  EXPECT_EQ(run({TESSERA_CLIENT, "jobs", "--coordinator", "127.0.0.1:" + std::to_string(grpc.port())}).first,
            0);
  coordinator->signal(SIGTERM);
  EXPECT_EQ(coordinator->wait(kTimeout), 0);
  EXPECT_TRUE(grpc.listens() && page.listens()) << "for the next start";
}

TEST_F(ServiceTest, FilesOfOptionsAreRead) {
  write_file(folder_ / "coordinator.conf",
             "listen = 127.0.0.1:0\nhttp = off\nstate = " + (folder_ / "state").string() + "\n");
  const auto coordinator = start(TESSERA_COORDINATOR_PROGRAM, {"--config", folder_ / "coordinator.conf"});
  EXPECT_EQ(manager_.receive(), "READY=1");
  EXPECT_TRUE(std::filesystem::exists(folder_ / "state/tessera.db"));
  coordinator->signal(SIGTERM);
  EXPECT_EQ(coordinator->wait(kTimeout), 0);
  write_file(folder_ / "worker.conf",
             "coordinator = 127.0.0.1:1\nthread = 1\ncache = " + (folder_ / "cache").string() + "\n");
  const auto [exit_code, error] = run({TESSERA_WORKER, "--config", folder_ / "worker.conf"});
  EXPECT_EQ(exit_code, 2);
  EXPECT_THAT(error, StartsWith("tessera-worker: error: " + (folder_ / "worker.conf").string() +
                                ":2: there is no option 'thread'; did you mean 'threads'?\n"));
}

// What the packages install. With every line that they show as an example, too.
TEST_F(ServiceTest, InstalledFilesOfOptionsAreValid) {
  for (const auto& [program, name] : {std::pair(TESSERA_COORDINATOR_PROGRAM, "coordinator.conf"),
                                      std::pair(TESSERA_WORKER, "worker.conf")}) {
    std::string text = read_file(std::string(TESSERA_SOURCE_DIR "/deploy/systemd/") + name);
    ASSERT_FALSE(text.empty());
    int examples = 0;
    for (std::size_t at = text.find("\n#"); at != std::string::npos; at = text.find("\n#", at + 1)) {
      if (text.compare(at, 3, "\n# ") == 0) continue;
      text.erase(at + 1, 1);
      ++examples;
    }
    EXPECT_GT(examples, 3);
    write_file(folder_ / name, text);
    const auto [exit_code, error] = run({program, "--config", folder_ / name, "--help"});
    EXPECT_EQ(exit_code, 0) << error;
  }
}

TEST_F(ServiceTest, ErrorsHaveAPriorityInTheJournal) {
  write_file(folder_ / "err", "");
  struct stat status {};
  ASSERT_EQ(::stat((folder_ / "err").c_str(), &status), 0);
  write_file(folder_ / "state", "not a folder");
  Process process({.arguments = {TESSERA_COORDINATOR_PROGRAM, "--state", folder_ / "state", "--http", "off"},
                   .out = folder_ / "out",
                   .err = folder_ / "err",
                   .environment = {{"JOURNAL_STREAM",
                                    std::to_string(status.st_dev) + ":" + std::to_string(status.st_ino)}}});
  EXPECT_EQ(process.wait(kTimeout), 1);
  EXPECT_THAT(process.err(), HasSubstr("<3>tessera-coordinator: error: "));
}

}  // namespace
}  // namespace tessera::test
