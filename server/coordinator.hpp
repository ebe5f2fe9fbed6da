// SPDX-License-Identifier: Apache-2.0
// The parts of a coordinator, put together: the farm's state, the store, and the services for users and
// workers. Starts no threads: its owner calls the dispatcher's tick(), the checkpointer and the maintenance
// functions regularly. Thread-safe.
#pragma once

#include <memory>
#include <set>
#include <string>

#include "core/base/error.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/blobs/segment_tracker.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/dispatch/lease_signer.hpp"
#include "server/farm/farm.hpp"
#include "server/film/film_memory.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/fleet/fleet.hpp"
#include "server/jobs/checkpointer.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/images.hpp"
#include "server/jobs/job_service.hpp"
#include "server/jobs/validation_stats.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"
#include "server/watch/farm_feed.hpp"
#include "server/watch/tile_feed.hpp"

namespace tessera::server {

struct CoordinatorOptions {
  // Its epoch and its signer are set by the coordinator.
  farm::Options farm{};
  // Limits on jobs and bundles. The scene check enforces limits on the content of scenes.
  Limits limits{};
  // How long blobs that no job names are kept after their last upload or submission, unless their room is
  // needed earlier. A user who tries variants of a scene need not upload its files again.
  std::chrono::seconds keep_unused_blobs = std::chrono::hours(24);
};

class Coordinator {
 public:
  // Recovers the quarantine, and every job of `state` that is not settled from its last checkpoint. Errors
  // name the file that cannot be read.
  static core::Result<std::unique_ptr<Coordinator>> open(const CoordinatorOptions& options,
                                                         store::StateDirectory state,
                                                         jobs::SceneCheck check_scene);
  ~Coordinator();

  jobs::JobService& jobs() { return jobs_; }
  jobs::Images& images() { return images_; }
  jobs::Checkpointer& checkpointer() { return checkpointer_; }
  dispatch::Dispatcher& dispatcher() { return dispatcher_; }
  fleet::Fleet& fleet() { return fleet_; }
  // The determinism fingerprints that workers may have.
  const std::set<std::string>& fingerprints() const { return farm_.options().fingerprints; }
  events::EventLog& events() { return farm_.events(); }
  watch::FarmFeed& farm_feed() { return farm_feed_; }
  watch::TileFeed& tile_feed() { return tile_feed_; }
  // The scene files, their users and the room that they take.
  blobs::SceneFiles& files() { return files_; }
  // Which workers have which parts of them.
  blobs::SegmentTracker& segments() { return segments_; }
  store::JobStore& store() { return state_.jobs; }
  const blobs::BlobStore& blobs() const { return state_.blobs; }
  const store::JobStore& store() const { return state_.jobs; }
  farm::Farm& farm() { return farm_; }
  const film::FilmMemory& film_memory() const { return film_memory_; }
  const jobs::ValidationStats& validations() const { return validations_; }

  // Answers all waiting calls, and all later ones, with UNAVAILABLE.
  void close();

 private:
  Coordinator(const CoordinatorOptions& options, store::StateDirectory state, jobs::SceneCheck check_scene);

  core::Status for_each_bundle(const blobs::TakeBundle& take);

  store::StateDirectory state_;
  blobs::SceneFiles files_;
  blobs::SegmentTracker segments_;
  film::FilmMemory film_memory_;
  const film::Fingerprinter fingerprinter_;
  const dispatch::LeaseSigner signer_;
  farm::Farm farm_;
  jobs::FilmReader films_;
  jobs::ValidationStats validations_;
  jobs::JobService jobs_;
  jobs::Images images_;
  jobs::Checkpointer checkpointer_;
  dispatch::Dispatcher dispatcher_;
  fleet::Fleet fleet_;
  watch::FarmFeed farm_feed_;
  watch::TileFeed tile_feed_;
};

}  // namespace tessera::server
