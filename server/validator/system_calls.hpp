// SPDX-License-Identifier: Apache-2.0
// What a process that only reads files and computes has no need to ask the kernel for.
#pragma once

#include "core/base/error.hpp"

namespace tessera::validator {

// From now on this process cannot start others or other programs, speak to other processes or the network,
// nor open, make, rename or remove files but to read them: such calls fail with EPERM. Nothing happens on a
// kernel without filters of system calls (seccomp(2)).
core::Status forbid_system_calls();

// What errno says of a call that has failed: INTERNAL.
core::Error system_error(const char* call);

}  // namespace tessera::validator
