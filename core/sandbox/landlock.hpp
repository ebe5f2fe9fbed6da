// SPDX-License-Identifier: Apache-2.0
// Takes all files away from a process, but for those that it has open.
#pragma once

#include "core/sandbox/missing.hpp"

namespace tessera::sandbox {

// From now on this process can open, create, change and remove no file, and start no program (landlock(7)).
// Descriptors that it has, or is sent, stay as they are. The process must not be able to gain privileges.
core::Result<Missing> deny_files();

}  // namespace tessera::sandbox
