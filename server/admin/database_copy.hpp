// SPDX-License-Identifier: Apache-2.0
// A database that is made beside the place that it is to take. Thread-safe: there is no shared state.
#pragma once

#include <filesystem>

#include "core/base/error.hpp"

namespace tessera::admin {

// Removes a database with SQLite's files beside it, as far as they exist.
void remove_database(const std::filesystem::path& file);

// INTERNAL if a database that was closed has left something in its log, so that its file alone is not all of
// it.
core::Status expect_empty_log(const std::filesystem::path& database);

}  // namespace tessera::admin
