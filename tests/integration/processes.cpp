// SPDX-License-Identifier: Apache-2.0
#include "tests/integration/processes.hpp"

#include <fcntl.h>
#include <sched.h>
#include <signal.h>
#include <sys/mount.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <utility>

namespace tessera::test {
namespace {

constexpr auto kPollEvery = std::chrono::milliseconds(10);
constexpr int kCannotStart = 127;

bool enter_network_of(pid_t pid) {
  const std::string path = "/proc/" + std::to_string(pid) + "/ns/net";
  const int network = open(path.c_str(), O_RDONLY | O_CLOEXEC);
  return network >= 0 && setns(network, CLONE_NEWNET) == 0;
}

// In a mount namespace of its own.
bool replace_hosts(const std::filesystem::path& hosts_file) {
  return unshare(CLONE_NEWNS) == 0 && mount("none", "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0 &&
         mount(hosts_file.c_str(), "/etc/hosts", nullptr, MS_BIND, nullptr) == 0;
}

[[noreturn]] void become(const ProcessOptions& options) {
  const auto redirect = [](const std::filesystem::path& path, int descriptor) {
    const int file = open(path.c_str(), O_WRONLY | O_CREAT | O_TRUNC | O_CLOEXEC, 0600);
    if (file < 0 || dup2(file, descriptor) < 0) _exit(kCannotStart);
  };
  redirect(options.out, STDOUT_FILENO);
  redirect(options.err, STDERR_FILENO);
  if (options.network_of != 0 && !enter_network_of(options.network_of)) _exit(kCannotStart);
  if (!options.hosts_file.empty() && !replace_hosts(options.hosts_file)) _exit(kCannotStart);
  if (chdir(options.folder.c_str()) != 0) _exit(kCannotStart);
  for (const auto& [name, value] : options.environment) setenv(name.c_str(), value.c_str(), 1);
  std::vector<char*> arguments;
  for (const std::string& argument : options.arguments)
    arguments.push_back(const_cast<char*>(argument.c_str()));
  arguments.push_back(nullptr);
  execv(arguments[0], arguments.data());
  _exit(kCannotStart);
}

}  // namespace

bool poll_until(Timeout timeout, const std::function<bool()>& condition) {
  const auto end = std::chrono::steady_clock::now() + timeout;
  while (!condition()) {
    if (std::chrono::steady_clock::now() >= end) return false;
    std::this_thread::sleep_for(kPollEvery);
  }
  return true;
}

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

void write_file(const std::filesystem::path& path, const std::string& text) {
  std::ofstream(path, std::ios::binary) << text;
}

TempFolder::TempFolder() {
  std::string pattern = (std::filesystem::temp_directory_path() / "tessera-test-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) std::abort();
  path_ = pattern;
}

TempFolder::~TempFolder() {
  std::error_code ignored;
  std::filesystem::remove_all(path_, ignored);
}

std::optional<std::string> Process::cannot_replace_hosts(const std::filesystem::path& hosts_file) {
  const pid_t child = fork();
  if (child == 0) _exit(replace_hosts(hosts_file) ? 0 : errno);
  int status = 0;
  if (child < 0 || waitpid(child, &status, 0) != child || !WIFEXITED(status)) return "no process";
  if (WEXITSTATUS(status) == 0) return std::nullopt;
  return "no mount namespace, or nothing may be mounted: " + std::string(std::strerror(WEXITSTATUS(status)));
}

Process::Process(ProcessOptions options) : options_(std::move(options)) {
  pid_ = fork();
  if (pid_ < 0) std::abort();
  if (pid_ == 0) become(options_);
}

Process::Process(Process&& other) noexcept
    : options_(std::move(other.options_)), pid_(std::exchange(other.pid_, -1)), ended_(other.ended_) {}

Process::~Process() {
  if (pid_ < 0 || ended_) return;
  kill(pid_, SIGKILL);
  waitpid(pid_, nullptr, 0);
}

void Process::signal(int number) const {
  if (!ended_) kill(pid_, number);
}

std::optional<ExitCode> Process::wait(Timeout timeout) {
  poll_until(timeout, [this] {
    int status = 0;
    if (!ended_ && waitpid(pid_, &status, WNOHANG) == pid_)
      ended_ = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    return ended_.has_value();
  });
  return ended_;
}

bool Process::wait_until_catches(int number, Timeout timeout) const {
  return poll_until(timeout, [&] {
    std::istringstream status(read_file("/proc/" + std::to_string(pid_) + "/status"));
    for (std::string line; std::getline(status, line);) {
      if (!line.starts_with("SigCgt:")) continue;
      return (std::stoull(line.substr(7), nullptr, 16) >> (number - 1) & 1) != 0;
    }
    return false;
  });
}

}  // namespace tessera::test
