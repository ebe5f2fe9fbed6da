// SPDX-License-Identifier: Apache-2.0
// Recovers the jobs of an earlier run of the coordinator. Used once, before anybody is served.
#pragma once

#include <map>
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

class Restoration {
 public:
  Restoration(farm::Farm& farm, store::StateDirectory& state, blobs::SceneFiles& files,
              const FilmReader& films, const server::Limits& limits)
      : farm_(farm),
        state_(state),
        files_(files),
        films_(films),
        limits_(limits),
        fingerprint_(farm.options().fingerprint) {}

  // Recovers every job from its last checkpoint. Errors name the file that cannot be read.
  core::Status restore_all();

 private:
  core::Status restore(const store::JobRow& row);
  core::Status restore_damaged(const store::JobRow& row, const core::Error& error);
  core::Status add_restored(const scheduler::RestoreJob& event, farm::JobRecord record);
  core::Result<bool> lacks_samples(const store::JobRow& row, const core::TileGrid& grid,
                                   std::map<int, std::vector<core::SampleRange>>& done);

  farm::Farm& farm_;
  store::StateDirectory& state_;
  blobs::SceneFiles& files_;
  const FilmReader& films_;
  const server::Limits& limits_;
  const std::string& fingerprint_;
};

}  // namespace tessera::jobs
