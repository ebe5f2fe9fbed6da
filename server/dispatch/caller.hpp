// SPDX-License-Identifier: Apache-2.0
// Who calls as a worker. Pure functions.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "server/scheduler/events.hpp"

namespace tessera::dispatch {

// Whether it has the form of a worker's id: 32 lower-case hexadecimal digits.
bool is_worker_id(const std::string& text);

// PERMISSION_DENIED if the worker is registered by another principal. `known`: null if it is not registered.
core::Status expect_own(const scheduler::WorkerInfo* known, const std::string& principal);

}  // namespace tessera::dispatch
