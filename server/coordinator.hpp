// SPDX-License-Identifier: Apache-2.0
// The parts of a coordinator, put together: the farm's state, the store, and the services for users and
// workers. Starts no threads: its owner calls the dispatcher's tick(), the checkpointer and the maintenance
// functions regularly. Thread-safe.
#pragma once

#include <memory>

#include "core/base/error.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/dispatch/dispatcher.hpp"
#include "server/dispatch/lease_signer.hpp"
#include "server/farm/farm.hpp"
#include "server/film/film_memory.hpp"
#include "server/film/fingerprinter.hpp"
#include "server/jobs/checkpointer.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/images.hpp"
#include "server/jobs/job_service.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"

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
  // Recovers every job of `state` from its last checkpoint. Errors name the file that cannot be read.
  static core::Result<std::unique_ptr<Coordinator>> open(const CoordinatorOptions& options,
                                                         store::StateDirectory state,
                                                         jobs::SceneCheck check_scene);
  ~Coordinator();

  jobs::JobService& jobs() { return jobs_; }
  jobs::Images& images() { return images_; }
  jobs::Checkpointer& checkpointer() { return checkpointer_; }
  dispatch::Dispatcher& dispatcher() { return dispatcher_; }
  // The scene files, their users and the room that they take.
  blobs::SceneFiles& files() { return files_; }
  const blobs::BlobStore& blobs() const { return state_.blobs; }

  // Answers all waiting calls, and all later ones, with UNAVAILABLE.
  void close();

 private:
  Coordinator(const CoordinatorOptions& options, store::StateDirectory state, jobs::SceneCheck check_scene);

  store::StateDirectory state_;
  blobs::SceneFiles files_;
  film::FilmMemory film_memory_;
  const film::Fingerprinter fingerprinter_;
  const dispatch::LeaseSigner signer_;
  farm::Farm farm_;
  jobs::FilmReader films_;
  jobs::JobService jobs_;
  jobs::Images images_;
  jobs::Checkpointer checkpointer_;
  dispatch::Dispatcher dispatcher_;
};

}  // namespace tessera::server
