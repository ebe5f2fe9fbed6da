// SPDX-License-Identifier: Apache-2.0
// Checks of texts that are shown to others: names of workers, jobs and files. Programs check them early, with
// a clear error; a farm refuses invalid ones. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::proto {

inline constexpr std::size_t kMaxNameBytes = 200;
inline constexpr std::size_t kMaxPathBytes = 4096;

// INVALID_ARGUMENT with "FIELD: PROBLEM" as its message, and the field in its details.
core::Error invalid_field(std::string_view field, std::string_view problem);

// INVALID_ARGUMENT if the text is too long or has characters that cannot be shown in a line
// (core/base/printable.hpp). `what` says in the error what the text names; it is also the field of the
// request in the error's details.
core::Status check_text(std::string_view what, std::string_view text, std::size_t most_bytes = kMaxNameBytes);

}  // namespace tessera::proto
