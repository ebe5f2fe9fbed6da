// SPDX-License-Identifier: Apache-2.0
// What of a coordinator's state folder is whole, and the making of a new database from that. Both for a
// folder on which no coordinator runs.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/store/job_store.hpp"

namespace tessera::coordinator {

struct JobFindings {
  std::string id, name, state;
  std::uint64_t samples_done = 0, samples_total = 0;  // of the tiles that are whole
  std::vector<std::string> damage;                    // a sentence each; what to do included
};

struct StateFindings {
  std::vector<std::string> damage;  // of what is not one job's
  std::vector<std::string> notes;   // what will be cleared away, or taken in, at the next start
  std::vector<JobFindings> jobs;    // oldest first
  std::size_t blobs = 0;

  bool whole() const;
};

// Reads everything and changes nothing. Errors: those of store::lock_existing_state(). All else is a finding.
core::Result<StateFindings> check_state(const std::filesystem::path& folder);

// For people to read: a line for each job, and more where something is damaged.
std::string to_text(const StateFindings& findings);

struct Salvage {
  std::size_t jobs = 0, lost_jobs = 0;
  // Of the jobs that were kept. What is lost of a cancelled or failed one is not rendered again.
  std::size_t tiles = 0, lost_tiles = 0, tiles_lost_for_good = 0;
  std::filesystem::path set_aside;  // the old database
};

// Puts a new database in the place of the old one, with every job and tile of it that can be read and is
// whole; lost tiles are rendered again, but for those of cancelled and failed jobs. The old one is kept
// beside it under another name. DATA_LOSS if not even the list of jobs can be read. After an error the old
// one is where it was.
core::Result<Salvage> salvage_state(const std::filesystem::path& folder);

}  // namespace tessera::coordinator
