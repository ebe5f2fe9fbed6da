// SPDX-License-Identifier: Apache-2.0
// Calls with encoded messages, for services whose generated code is not linked. Blocks.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::test {

// Sends one message to a method ("/package.Service/Method") and returns the first answer.
core::Result<std::string> raw_call(const std::string& address, const std::string& method,
                                   const std::string& message);

}  // namespace tessera::test
