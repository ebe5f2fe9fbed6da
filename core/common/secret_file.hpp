// SPDX-License-Identifier: Apache-2.0
// Files with private keys and tokens.
#pragma once

#include <optional>
#include <string>

namespace tessera::common {

// A warning if other users of this machine can read or write the file, with what to do about it. Empty for an
// empty path, and for files that cannot be examined: the reader reports these.
std::optional<std::string> exposure_of(const std::string& path);

}  // namespace tessera::common
