// SPDX-License-Identifier: Apache-2.0
// Recovers the jobs of an earlier run of the coordinator that are not settled. Used once, before anybody is
// served.
#pragma once

#include <map>
#include <set>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"

namespace tessera::jobs {

// The samples that are done, by tile; those that the job cannot have are left out.
std::vector<scheduler::IntervalSet> done_sets(const scheduler::JobShape& shape,
                                              const std::map<int, std::vector<core::SampleRange>>& done);

class Restoration {
 public:
  Restoration(farm::Farm& farm, store::StateDirectory& state, blobs::SceneFiles& files,
              const FilmReader& films, const server::Limits& limits)
      : farm_(farm),
        state_(state),
        files_(files),
        films_(films),
        limits_(limits),
        fingerprints_(farm.options().fingerprints) {}

  // Recovers every job that is not settled from its last checkpoint, and settles those that are finished.
  // Rows of earlier releases are rewritten. Errors name the file that cannot be read.
  core::Status restore_all();

 private:
  core::Status restore(store::JobRow row);
  // Enters a job that was being validated, which is to be validated again.
  core::Status restore_validating(const store::JobRow& row);
  core::Status restore_unfinished(const store::JobRow& row, farm::JobRecord record);
  // Settles a finished job with these samples, and leaves it in the store.
  core::Status settle(store::JobRow row, const scheduler::JobShape& shape,
                      const std::map<int, std::vector<core::SampleRange>>& done);
  core::Status restore_damaged(const store::JobRow& row, const core::Error& error);
  core::Status add_restored(const scheduler::RestoreJob& event, farm::JobRecord record);
  core::Status rewrite(store::JobRow row);
  core::Status flush();
  core::Result<bool> lacks_samples(const store::JobRow& row, const scheduler::JobShape& shape,
                                   std::map<int, std::vector<core::SampleRange>>& done);

  farm::Farm& farm_;
  store::StateDirectory& state_;
  blobs::SceneFiles& files_;
  const FilmReader& films_;
  const server::Limits& limits_;
  const std::set<std::string>& fingerprints_;
  std::vector<store::JobRow> to_rewrite_;  // in one transaction
  std::size_t restored_ = 0;
};

}  // namespace tessera::jobs
