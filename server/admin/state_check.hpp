// SPDX-License-Identifier: Apache-2.0
// Checks which parts of a coordinator's state directory are intact, and makes a new database from these. Both
// need a directory on which no coordinator runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/store/job_store.hpp"

namespace tessera::admin {

struct JobFindings {
  std::string id, name, state;
  std::uint64_t samples_done = 0, samples_total = 0;  // of intact tiles
  std::vector<std::string> damage;                    // one sentence each, with what to do
};

struct StateFindings {
  std::vector<std::string> damage;  // that concerns no single job
  std::vector<std::string> notes;   // what the next start will clean up or recover
  std::vector<JobFindings> jobs;    // oldest first
  std::set<std::string> files;      // of these jobs: each SHA-256 in hexadecimal digits
  std::size_t blobs = 0;

  bool whole() const;
};

// Reads everything and changes nothing. Errors are those of store::lock_existing_state(); everything else is
// a finding. The folder can be a backup, too.
core::Result<StateFindings> check_state(const std::filesystem::path& folder);

// The result of checking each blob, by its SHA-256 in hexadecimal digits.
using BlobStates = std::map<std::string, core::Status>;
// The same of a database that nobody writes to, given the results for the files of its jobs.
StateFindings check_database(const std::filesystem::path& database, const BlobStates& blobs);

// A report for people: one line for each job, and more where something is damaged.
std::string to_text(const StateFindings& findings);

struct Salvage {
  std::size_t jobs = 0, lost_jobs = 0;
  // The tiles of the jobs that were kept. Lost tiles of cancelled and failed jobs are not rendered again.
  std::size_t tiles = 0, lost_tiles = 0, tiles_lost_for_good = 0;
  std::filesystem::path set_aside;  // the old database
};

// Replaces the database by a new one with every job and tile that can be read and is intact. Lost tiles are
// rendered again, except for those of cancelled and failed jobs. The old database is kept beside it under
// another name. DATA_LOSS if the list of jobs cannot be read at all. After an error the old database is in
// its place.
core::Result<Salvage> salvage_state(const std::filesystem::path& folder);

}  // namespace tessera::admin
