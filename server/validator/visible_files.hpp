// SPDX-License-Identifier: Apache-2.0
// The files that a validator may open: those of its request, and no others of the machine's.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"

namespace tessera::validator {

// From now on this process can open these files, for reading, and nothing else: no key, no database, nothing
// below /proc. Nothing happens on a kernel without Landlock (landlock(7)). INTERNAL for what should have
// worked.
core::Status see_only(const std::vector<std::string>& paths);

}  // namespace tessera::validator
