// SPDX-License-Identifier: Apache-2.0
// Calls of services whose messages are not at hand, as bytes. Blocks.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::test {

// Sends one message to a method ("/package.Service/Method") and answers with the first that comes back.
core::Result<std::string> raw_call(const std::string& address, const std::string& method,
                                   const std::string& message);

}  // namespace tessera::test
