// SPDX-License-Identifier: Apache-2.0
#include "server/limits.hpp"

#include <sys/resource.h>

#include <algorithm>

#include "core/base/available_resources.hpp"

namespace tessera::server {

double default_film_gib() {
  auto bytes = static_cast<double>(core::available_memory_bytes());
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) == 0) bytes = std::min(bytes, static_cast<double>(addresses.rlim_cur));
  return bytes / 2 / (1 << 30);
}

}  // namespace tessera::server
