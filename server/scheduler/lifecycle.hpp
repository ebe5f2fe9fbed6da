// SPDX-License-Identifier: Apache-2.0
// Common to the lifecycles of jobs, workers and leases: each is an enum with a diagram of its transitions and
// one function that makes them. An invalid transition is a defect, and ends the process in every build.
#pragma once

#include <string_view>

namespace tessera::scheduler {

// Reports the transition and ends the process. `what`: "job", "worker" or "lease".
[[noreturn]] void invalid_transition(std::string_view what, std::string_view from, std::string_view to);

}  // namespace tessera::scheduler
