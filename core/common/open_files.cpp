// SPDX-License-Identifier: Apache-2.0
#include "core/common/open_files.hpp"

#include <sys/resource.h>

namespace tessera::common {

void raise_file_limit() {
  rlimit limit{};
  if (getrlimit(RLIMIT_NOFILE, &limit) != 0) return;
  limit.rlim_cur = limit.rlim_max;
  setrlimit(RLIMIT_NOFILE, &limit);
}

}  // namespace tessera::common
