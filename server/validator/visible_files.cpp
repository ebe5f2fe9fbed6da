// SPDX-License-Identifier: Apache-2.0
#include "server/validator/visible_files.hpp"

#include <fcntl.h>
#include <fmt/format.h>
#include <linux/landlock.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

#include "server/validator/system_calls.hpp"

namespace tessera::validator {

namespace {

// All rights of the first version: rights that are handled and not granted are refused.
constexpr std::uint64_t kAllRights = (LANDLOCK_ACCESS_FS_MAKE_SYM << 1) - 1;

// The reader reports a missing file.
core::Status show(int rules, const std::string& path) {
  const int file = open(path.c_str(), O_PATH | O_CLOEXEC);
  if (file < 0) return {};
  landlock_path_beneath_attr rule{};
  rule.allowed_access = LANDLOCK_ACCESS_FS_READ_FILE;
  rule.parent_fd = file;
  const long added = syscall(SYS_landlock_add_rule, rules, LANDLOCK_RULE_PATH_BENEATH, &rule, 0);
  const core::Status shown = added == 0 ? core::Status() : core::fail(system_error("landlock_add_rule"));
  close(file);
  return shown;
}

}  // namespace

core::Status see_only(const std::vector<std::string>& paths) {
  landlock_ruleset_attr handled{};
  handled.handled_access_fs = kAllRights;
  const int rules = static_cast<int>(syscall(SYS_landlock_create_ruleset, &handled, sizeof handled, 0));
  if (rules < 0 && (errno == ENOSYS || errno == EOPNOTSUPP)) return {};
  if (rules < 0) return core::fail(system_error("landlock_create_ruleset"));
  core::Status seen;
  for (const std::string& path : paths)
    if (seen) seen = show(rules, path);
  if (seen && syscall(SYS_landlock_restrict_self, rules, 0) != 0)
    seen = core::fail(system_error("landlock_restrict_self"));
  close(rules);
  return seen;
}

}  // namespace tessera::validator
