#include "server/validator/limits.hpp"

#include <fmt/format.h>
#include <sys/resource.h>

#include <cerrno>
#include <cstring>

namespace tessera::validator {

namespace {

constexpr std::uint64_t kVerdictBytes = 1 << 20;

// AddressSanitizer itself maps terabytes.
#if defined(__SANITIZE_ADDRESS__)  // GCC
constexpr bool kLimitsAddresses = false;
#elif defined(__has_feature)  // Clang
constexpr bool kLimitsAddresses = !__has_feature(address_sanitizer);
#else
constexpr bool kLimitsAddresses = true;
#endif

core::Status set_limit(__rlimit_resource resource, const char* name, std::uint64_t value) {
  const rlimit limit{value, value};
  if (setrlimit(resource, &limit) == 0) return {};
  return core::fail(core::ErrorCode::kInternal, fmt::format("setrlimit {}: {}", name, std::strerror(errno)));
}

}  // namespace

core::Status apply_limits(const Limits& limits) {
  core::Status applied;
  if (kLimitsAddresses) applied = set_limit(RLIMIT_AS, "RLIMIT_AS", limits.memory_bytes);
  if (applied) applied = set_limit(RLIMIT_CPU, "RLIMIT_CPU", limits.cpu_seconds);
  if (applied) applied = set_limit(RLIMIT_CORE, "RLIMIT_CORE", 0);
  if (applied) applied = set_limit(RLIMIT_FSIZE, "RLIMIT_FSIZE", kVerdictBytes);
  return applied;
}

}  // namespace tessera::validator
