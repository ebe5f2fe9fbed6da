// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/lifecycle.hpp"

#include <fmt/format.h>

#include <cstdio>
#include <cstdlib>

namespace tessera::scheduler {

void invalid_transition(std::string_view what, std::string_view from, std::string_view to) {
  fmt::print(stderr, "a defect, please report it with this line: a {} went from {} to {}\n", what, from, to);
  std::abort();
}

}  // namespace tessera::scheduler
