// SPDX-License-Identifier: Apache-2.0
#include "client/farm/child_process.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <csignal>
#include <cstring>
#include <filesystem>
#include <sstream>
#include <thread>
#include <utility>

#include "client/farm/interruption.hpp"
#include "core/image/file_io.hpp"

namespace tessera::client {
namespace {

constexpr std::chrono::milliseconds kLookPause{50};
constexpr std::chrono::seconds kGrace{5};
constexpr std::size_t kShownBytes = 2000;

// Becomes the program. Between fork() and exec, only functions that are safe in signal handlers are called.
[[noreturn]] void become(const char* program, char* const* arguments, int log, pid_t parent) {
  ::prctl(PR_SET_PDEATHSIG, SIGKILL);
  if (::getppid() != parent) ::_exit(127);  // it died before the line above
  ::setpgid(0, 0);
  ::signal(SIGINT, SIG_DFL);
  ::signal(SIGTERM, SIG_DFL);
  const int nothing = ::open("/dev/null", O_RDONLY);
  ::dup2(nothing, STDIN_FILENO);
  ::dup2(log, STDOUT_FILENO);
  ::dup2(log, STDERR_FILENO);
  ::execv(program, arguments);
  ::_exit(127);
}

// Whether a child has ended within the time.
bool ends_within(pid_t pid, std::chrono::milliseconds time) {
  const auto until = std::chrono::steady_clock::now() + time;
  do {
    if (::waitpid(pid, nullptr, WNOHANG) != 0) return true;
    std::this_thread::sleep_for(kLookPause);
  } while (std::chrono::steady_clock::now() < until);
  return false;
}

}  // namespace

core::Result<ChildProcess> ChildProcess::start(const std::string& program, std::vector<std::string> arguments,
                                               const std::string& log) {
  if (::access(program.c_str(), X_OK) != 0)
    return core::fail(core::ErrorCode::kNotFound,
                      fmt::format("there is no program '{}': install it beside this one", program));
  const int file = ::open(log.c_str(), O_WRONLY | O_CREAT | O_APPEND | O_CLOEXEC, 0600);
  if (file < 0)
    return core::fail(core::ErrorCode::kUnavailable,
                      fmt::format("cannot write '{}': {}", log, std::strerror(errno)));
  std::vector<char*> words{const_cast<char*>(program.c_str())};
  for (std::string& argument : arguments) words.push_back(argument.data());
  words.push_back(nullptr);
  const pid_t parent = ::getpid(), child = ::fork();
  if (child == 0) become(program.c_str(), words.data(), file, parent);
  const int error = errno;
  ::close(file);
  if (child < 0)
    return core::fail(core::ErrorCode::kResourceExhausted,
                      fmt::format("cannot start '{}': {}", program, std::strerror(error)));
  return ChildProcess(child, program, log);
}

ChildProcess::ChildProcess(ChildProcess&& other) noexcept
    : pid_(std::exchange(other.pid_, 0)), program_(std::move(other.program_)), log_(std::move(other.log_)) {}

ChildProcess::~ChildProcess() {
  if (pid_ == 0) return;
  ::kill(pid_, SIGTERM);
  if (ends_within(pid_, kGrace)) return;
  ::kill(pid_, SIGKILL);
  while (::waitpid(pid_, nullptr, 0) < 0 && errno == EINTR) {
  }
}

bool ChildProcess::is_running() {
  if (pid_ != 0 && ::waitpid(pid_, nullptr, WNOHANG) != 0) pid_ = 0;
  return pid_ != 0;
}

core::Result<std::string> ChildProcess::wait_for_line(const std::string& begin,
                                                      std::chrono::seconds timeout) {
  const auto until = std::chrono::steady_clock::now() + timeout;
  while (true) {
    const bool was_running = is_running();  // before its output is read for the last time
    std::istringstream lines(core::read_file(log_).value_or(""));
    for (std::string line; std::getline(lines, line);)
      if (line.starts_with(begin) && !lines.eof()) return line.substr(begin.size());
    if (!was_running) return core::fail(explain("has ended"));
    if (std::chrono::steady_clock::now() > until) return core::fail(explain("does not start"));
    if (!sleep_unless_interrupted(kLookPause)) return core::fail(core::ErrorCode::kCancelled, "interrupted");
  }
}

core::Error ChildProcess::explain(const std::string& what) const {
  std::string output = core::read_file(log_).value_or("");
  if (output.size() > kShownBytes) output = "..." + output.substr(output.size() - kShownBytes);
  while (output.ends_with('\n')) output.pop_back();
  return {core::ErrorCode::kUnavailable,
          fmt::format("{} {}:\n{}", std::filesystem::path(program_).filename().string(), what, output)};
}

}  // namespace tessera::client
