// SPDX-License-Identifier: Apache-2.0
// Helpers for the loader's messages. Stateless; thread-safe.
#pragma once

#include <string>

#include "core/base/error.hpp"
#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"

namespace tessera::core {

// An INVALID_ARGUMENT error for invalid content of a file.
tl::unexpected<Error> mistake(std::string message);

}  // namespace tessera::core
