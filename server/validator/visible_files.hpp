// SPDX-License-Identifier: Apache-2.0
// Restricts the files that a validator may open to those of its request.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::validator {

// From now on this process can open only these files, for reading: no key, no database, nothing below /proc.
// Does nothing on a kernel without Landlock (landlock(7)). INTERNAL if a supported call fails.
core::Status see_only(const std::vector<std::string>& paths);

}  // namespace tessera::validator
