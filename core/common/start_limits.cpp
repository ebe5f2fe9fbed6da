// SPDX-License-Identifier: Apache-2.0
#include "core/common/start_limits.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include "core/base/thread_check.hpp"

namespace tessera::common {

core::Status check_start_limits(std::string_view what, int threads) {
  constexpr rlim_t kMinAddressBytes = rlim_t{1} << 30;
  rlimit limit{};
  if (getrlimit(RLIMIT_AS, &limit) == 0 && limit.rlim_cur < kMinAddressBytes)
    return core::fail(
        core::ErrorCode::kResourceExhausted,
        fmt::format("this process may use {} MiB of addresses, and {} needs {}: raise the limit "
                    "(ulimit -v, LimitAS= of systemd)",
                    limit.rlim_cur >> 20, what, kMinAddressBytes >> 20));
  if (const core::Status started = core::check_threads(threads); !started)
    return core::fail(
        core::ErrorCode::kResourceExhausted,
        fmt::format("{} needs {} threads, and this process cannot start as many: raise the limit "
                    "on threads (ulimit -u, TasksMax= of systemd, the pids of a container) or on "
                    "memory (ulimit -v)",
                    what, threads));
  return {};
}

}  // namespace tessera::common
