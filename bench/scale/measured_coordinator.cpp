// SPDX-License-Identifier: Apache-2.0
#include "bench/scale/measured_coordinator.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <signal.h>
#include <sys/wait.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <iterator>
#include <sstream>
#include <thread>
#include <utility>
#include <vector>

namespace tessera::bench {
namespace {

using namespace std::chrono_literals;

constexpr auto kStartTimeout = 20s;

std::string read_file(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

// Runs in the child process: executes the coordinator, with its output in a file.
[[noreturn]] void become(const MeasuredCoordinator::Options& options, const std::filesystem::path& log) {
  if (options.core) {
    cpu_set_t cores;
    CPU_ZERO(&cores);
    CPU_SET(static_cast<std::size_t>(*options.core), &cores);
    sched_setaffinity(0, sizeof cores, &cores);
  }
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_TRUNC, 0600);
  if (file < 0 || ::dup2(file, STDOUT_FILENO) < 0 || ::dup2(file, STDERR_FILENO) < 0) ::_exit(127);
  const std::string state = options.folder / "state";
  std::vector<const char*> arguments{options.program.c_str(),
                                     "--listen",
                                     "127.0.0.1:0",
                                     "--state",
                                     state.c_str(),
                                     "--max-calls-per-second",
                                     "1e9",
                                     "--http",
                                     options.has_page ? "127.0.0.1:0" : "off"};
  for (const std::string& option : options.more) arguments.push_back(option.c_str());
  arguments.push_back(nullptr);
  ::execv(options.program.c_str(), const_cast<char* const*>(arguments.data()));
  ::_exit(127);
}

// What is between the key and `end`. Empty until the log has it.
std::string said(const std::string& log, const std::string& key, char last) {
  const std::size_t begin = log.find(key), end = log.find(last, begin + key.size());
  if (begin == std::string::npos || end == std::string::npos) return {};
  return log.substr(begin + key.size(), end - begin - key.size());
}

// The number after "KEY:" in one of the files of /proc/PID; 0 if there is none.
std::uint64_t proc_number(pid_t pid, const char* file, const std::string& key) {
  std::istringstream lines(read_file(fmt::format("/proc/{}/{}", pid, file)));
  for (std::string line; std::getline(lines, line);)
    if (line.starts_with(key + ":")) return std::stoull(line.substr(key.size() + 1));
  return 0;
}

double cpu_seconds(pid_t pid) {
  const std::string stat = read_file(fmt::format("/proc/{}/stat", pid));
  // The fields from the third on follow the program's name, which may contain any character.
  std::istringstream fields(stat.substr(stat.rfind(')') + 2));
  std::string field;
  for (int i = 3; i < 14; ++i) fields >> field;
  double user = 0, system = 0;
  fields >> user >> system;
  return (user + system) / static_cast<double>(::sysconf(_SC_CLK_TCK));
}

}  // namespace

core::Result<MeasuredCoordinator> MeasuredCoordinator::start(const Options& options) {
  const std::filesystem::path log = options.folder / "coordinator.log";
  const pid_t pid = ::fork();
  if (pid == 0) become(options, log);
  if (pid < 0) return core::fail(core::ErrorCode::kResourceExhausted, "cannot start another process");
  MeasuredCoordinator coordinator(pid);
  for (const auto end = std::chrono::steady_clock::now() + kStartTimeout;
       std::chrono::steady_clock::now() < end;) {
    const std::string output = read_file(log);
    coordinator.address_ = said(output, "listening on ", '\n');
    coordinator.page_address_ = said(output, "the page is at http://", '/');
    if (!coordinator.address_.empty() && coordinator.page_address_.empty() != options.has_page)
      return coordinator;
    std::this_thread::sleep_for(10ms);
  }
  return core::fail(core::ErrorCode::kUnavailable,
                    fmt::format("{} does not listen:\n{}", options.program.string(), read_file(log)));
}

MeasuredCoordinator::MeasuredCoordinator(MeasuredCoordinator&& other) noexcept
    : pid_(std::exchange(other.pid_, -1)),
      address_(std::move(other.address_)),
      page_address_(std::move(other.page_address_)) {}

MeasuredCoordinator::~MeasuredCoordinator() {
  if (pid_ < 0) return;
  ::kill(pid_, SIGTERM);
  ::waitpid(pid_, nullptr, 0);
}

Usage MeasuredCoordinator::usage() const {
  return {.cpu_seconds = cpu_seconds(pid_),
          .resident_bytes = 1024 * proc_number(pid_, "status", "VmRSS"),
          .most_resident_bytes = 1024 * proc_number(pid_, "status", "VmHWM"),
          .written_bytes = proc_number(pid_, "io", "wchar")};
}

}  // namespace tessera::bench
