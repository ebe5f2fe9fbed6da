// SPDX-License-Identifier: Apache-2.0
// The tables of the state file, as the steps by which they came to be. Whoever changes a table adds a step: a
// file of an earlier release is brought up to date by those that it lacks, when it is opened.
// For one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>

#include "server/store/sqlite.hpp"

namespace tessera::store {

// The version that this release reads and writes; a file's stands in its user_version, 0 in a new file.
int schema_version();

// FAILED_PRECONDITION if the file was written by a later release or is no state file at all; DATA_LOSS if it
// is empty and must not be, since what belongs to it is there. Changes nothing.
core::Status expect_usable(Database& database, const std::filesystem::path& file, bool may_be_new);

// Takes all steps that a usable file lacks, or none.
core::Status bring_up_to_date(Database& database);

// The version of a file that is only to be looked at. FAILED_PRECONDITION if it is of a later release;
// DATA_LOSS if it is empty. Changes nothing.
core::Result<int> expect_readable(Database& database, const std::filesystem::path& file);

// From these versions on jobs have a sum, and a limit of workers.
inline constexpr int kVersionOfJobSums = 2, kVersionOfWorkerLimits = 3;

// What to tell of a state file that should be there.
core::Error lost(const std::filesystem::path& file);

}  // namespace tessera::store
