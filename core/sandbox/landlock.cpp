// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/landlock.hpp"

#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstdint>

#include "core/base/open_file.hpp"

namespace tessera::sandbox {

namespace {

constexpr const char* kPart = "Landlock: it takes Linux 5.13 with this module";

// The number of rights over files in each version of the interface, from version 1 on. Rights that are
// handled and not granted are refused.
constexpr std::array kRightCounts{13, 14, 15, 15, 16};

std::uint64_t all_rights(long version) {
  const long latest = std::min(version, static_cast<long>(kRightCounts.size()));
  return (std::uint64_t{1} << kRightCounts[static_cast<std::size_t>(latest - 1)]) - 1;
}

}  // namespace

core::Result<Missing> deny_files() {
  const long version = syscall(SYS_landlock_create_ruleset, nullptr, 0, LANDLOCK_CREATE_RULESET_VERSION);
  if (version < 1) return missing_or_error(kPart, "landlock_create_ruleset");
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = all_rights(version);
  const core::OpenFile rules(
      static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0)));
  if (!rules.valid()) return missing_or_error(kPart, "landlock_create_ruleset");
  if (syscall(SYS_landlock_restrict_self, rules.get(), 0) != 0)
    return missing_or_error(kPart, "landlock_restrict_self");
  return Missing();
}

}  // namespace tessera::sandbox
