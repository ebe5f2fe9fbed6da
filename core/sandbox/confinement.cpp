// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/confinement.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>

#include "core/sandbox/file_channel.hpp"
#include "core/sandbox/landlock.hpp"
#include "core/sandbox/missing.hpp"
#include "core/sandbox/privileges.hpp"
#include "core/sandbox/system_calls.hpp"

namespace tessera::sandbox {

namespace {

// The standard streams, the file channel, and one file of the scene at a time.
constexpr std::uint64_t kMaxFiles = 16;

// Sets the limit, or keeps a lower hard limit.
core::Status set_limit(__rlimit_resource resource, const char* name, std::uint64_t value,
                       std::uint64_t leeway = 0) {
  rlimit limit{value, value + leeway};
  if (rlimit inherited{}; getrlimit(resource, &inherited) == 0)
    limit = {std::min(limit.rlim_cur, inherited.rlim_max), std::min(limit.rlim_max, inherited.rlim_max)};
  if (setrlimit(resource, &limit) == 0) return {};
  return core::fail(system_error(name));
}

core::Status limit_resources(const Confinement& confinement) {
  // The second limit is one second later, so that SIGXCPU ends the process and tells the reason.
  core::Status set = set_limit(RLIMIT_CPU, "RLIMIT_CPU", confinement.cpu_seconds, 1);
  if (set) set = set_limit(RLIMIT_CORE, "RLIMIT_CORE", 0);
  if (set) set = set_limit(RLIMIT_FSIZE, "RLIMIT_FSIZE", confinement.output_bytes);
  if (set) set = set_limit(RLIMIT_NOFILE, "RLIMIT_NOFILE", kMaxFiles);
  if (!set || kIsSanitized) return set;
  set = set_limit(RLIMIT_AS, "RLIMIT_AS", confinement.memory_mib << 20);
  if (set) set = set_limit(RLIMIT_NPROC, "RLIMIT_NPROC", 0);
  return set;
}

core::Status end_with(pid_t parent) {
  if (parent == 0) return {};
  if (prctl(PR_SET_PDEATHSIG, SIGKILL) != 0) return core::fail(system_error("PR_SET_PDEATHSIG"));
  if (getppid() == parent) return {};
  return core::fail(core::ErrorCode::kUnavailable, "the process that started this one has ended");
}

core::Status gain_nothing() {
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return core::fail(system_error("PR_SET_NO_NEW_PRIVS"));
  if (!kIsSanitized && prctl(PR_SET_DUMPABLE, 0) != 0) return core::fail(system_error("PR_SET_DUMPABLE"));
  return drop_capabilities();
}

core::Result<Missing> filter_system_calls() {
  if (kIsSanitized) return Missing("no system call filter (this build has sanitizers)");
  return allow_few_system_calls();
}

// Takes the steps in this order. A change of the user resets what later steps set.
core::Status take_steps(const Confinement& confinement, std::vector<std::string>& missing) {
  const auto note = [&missing](const core::Result<Missing>& step) -> core::Status {
    if (!step) return core::fail(step.error());
    if (*step) missing.push_back(**step);
    return {};
  };
  core::Status done = note(become_nobody());
  if (done) done = end_with(confinement.parent);
  if (done) done = gain_nothing();
  if (done) done = limit_resources(confinement);
  if (done) done = note(deny_files());
  if (done) done = note(filter_system_calls());
  return done;
}

}  // namespace

core::Result<std::vector<std::string>> confine(const Confinement& confinement) {
  closefrom(kFileChannel + 1);
  std::vector<std::string> missing;
  if (const core::Status taken = take_steps(confinement, missing); !taken) return core::fail(taken.error());
  if (confinement.complete && !missing.empty())
    return core::fail(core::ErrorCode::kFailedPrecondition,
                      fmt::format("the sandbox is incomplete: {}", fmt::join(missing, "; ")));
  return missing;
}

}  // namespace tessera::sandbox
