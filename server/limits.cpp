// SPDX-License-Identifier: Apache-2.0
#include "server/limits.hpp"

#include <sys/resource.h>
#include <unistd.h>

#include <algorithm>
#include <fstream>
#include <limits>

namespace tessera::server {

namespace {

// The limit of the control group, if this process is in one of its own.
double cgroup_bytes() {
  std::ifstream file("/sys/fs/cgroup/memory.max");
  double bytes = 0;
  return file >> bytes ? bytes : std::numeric_limits<double>::infinity();
}

}  // namespace

double default_film_gib() {
  double bytes = static_cast<double>(sysconf(_SC_PHYS_PAGES)) * static_cast<double>(sysconf(_SC_PAGESIZE));
  rlimit addresses{};
  if (getrlimit(RLIMIT_AS, &addresses) == 0) bytes = std::min(bytes, static_cast<double>(addresses.rlim_cur));
  return std::min(bytes, cgroup_bytes()) / 2 / (1 << 30);
}

}  // namespace tessera::server
