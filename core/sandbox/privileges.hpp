// SPDX-License-Identifier: Apache-2.0
// Gives up the rights of root.
#pragma once

#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

// Makes a process of root one of the user and group 65534 ("nobody"), with no other groups. Other users'
// processes stay as they are. It resets what prctl(2) sets for signals and dumps.
core::Result<Missing> become_nobody();

// Gives up all capabilities for good, whoever the user is.
core::Status drop_capabilities();

}  // namespace tessera::sandbox
