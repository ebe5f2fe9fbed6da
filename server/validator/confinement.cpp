// SPDX-License-Identifier: Apache-2.0
#include "server/validator/confinement.hpp"

#include <fmt/format.h>
#include <signal.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

#include "server/validator/system_calls.hpp"

namespace tessera::validator {

namespace {

constexpr std::uint64_t kResponseBytes = 1 << 20;
// Standard input, output and error, and one file of the scene at a time.
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
  if (set) set = set_limit(RLIMIT_FSIZE, "RLIMIT_FSIZE", kResponseBytes);
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
  return core::fail(core::ErrorCode::kUnavailable, "the coordinator has ended");
}

}  // namespace

core::Status confine(const Confinement& confinement) {
  closefrom(STDERR_FILENO + 1);
  if (const core::Status tied = end_with(confinement.parent); !tied) return tied;
  if (prctl(PR_SET_NO_NEW_PRIVS, 1, 0, 0, 0) != 0) return core::fail(system_error("PR_SET_NO_NEW_PRIVS"));
  if (const core::Status limited = limit_resources(confinement); !limited) return limited;
  if (kIsSanitized) return {};
  if (prctl(PR_SET_DUMPABLE, 0) != 0) return core::fail(system_error("PR_SET_DUMPABLE"));
  return forbid_system_calls();
}

}  // namespace tessera::validator
