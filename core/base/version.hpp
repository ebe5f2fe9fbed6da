// SPDX-License-Identifier: Apache-2.0
// The version that every program prints: the release, or for a build from a checkout the output of `git
// describe`.
#pragma once

#include <string_view>

namespace tessera::core {

// "0.2.0", "0.2.0-14-gc88247d1" or "0.2.0-gc88247d1-dirty".
std::string_view version();

}  // namespace tessera::core
