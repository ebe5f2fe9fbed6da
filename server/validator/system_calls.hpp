// SPDX-License-Identifier: Apache-2.0
// A filter of the system calls that a process needs which only reads files and computes.
#pragma once

#include "core/base/error.hpp"

namespace tessera::validator {

// From now on this process cannot start processes or programs, communicate with processes or the network, or
// write, create, rename or remove files: such calls fail with EPERM. Does nothing on a kernel without system
// call filters (seccomp(2)).
core::Status forbid_system_calls();

// The error for a failed call, from errno: INTERNAL.
core::Error system_error(const char* call);

}  // namespace tessera::validator
