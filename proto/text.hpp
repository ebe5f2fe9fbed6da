// SPDX-License-Identifier: Apache-2.0
// Texts that others are shown: names of workers, jobs and files. Who chooses one is told at once what is
// wrong with it; a farm takes no other. Stateless; thread-safe.
#pragma once

#include <cstddef>
#include <string_view>

#include "core/base/error.hpp"

namespace tessera::proto {

inline constexpr std::size_t kMaxNameBytes = 200;
inline constexpr std::size_t kMaxPathBytes = 4096;

// Whether it is short enough, and holds nothing but what can be shown in a line (core/base/printable.hpp).
// `what` says in the error what it is the name of.
core::Status check_text(std::string_view what, std::string_view text, std::size_t most_bytes = kMaxNameBytes);

}  // namespace tessera::proto
