// SPDX-License-Identifier: Apache-2.0
// The side of the coordinator that users call for jobs: submission, lists, and changes.
//
// Takes and returns the messages of the protocol, but knows nothing of RPC. Thread-safe. Errors are those of
// the protocol (proto/tessera/v1).
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/base/mutex.hpp"
#include "server/blobs/scene_files.hpp"
#include "server/farm/farm.hpp"
#include "server/farm/state_lock.hpp"
#include "server/jobs/film_reader.hpp"
#include "server/jobs/labels.hpp"
#include "server/jobs/retirement.hpp"
#include "server/limits.hpp"
#include "server/store/state_directory.hpp"
#include "tessera/v1/render_service.pb.h"

namespace tessera::jobs {

// The settings that a scene file and the overrides give.
struct CheckedScene {
  v1::RenderSettings settings;  // overrides applied
  v1::DisplaySettings display;
  std::vector<std::string> warnings{};
  // Of a scene with layers: see tessera.v1.Job.
  std::vector<std::string> scene_digests{};
  std::vector<v1::TextAttribute> attributes{};
};

// Loads and validates a scene, at these frames, whose blobs are all in the store. May block. UNAVAILABLE
// after a stop request.
using SceneCheck = std::function<core::Result<CheckedScene>(const v1::Bundle&, const v1::RenderOverrides&,
                                                            const std::vector<std::int32_t>& frames,
                                                            const std::stop_token& stop)>;

// A job that nobody validates yet.
struct UnvalidatedJob {
  std::string id;
  std::string owner;
};

class JobService {
 public:
  JobService(farm::Farm& farm, store::StateDirectory& state, blobs::SceneFiles& files,
             const FilmReader& films, film::FilmMemory& film_memory, const server::Limits& limits,
             SceneCheck check_scene);

  // ---- Submission ----
  // Checks the request and stores the job in the state VALIDATING. `owner` is the caller's name, empty where
  // callers have none, and `peer` the address of its machine, for the log. The caller then calls validate().
  core::Result<v1::Job> submit(const v1::SubmitJobRequest& request, const std::string& owner = {},
                               const std::string& peer = {});
  // The answer to a submission whose request_id is known; empty if it is not. ALREADY_EXISTS if it is another
  // owner's.
  std::optional<core::Result<v1::Job>> find_submission(const std::string& request_id,
                                                       const std::string& owner);
  // Validates the scene of a job in the state VALIDATING, and starts or fails the job. Does nothing if
  // somebody does so already. Blocks meanwhile; cancelling and deleting the job, and close(), end it early.
  void validate(const std::string& id);
  // The jobs in the state VALIDATING that nobody is going to validate: those of an earlier run of the
  // coordinator, and those whose validation had no result.
  std::vector<UnvalidatedJob> unvalidated();
  // Notes that the caller is going to validate such a job. Returns false if somebody else is.
  bool queue_validation(const std::string& id);

  // ---- Lists and changes ----
  core::Result<v1::Job> get(const std::string& id);
  core::Result<v1::Job> get_without_bundle(const std::string& id);
  // Also without warnings and the list of images.
  core::Result<v1::Job> summary(const std::string& id);
  // The requested jobs, newest first, without their bundles and warnings. INVALID_ARGUMENT: the page token is
  // not from an earlier response, or a state is unknown.
  core::Result<v1::ListJobsResponse> list(const v1::ListJobsRequest& request = {});
  // The jobs that are not in the store alone.
  std::size_t count_in_memory();
  // These methods return after the change is stored.
  core::Result<v1::Job> cancel(const std::string& id);
  core::Result<v1::Job> pause(const std::string& id);
  core::Result<v1::Job> resume(const std::string& id);
  core::Result<v1::Job> extend(const v1::ExtendJobRequest& request);
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
  // Deletes some of the finished jobs that `keep` does not name, those that finished first. Call it every few
  // seconds.
  core::Status retire(const KeepFinished& keep);

  // Ends all validations; they are repeated after a restart.
  void close();

 private:
  struct ListedJob {
    farm::JobSnapshot job;
    bool is_settled = false;
    std::int64_t number = 0;  // of its row
  };
  static core::Error stopping();

  // ---- Submission (submission.cpp) ----
  core::Status check_request(const v1::SubmitJobRequest& request) const;
  core::Result<v1::Job> add(farm::ValidatingJob job, const std::string& peer);
  core::Result<std::optional<farm::JobSnapshot>> find_known(const std::string& request_id);

  // ---- Validation (validation.cpp) ----
  struct Validation {
    std::shared_ptr<const v1::Job> spec;
    std::shared_ptr<const v1::SubmitJobRequest> submission;
    std::stop_token stop;
  };
  std::optional<Validation> begin_validation(const std::string& id);
  // Returns the job with the settings of its scene.
  core::Result<v1::Job> check_scene(const Validation& task);
  core::Status check_files(const v1::Bundle& bundle, const std::stop_token& stop);
  // `trouble`: why, for users; empty if the coordinator is stopping.
  void repeat_validation(const std::string& id, std::string trouble);
  core::Status fail_validation(const std::string& id, const core::Error& error);
  // Stores a validated job and hands it to the scheduler.
  core::Status start(v1::Job spec);
  // Ends a job that is being validated in this state. Empty if there is none.
  std::optional<core::Result<farm::JobSnapshot>> end_unvalidated(const std::string& id,
                                                                 scheduler::JobState state,
                                                                 const scheduler::Failure& failure);
  std::optional<core::Status> remove_validating(const std::string& id);

  // ---- Lists (listing.cpp) ----
  core::Result<std::optional<std::int64_t>> list_some(const store::JobQuery& wanted_jobs,
                                                      const v1::ListJobsRequest& request, int limit,
                                                      v1::ListJobsResponse& response);
  core::Result<std::optional<farm::JobSnapshot>> current(ListedJob listed);

  // ---- Changes (changes.cpp, extension.cpp, reopening.cpp). Those that return std::optional: empty if the
  // job is not where they look for it, since it has just moved between the memory and the store ----
  core::Result<v1::Job> change(const std::string& id, const scheduler::Event& event);
  core::Result<v1::Job> store_change(core::Result<farm::JobSnapshot> changed);
  std::optional<core::Result<v1::Job>> extend_in_memory(const v1::ExtendJobRequest& request);
  std::optional<core::Result<v1::Job>> extend_stored(const v1::ExtendJobRequest& request);
  std::optional<core::Status> reopen_in_memory(const std::string& id);
  std::optional<core::Status> reopen_stored(const std::string& id);
  // Adds the done jobs of the store that may have samples of these workers to those to reopen.
  core::Status find_jobs_to_reopen(const std::vector<scheduler::Producer>& producers);
  // Reads the film of a stored job and puts it into memory in this state, with the targets of this shape.
  // DATA_LOSS if samples cannot be read. Whether the job was still as in this row.
  core::Result<bool> bring_back(store::JobRow row, scheduler::JobState state,
                                const scheduler::JobShape& shape);

  farm::Farm& farm_;
  store::StateDirectory& state_;
  blobs::SceneFiles& files_;
  const FilmReader& films_;
  film::FilmMemory& film_memory_;
  const server::Limits limits_;
  const SceneCheck check_scene_;
  std::stop_source stopping_;
  core::Mutex submit_mutex_;  // held while a job enters or leaves the state VALIDATING
  core::Mutex moving_mutex_;  // held while a job of the store enters the memory, or is deleted
};

}  // namespace tessera::jobs
