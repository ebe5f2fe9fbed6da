// SPDX-License-Identifier: Apache-2.0
// The version that every program prints: that of the release, and of a build from a checkout what `git describe` says of it.
#pragma once

#include <string_view>

namespace tessera::core {

// "0.2.0", "0.2.0-14-gc88247d1" or "0.2.0-gc88247d1-dirty".
std::string_view version();

}  // namespace tessera::core
