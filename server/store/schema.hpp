// SPDX-License-Identifier: Apache-2.0
// The schema of the state file as a list of migrations. A change of a table adds a step; the missing steps
// are applied when the file of an earlier release is opened. For one thread at a time.
#pragma once

#include <cstdint>
#include <filesystem>

#include "server/store/sqlite.hpp"

namespace tessera::store {

// The version that this release reads and writes. It is stored in user_version, which is 0 in a new file.
int schema_version();

// FAILED_PRECONDITION if a later release wrote the file, or if it is no state file; DATA_LOSS if it is empty
// and must not be new. Changes nothing.
core::Status expect_usable(Database& database, const std::filesystem::path& file, bool may_be_new);

// Applies all missing steps, or none.
core::Status bring_up_to_date(Database& database);

// The version of a file that is opened for reading only. FAILED_PRECONDITION if a later release wrote it;
// DATA_LOSS if it is empty. Changes nothing.
core::Result<int> expect_readable(Database& database, const std::filesystem::path& file);

// The versions that introduced checksums of jobs, limits on workers, jobs that are being validated, settled
// jobs, and tiles with targets of their own.
inline constexpr int kVersionOfJobSums = 2, kVersionOfWorkerLimits = 3, kVersionOfValidation = 6,
                     kVersionOfSettledJobs = 7, kVersionOfTileTargets = 8;

// The error for a state file that is missing but must exist.
core::Error lost(const std::filesystem::path& file);

}  // namespace tessera::store
