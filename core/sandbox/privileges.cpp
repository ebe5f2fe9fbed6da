// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/privileges.hpp"

#include <fmt/format.h>
#include <grp.h>
#include <linux/capability.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <array>

namespace tessera::sandbox {

namespace {

constexpr const char* kUserPart = "user of its own: it stays root, without capabilities";
constexpr uid_t kNobody = 65534;
constexpr gid_t kNoGroup = 65534;

__user_cap_header_struct capability_header() {
  __user_cap_header_struct header{};
  header.version = _LINUX_CAPABILITY_VERSION_3;
  return header;
}

using CapabilitySets = std::array<__user_cap_data_struct, _LINUX_CAPABILITY_U32S_3>;

bool has_capability(unsigned number) {
  auto header = capability_header();
  CapabilitySets sets{};
  return syscall(SYS_capget, &header, sets.data()) == 0 &&
         (sets[CAP_TO_INDEX(number)].effective & CAP_TO_MASK(number)) != 0;
}

}  // namespace

core::Result<Missing> become_nobody() {
  if (geteuid() != 0) return Missing();
  // The parent has the same capabilities. Without this one it could not kill the process.
  if (!has_capability(CAP_KILL)) return Missing(fmt::format("no {} (there is no CAP_KILL)", kUserPart));
  if (setgroups(0, nullptr) != 0) return missing_or_error(kUserPart, "setgroups");
  if (setresgid(kNoGroup, kNoGroup, kNoGroup) != 0) return missing_or_error(kUserPart, "setresgid");
  if (setresuid(kNobody, kNobody, kNobody) != 0) return missing_or_error(kUserPart, "setresuid");
  return Missing();
}

core::Status drop_capabilities() {
  auto header = capability_header();
  const CapabilitySets none{};
  if (syscall(SYS_capset, &header, none.data()) == 0) return {};
  return core::fail(system_error("capset"));
}

}  // namespace tessera::sandbox
