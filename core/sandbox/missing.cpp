// SPDX-License-Identifier: Apache-2.0
#include "core/sandbox/missing.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <cstring>

namespace tessera::sandbox {

namespace {

// What calls fail with that a kernel does not know, or that a container or a module forbids.
constexpr std::array kUnsupported{ENOSYS, EOPNOTSUPP, EINVAL, EPERM, EACCES};

}  // namespace

core::Error system_error(std::string_view call) {
  return {core::ErrorCode::kInternal, fmt::format("{}: {}", call, std::strerror(errno))};
}

core::Result<Missing> missing_or_error(std::string_view part, std::string_view call) {
  const core::Error error = system_error(call);
  if (std::ranges::find(kUnsupported, errno) == kUnsupported.end()) return core::fail(error);
  return Missing(fmt::format("no {} ({})", part, error.message));
}

}  // namespace tessera::sandbox
