// SPDX-License-Identifier: Apache-2.0
// The side of the coordinator that users call for jobs: submission, lists, and changes.
//
// Takes and returns the messages of the protocol, but knows nothing of RPC. Thread-safe. Errors are those of
// the protocol (proto/tessera/v1).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <mutex>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::jobs {

// The settings that a scene file and the overrides give.
struct CheckedScene {
  v1::RenderSettings settings;  // overrides applied
  v1::DisplaySettings display;
  std::vector<std::string> warnings{};
};

// Loads and validates a scene whose blobs are all in the store. May block.
using SceneCheck = std::function<core::Result<CheckedScene>(const v1::Bundle&, const v1::RenderOverrides&)>;

class JobService {
 public:
  JobService(farm::Farm& farm, store::StateDirectory& state, blobs::SceneFiles& files,
             const FilmReader& films, film::FilmMemory& film_memory, const server::Limits& limits,
             SceneCheck check_scene);

  using Texts = google::protobuf::RepeatedPtrField<std::string>;
  // Blocks while the scene is validated and the job is stored. `submitter` is the caller's name, empty where
  // callers have none. `warnings` receives the warnings about the scene's files.
  core::Result<v1::Job> submit(const v1::SubmitJobRequest& request, const std::string& submitter = {},
                               Texts* warnings = nullptr);
  core::Result<v1::Job> get(const std::string& id);
  core::Result<v1::Job> get_without_bundle(const std::string& id);
  // The requested jobs, newest first, without their bundles.
  std::vector<v1::Job> list(const v1::ListJobsRequest& request = {});
  // These methods return after the change is stored.
  core::Result<v1::Job> cancel(const std::string& id);
  core::Result<v1::Job> pause(const std::string& id);
  core::Result<v1::Job> resume(const std::string& id);
  core::Result<v1::Job> extend(const std::string& id, std::uint32_t spp);
  core::Result<v1::Job> update(const v1::UpdateJobRequest& request);
  // Returns after the job is deleted; remove_deleted_tiles() removes its film from the store.
  core::Status remove(const std::string& id);

  // Reports that a blob could not be sent to a worker. The blob is read again. If it is missing or damaged,
  // every unfinished job that needs it fails with this reason, and the file is removed, so that a new
  // submission can upload it. Blocks while the blob is read.
  void blob_is_lost(const proto::Digest& digest, const core::Error& noticed);

  // Runs done jobs again where unverified samples of quarantined workers are in the film. Call it regularly;
  // blocks while films are read back.
  void reopen();
  // Removes some of the stored tiles of deleted jobs. Call it ten times a second: a few tiles at a time delay
  // checkpoints by some milliseconds only.
  core::Status remove_deleted_tiles() { return state_.jobs.remove_deleted_tiles(); }

  // Cancels the hashing of bundles.
  void close() { stopping_.request_stop(); }

 private:
  struct Extension;

  // ---- Submission (submission.cpp) ----
  core::Status check_bundle(const v1::Bundle& bundle);
  // The answer to a submission whose request_id is known; empty if it is not. ALREADY_EXISTS if it is another
  // submitter's.
  std::optional<core::Result<v1::Job>> answer_to_known(const std::string& request_id,
                                                       const std::string& submitter);
  core::Result<v1::Job> add(v1::Job spec, const std::string& request_id, blobs::BlobClaims::Hold files);

  // ---- Changes (changes.cpp, extension.cpp) ----
  std::optional<farm::JobSnapshot> snapshot(const std::string& id);
  core::Result<v1::Job> change(const std::string& id, const scheduler::Event& event);
  core::Result<v1::Job> store_change(core::Result<farm::JobSnapshot> changed);
  // Reads the film if it is needed. `spp`: the number to extend to; absent to verify samples.
  core::Result<Extension> prepare_extension(const std::string& id, std::optional<std::uint32_t> spp);
  core::Status reopen(const std::string& id);

  farm::Farm& farm_;
  store::StateDirectory& state_;
  blobs::SceneFiles& files_;
  const FilmReader& films_;
  film::FilmMemory& film_memory_;
  const server::Limits limits_;
  const SceneCheck check_scene_;
  std::stop_source stopping_;
  std::mutex submit_mutex_;  // held while a job is added
};

}  // namespace tessera::jobs
