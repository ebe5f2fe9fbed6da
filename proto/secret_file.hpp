// SPDX-License-Identifier: Apache-2.0
// Files with private keys and tokens.
#pragma once

#include <optional>
#include <string>

namespace tessera::proto {

// What to warn of where every user of this machine can read or write the file, and how to mend it. Nothing
// for an empty path, and for files that cannot be looked at: whoever reads them says why.
std::optional<std::string> exposure_of(const std::string& path);

}  // namespace tessera::proto
