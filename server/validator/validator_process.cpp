// SPDX-License-Identifier: Apache-2.0
#include "server/validator/validator_process.hpp"

#include <fmt/format.h>
#include <poll.h>
#include <signal.h>
#include <spawn.h>
#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <optional>
#include <system_error>
#include <vector>

extern "C" {  // missing from the header of glibc 2.36
#include <sys/pidfd.h>
}

#include "core/base/printable.hpp"
#include "proto/blob.hpp"
#include "server/base/file.hpp"
#include "server/validator/flags.hpp"
#include "server/validator/validate.pb.h"

namespace tessera::validator {

using base::Fd;
using core::ErrorCode;

namespace {

core::Error system_error(std::string_view doing) {
  return {ErrorCode::kInternal, fmt::format("{}: {}", doing, std::strerror(errno))};
}

ValidateRequest make_request(const blobs::BlobStore& blobs, const v1::Bundle& bundle,
                             const v1::RenderOverrides& overrides) {
  ValidateRequest request;
  *request.mutable_bundle() = bundle;
  *request.mutable_overrides() = overrides;
  for (const v1::Bundle::Asset& asset : bundle.assets()) {
    const auto digest = proto::from_proto(asset.digest());
    if (digest)
      (*request.mutable_files())[asset.path()] = std::filesystem::absolute(blobs.path(*digest)).string();
  }
  return request;
}

// Standard input and output of the process are files in memory, so that neither side blocks on the other.
core::Result<base::Fd> memory_file(const char* name, const std::string& content) {
  base::Fd file(memfd_create(name, MFD_CLOEXEC));
  if (!file) return core::fail(system_error("memfd_create"));
  if (auto written = base::write_all(file, content, name); !written) return core::fail(written.error());
  if (lseek(file.get(), 0, SEEK_SET) != 0) return core::fail(system_error("lseek"));
  return file;
}

// CPU time in whole seconds. The timeout has the same length, for a process that waits for a disk.
std::chrono::seconds processor_time(const server::Limits& limits) {
  return std::chrono::ceil<std::chrono::seconds>(limits.validation_time);
}

std::vector<std::string> command_line(const ProcessOptions& options) {
  const server::Limits& limits = options.limits;
  return {options.path,
          kTrianglesFlag,
          std::to_string(limits.triangles),
          kLightsFlag,
          std::to_string(limits.lights),
          kTexturePixelsFlag,
          std::to_string(limits.texture_pixels),
          kSceneTexturePixelsFlag,
          std::to_string(limits.scene_texture_pixels),
          kMemoryFlag,
          std::to_string(limits.validator_mib),
          kSecondsFlag,
          std::to_string(processor_time(limits).count()),
          kParentFlag,
          std::to_string(getpid())};
}

core::Result<pid_t> spawn(const ProcessOptions& options, const base::Fd& in, const base::Fd& out) {
  posix_spawn_file_actions_t actions;
  posix_spawn_file_actions_init(&actions);
  posix_spawn_file_actions_adddup2(&actions, in.get(), STDIN_FILENO);
  posix_spawn_file_actions_adddup2(&actions, out.get(), STDOUT_FILENO);
  posix_spawn_file_actions_addclosefrom_np(&actions, STDERR_FILENO + 1);
  // The coordinator blocks the signals that it waits for; its child must not.
  posix_spawnattr_t attributes;
  posix_spawnattr_init(&attributes);
  sigset_t none;
  sigemptyset(&none);
  posix_spawnattr_setsigmask(&attributes, &none);
  posix_spawnattr_setflags(&attributes, POSIX_SPAWN_SETSIGMASK);

  std::vector<std::string> words = command_line(options);
  std::vector<char*> arguments;
  for (std::string& word : words) arguments.push_back(word.data());
  arguments.push_back(nullptr);
  // One thread: the memory limit counts address space, of which every OpenMP thread takes much.
  std::array<char, 18> threads{"OMP_NUM_THREADS=1"};
  const std::array<char*, 2> environment{threads.data(), nullptr};
  pid_t pid = 0;
  const int error =
      posix_spawn(&pid, options.path.c_str(), &actions, &attributes, arguments.data(), environment.data());
  posix_spawnattr_destroy(&attributes);
  posix_spawn_file_actions_destroy(&actions);
  if (error == 0) return pid;
  return core::fail(ErrorCode::kInternal,
                    fmt::format("starting {}: {}: install it there, or name it with --validator",
                                options.path, std::strerror(error)));
}

// Whether the process ended by itself before the timeout or a stop request.
bool ends_in_time(const base::Fd& process, const ProcessOptions& options) {
  constexpr std::chrono::milliseconds kLookAround{50};
  const auto deadline = std::chrono::steady_clock::now() + options.limits.validation_time;
  pollfd exit{process.get(), POLLIN, 0};
  while (!options.stop.stop_requested() && std::chrono::steady_clock::now() < deadline) {
    if (poll(&exit, 1, static_cast<int>(kLookAround.count())) == 1) return true;
  }
  return false;
}

// The wait status of the process; empty if it had to be killed.
core::Result<std::optional<int>> wait_for(pid_t pid, const ProcessOptions& options) {
  const base::Fd handle(pidfd_open(pid, 0));
  const bool ended = handle && ends_in_time(handle, options);
  if (!ended) kill(pid, SIGKILL);
  int status = 0;
  while (waitpid(pid, &status, 0) < 0) {
    if (errno != EINTR) return core::fail(system_error("waitpid"));
  }
  return ended ? std::optional(status) : std::nullopt;
}

core::Error stopping() {
  return {ErrorCode::kUnavailable, "the coordinator is stopping: try again"};
}

core::Result<std::string> read_all(const base::Fd& file) {
  std::string content;
  std::array<char, 65536> buffer{};
  if (lseek(file.get(), 0, SEEK_SET) != 0) return core::fail(system_error("lseek"));
  while (true) {
    const ssize_t got = read(file.get(), buffer.data(), buffer.size());
    if (got < 0 && errno == EINTR) continue;
    if (got < 0) return core::fail(system_error("reading the verdict"));
    if (got == 0) return content;
    content.append(buffer.data(), static_cast<std::size_t>(got));
  }
}

std::string describe_end(int status) {
  if (WIFSIGNALED(status)) {
    return fmt::format("the validator ended by signal {} ({}{})", WTERMSIG(status),
                       strsignal(WTERMSIG(status)),
                       WTERMSIG(status) == SIGKILL ? ", perhaps for want of memory" : "");
  }
  return fmt::format("the validator ended with status {}", WEXITSTATUS(status));
}

core::Error takes_too_long(const server::Limits& limits) {
  return {
      ErrorCode::kResourceExhausted,
      fmt::format("the scene could not be validated within {} s, which is all that this farm takes for one "
                  "(tessera-coordinator {})",
                  processor_time(limits).count(), kSecondsFlag)};
}

Approval bounded(const ValidateResponse::Approval& said) {
  Approval approval{said.settings(), said.display(), {}};
  for (int i = 0; i < std::min(said.warnings_size(), kMaxWarnings); ++i)
    approval.warnings.push_back(core::printable(said.warnings(i).substr(0, kMaxWarningBytes)));
  return approval;
}

core::Result<Approval> read_verdict(const base::Fd& out, int status, const server::Limits& limits) {
  if (WIFSIGNALED(status) && WTERMSIG(status) == SIGXCPU) return core::fail(takes_too_long(limits));
  const auto content = read_all(out);
  if (!content) return core::fail(content.error());
  ValidateResponse response;
  const bool answered = WIFEXITED(status) && WEXITSTATUS(status) == 0 && response.ParseFromString(*content);
  if (answered && response.has_approval()) return bounded(response.approval());
  if (answered && response.has_refusal()) {
    return core::fail(static_cast<ErrorCode>(response.refusal().code()), response.refusal().message());
  }
  return core::fail(
      ErrorCode::kInvalidArgument,
      fmt::format("the scene could not be validated: {}; render it with `tessera render` to see why",
                  describe_end(status)));
}

}  // namespace

std::string default_validator_path() {
  std::error_code ignored;  // on failure, check_validator() reports that the path does not exist
  return (std::filesystem::read_symlink("/proc/self/exe", ignored).parent_path() / "tessera-validator")
      .string();
}

core::Status check_validator(const std::string& path) {
  std::error_code unknown;  // the path may be inaccessible
  const bool is_file = std::filesystem::is_regular_file(path, unknown);
  if (is_file && access(path.c_str(), X_OK) == 0) return {};
  const bool missing = !unknown || unknown == std::errc::no_such_file_or_directory;
  const std::string why = is_file   ? "cannot be executed"
                          : missing ? "there is no such program"
                                    : unknown.message();
  return core::fail(
      ErrorCode::kFailedPrecondition,
      fmt::format("{}: {}: install tessera-validator there, or name it with --validator", path, why));
}

core::Result<Approval> validate_scene(const ProcessOptions& options, const blobs::BlobStore& blobs,
                                      const v1::Bundle& bundle, const v1::RenderOverrides& overrides) {
  if (options.stop.stop_requested()) return core::fail(stopping());
  const auto in = memory_file("request", make_request(blobs, bundle, overrides).SerializeAsString());
  if (!in) return core::fail(in.error());
  const auto out = memory_file("verdict", "");
  if (!out) return core::fail(out.error());
  const auto pid = spawn(options, *in, *out);
  if (!pid) return core::fail(pid.error());
  const auto status = wait_for(*pid, options);
  if (!status) return core::fail(status.error());
  if (*status) return read_verdict(*out, **status, options.limits);
  if (options.stop.stop_requested()) return core::fail(stopping());
  return core::fail(takes_too_long(options.limits));
}

}  // namespace tessera::validator
