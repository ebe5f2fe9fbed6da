// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/process.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/wait.h>
#include <unistd.h>

#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <system_error>
#include <utility>

extern "C" {  // missing from the header of glibc 2.36
#include <sys/pidfd.h>
}

#include "core/base/printable.hpp"
#include "core/sandbox/confinement.hpp"
#include "core/sandbox/flags.hpp"
#include "core/sandbox/memory_file.hpp"
#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

using core::ErrorCode;
using core::OpenFile;

namespace {

constexpr std::chrono::milliseconds kLookAround{50};

// How a process is started: its descriptors, no signal blocked, and ended by what exceeds its limit of
// output.
class SpawnSetup {
 public:
  SpawnSetup(const Streams& streams, const OpenFile& err, const OpenFile& channel) {
    posix_spawn_file_actions_init(&actions_);
    posix_spawn_file_actions_adddup2(&actions_, streams.in.get(), STDIN_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, streams.out.get(), STDOUT_FILENO);
    // A process that was taken over must not write to the log. Reports of sanitizers must.
    if (!kIsSanitized) posix_spawn_file_actions_adddup2(&actions_, err.get(), STDERR_FILENO);
    posix_spawn_file_actions_adddup2(&actions_, channel.get(), kFileChannel);
    posix_spawn_file_actions_addclosefrom_np(&actions_, kFileChannel + 1);
    // Coordinators and workers block the signals that they wait for; their children must not.
    sigset_t none;
    sigemptyset(&none);
    posix_spawnattr_init(&attributes_);
    posix_spawnattr_setsigmask(&attributes_, &none);
    sigset_t of_limits;
    sigemptyset(&of_limits);
    sigaddset(&of_limits, SIGXFSZ);  // which coordinators and workers ignore
    posix_spawnattr_setsigdefault(&attributes_, &of_limits);
    posix_spawnattr_setflags(&attributes_, POSIX_SPAWN_SETSIGMASK | POSIX_SPAWN_SETSIGDEF);
  }
  ~SpawnSetup() {
    posix_spawnattr_destroy(&attributes_);
    posix_spawn_file_actions_destroy(&actions_);
  }
  SpawnSetup(const SpawnSetup&) = delete;
  SpawnSetup& operator=(const SpawnSetup&) = delete;

  // The error number of posix_spawn().
  int spawn(const Program& program, pid_t& pid) const {
    std::vector<std::string> words{program.path};
    words.insert(words.end(), program.arguments.begin(), program.arguments.end());
    words.insert(words.end(), {kParentFlag, std::to_string(getpid())});
    std::vector<char*> arguments;
    for (std::string& word : words) arguments.push_back(word.data());
    arguments.push_back(nullptr);
    // One thread: the memory limit counts address space, of which every OpenMP thread takes much.
    std::array<char, 18> threads{"OMP_NUM_THREADS=1"};
    const std::array<char*, 2> environment{threads.data(), nullptr};
    return posix_spawn(&pid, program.path.c_str(), &actions_, &attributes_, arguments.data(),
                       environment.data());
  }

 private:
  posix_spawn_file_actions_t actions_;
  posix_spawnattr_t attributes_;
};

// Sends files until the process has ended, the timeout or a stop request.
Ending::Cause serve(const OpenFile& process, const OpenFile& channel, const Program& program,
                    const OpenNumbered& open_file) {
  const auto deadline = std::chrono::steady_clock::now() + program.timeout;
  std::array<pollfd, 2> events{pollfd{process.get(), POLLIN, 0}, pollfd{channel.get(), POLLIN, 0}};
  while (!program.stop.stop_requested()) {
    if (std::chrono::steady_clock::now() >= deadline) return Ending::Cause::kTimeout;
    if (poll(events.data(), events.size(), static_cast<int>(kLookAround.count())) <= 0) continue;
    if (events[0].revents != 0) return Ending::Cause::kByItself;
    if (events[1].revents != 0 && !answer_request(channel, open_file)) events[1].fd = -1;
  }
  return Ending::Cause::kStopRequest;
}

// The start of the text, without the line break at its end.
std::string message_in(const OpenFile& file) {
  std::array<char, 1000> text{};
  const ssize_t size = pread(file.get(), text.data(), text.size(), 0);
  std::string_view message(text.data(), size < 0 ? 0 : static_cast<std::size_t>(size));
  if (message.ends_with('\n')) message.remove_suffix(1);
  return core::printable(message);
}

// A process that is killed where nobody waits for it, as after an exception.
class Child {
 public:
  explicit Child(pid_t pid) : pid_(pid) {}
  ~Child() {
    if (pid_ < 0) return;
    ::kill(pid_, SIGKILL);
    static_cast<void>(wait());
  }
  Child(const Child&) = delete;
  Child& operator=(const Child&) = delete;

  OpenFile handle() const { return OpenFile(pidfd_open(pid_, 0)); }
  void kill() const { ::kill(pid_, SIGKILL); }
  // Its status when it has ended. Call it once.
  core::Result<int> wait() {
    const pid_t pid = std::exchange(pid_, -1);
    int status = 0;
    while (waitpid(pid, &status, 0) < 0)
      if (errno != EINTR) return core::fail(system_error("waitpid"));
    return status;
  }

 private:
  pid_t pid_;
};

}  // namespace

bool Ending::succeeded() const {
  return cause == Cause::kByItself && WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

bool Ending::by_signal(int signal) const {
  return cause == Cause::kByItself && WIFSIGNALED(status) && WTERMSIG(status) == signal;
}

core::Result<Ending> run(const Program& program, const Streams& streams) {
  auto channel = FileChannel::create();
  if (!channel) return core::fail(channel.error());
  const auto err = create_memory_file("messages");
  if (!err) return core::fail(err.error());
  pid_t pid = 0;
  if (const int error = SpawnSetup(streams, *err, channel->child).spawn(program, pid); error != 0)
    return core::fail(ErrorCode::kInternal,
                      fmt::format("starting {}: {}", program.path, std::strerror(error)));
  channel->child = OpenFile();
  Child child(pid);
  const OpenFile handle = child.handle();
  if (!handle.valid()) return core::fail(system_error("pidfd_open"));
  Ending ending;
  ending.cause = serve(handle, channel->parent, program, streams.open_file);
  if (ending.cause != Ending::Cause::kByItself) child.kill();
  const auto status = child.wait();
  if (!status) return core::fail(status.error());
  ending.status = *status;
  ending.message = message_in(*err);
  return ending;
}

std::string describe(const Ending& ending, const std::string& name) {
  const int status = ending.status;
  const std::string message = ending.message.empty() ? "" : ": " + ending.message;
  if (!WIFSIGNALED(status))
    return fmt::format("{} ended with status {}{}", name, WEXITSTATUS(status), message);
  const int signal = WTERMSIG(status);
  const char* const hint = signal == SIGKILL  ? ", perhaps for want of memory"
                           : signal == SIGSYS ? ": the sandbox forbids it"
                                              : "";
  return fmt::format("{} ended by signal {} ({}{}){}", name, signal, strsignal(signal), hint, message);
}

std::string path_beside_this(const std::string& name) {
  std::error_code ignored;  // on failure, check_program() reports that the path does not exist
  return (std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / name).string();
}

core::Status check_program(const std::string& path, const std::string& name, const std::string& option) {
  std::error_code unknown;  // the path may be inaccessible
  const bool is_file = std::filesystem::is_regular_file(path, unknown);
  if (is_file && access(path.c_str(), X_OK) == 0) return {};
  const bool missing = !unknown || unknown == std::errc::no_such_file_or_directory;
  const std::string why = is_file   ? "cannot be executed"
                          : missing ? "there is no such program"
                                    : unknown.message();
  return core::fail(ErrorCode::kFailedPrecondition,
                    fmt::format("{}: {}: install {} there, or name it with {}", path, why, name, option));
}

}  // namespace tessera::sandbox
