// SPDX-License-Identifier: Apache-2.0
// How long finished jobs are kept.
#pragma once

#include <chrono>
#include <cstdint>
#include <optional>
#include <string>

#include "core/base/error.hpp"

namespace tessera::jobs {

// At most one of the two; for ever without both.
struct KeepFinished {
  std::optional<std::chrono::seconds> time;  // after they finished
  std::optional<std::uint64_t> jobs;         // those that finished last
};

// Reads a number of jobs, such as "5000", or a time, such as "90m", "12h" or "30d". INVALID_ARGUMENT for
// other texts.
core::Result<KeepFinished> read_keep_finished(const std::string& text);

}  // namespace tessera::jobs
