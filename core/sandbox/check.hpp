// SPDX-License-Identifier: Apache-2.0
// Finds out what is missing of the sandbox on this machine, before the first file of a stranger is read.
#pragma once

#include <functional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::sandbox {

// Starts the program at `path`, which confines itself and tells what is missing, and waits for it. Each
// missing part goes to `warn` as one line. If the sandbox must be complete, it is an error:
// FAILED_PRECONDITION.
core::Status check_sandbox(const std::string& path, bool must_be_complete,
                           const std::function<void(const std::string& line)>& warn);

}  // namespace tessera::sandbox
