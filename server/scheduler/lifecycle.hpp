// SPDX-License-Identifier: Apache-2.0
// What the lifecycles of jobs, workers and leases have in common: each is an enum with its arrows drawn above
// it, and one function that takes an arrow. One that is not drawn is a defect, and ends the process, in every
// build.
#pragma once

#include <string_view>

namespace tessera::scheduler {

// Says which arrow it was, for whoever reports the defect. `what`: "job", "worker" or "lease".
[[noreturn]] void invalid_transition(std::string_view what, std::string_view from, std::string_view to);

}  // namespace tessera::scheduler
