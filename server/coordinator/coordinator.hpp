// SPDX-License-Identifier: Apache-2.0
// The coordinator: the scheduler, the films and the store, behind one lock.
//
// Every method takes the state lock, advances the scheduler by one event and applies the resulting actions.
// Decompression, disk access and scene validation happen outside the lock. Methods take and return the
// messages of the protocol, but know nothing of RPC. The coordinator starts no threads: its owner calls
// tick() and checkpoint() regularly. Thread-safe. Errors are those of the protocol (proto/tessera/v1).
#pragma once

#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <set>
#include <span>
#include <stop_token>
#include <string>
#include <vector>

#include "core/base/determinism_fingerprint.hpp"
#include "core/base/error.hpp"
#include "core/image/image.hpp"
#include "server/coordinator/fingerprinter.hpp"
#include "server/coordinator/job_record.hpp"
#include "server/coordinator/lease_signer.hpp"
#include "server/coordinator/quarantine.hpp"
#include "server/coordinator/rate_limited_log.hpp"
#include "server/coordinator/scene_files.hpp"
#include "server/coordinator/troubles.hpp"
#include "server/limits.hpp"
#include "server/scheduler/scheduler.hpp"
#include "server/store/state_directory.hpp"
#include "tessera/v1/render_service.pb.h"
#include "tessera/v1/worker_service.pb.h"

namespace tessera::coordinator {

struct Options {
  // The heartbeat timeout: a worker that is silent for longer loses its leases. See scheduler::Options.
  scheduler::Duration lease_duration = std::chrono::seconds(10);
  // Limits on jobs and bundles. The scene check enforces limits on the content of scenes.
  server::Limits limits{};
  // How long blobs that no job names are kept after their last upload or submission, unless their room is
  // needed earlier. A user who tries variants of a scene need not upload its files again.
  std::chrono::seconds keep_unused_blobs = std::chrono::hours(24);
  // The share of ranges that a second worker renders again to compare the bits: 0 to 1.
  double audit_share = 0;
  // The determinism fingerprint that workers need to join. The default is that of the coordinator's own
  // release.
  std::string fingerprint{core::kDeterminismFingerprint};
  // The clock. Tests replace it.
  std::function<scheduler::Time()> now = std::chrono::steady_clock::now;
};

// The settings that a scene file and the overrides give.
struct CheckedScene {
  v1::RenderSettings settings;  // overrides applied
  v1::DisplaySettings display;
  std::vector<std::string> warnings{};
};

// Loads and validates a scene whose blobs are all in the store. May block.
using SceneCheck = std::function<core::Result<CheckedScene>(const v1::Bundle&, const v1::RenderOverrides&)>;

struct Picture {
  v1::Job job;  // when copying of the image began
  core::Image image;
};

// The caller that waits for the answer to a Synchronize.
struct SynchronizeCaller {
  // Called exactly once, on any thread, without the state lock.
  std::function<void(core::Result<v1::SynchronizeResponse>)> answer;
  // Whether the caller has gone. Called on any thread until `answer` is called. A caller that has gone is
  // given no leases.
  std::function<bool()> is_gone = [] { return false; };
  // See scheduler::WorkerInfo.
  std::string principal{};
};

class Coordinator {
 public:
  // Recovers every job of `state` from its last checkpoint. Errors name the file that cannot be read.
  static core::Result<std::unique_ptr<Coordinator>> open(Options options, store::StateDirectory state,
                                                         SceneCheck check_scene);
  ~Coordinator();

  // ---- For users ----
  using Texts = google::protobuf::RepeatedPtrField<std::string>;
  // Blocks while the scene is validated and the job is stored. `submitter` is the caller's name, empty where
  // callers have none. `warnings` receives the warnings about the scene's files.
  core::Result<v1::Job> submit_job(const v1::SubmitJobRequest& request, const std::string& submitter = {},
                                   Texts* warnings = nullptr);
  core::Result<v1::Job> job(const std::string& id);
  core::Result<v1::Job> job_without_bundle(const std::string& id);
  // The requested jobs, newest first, without their bundles.
  std::vector<v1::Job> jobs(const v1::ListJobsRequest& request = {});
  // These methods return after the change is stored.
  core::Result<v1::Job> cancel_job(const std::string& id);
  core::Result<v1::Job> pause_job(const std::string& id);
  core::Result<v1::Job> resume_job(const std::string& id);
  core::Result<v1::Job> extend_job(const std::string& id, std::uint32_t spp);
  core::Result<v1::Job> update_job(const v1::UpdateJobRequest& request);
  // Returns after the job is deleted; remove_deleted_tiles() removes its film from the store.
  core::Status delete_job(const std::string& id);
  // Copies the image tile by tile, and holds the state lock for a few tiles at a time. Tiles of a running job
  // may show different moments; those of a done job are all complete.
  core::Result<Picture> picture(const std::string& id);
  std::vector<v1::ListWorkersResponse::Worker> workers();

  // ---- For workers ----
  // Answers at once, when there is a change, or before the worker's heartbeat is due.
  void synchronize(const v1::SynchronizeRequest& request, SynchronizeCaller caller);
  core::Result<v1::SubmitResultResponse> submit_result(const v1::SubmitResultRequest& request);

  const store::BlobStore& blobs() const { return state_.blobs; }
  // The scene files, their users and the room that they take.
  SceneFiles& files() { return files_; }
  // Reports that a blob could not be sent to a worker. The blob is read again. If it is missing or damaged,
  // every unfinished job that needs it fails with this reason, and the file is removed, so that a new
  // submission can upload it. Blocks while the blob is read.
  void blob_is_lost(const proto::Digest& digest, const core::Error& noticed);

  // ---- For the owner ----
  // Advances time: ends the leases of silent workers and answers calls that have waited long enough. Call it
  // about every 100 ms. Returns whether somebody waits for a checkpoint: users learn that a job is done or
  // has failed after the next one. Ends the process if an invariant is broken, since a wrong image would be
  // worse.
  bool tick();
  // Writes all changes since the last checkpoint. After an error, the next checkpoint writes again what is
  // missing.
  core::Status checkpoint();
  // Runs done jobs again where unverified samples of quarantined workers are in the film. Call it regularly;
  // blocks while films are read back.
  void reopen_jobs();
  // Removes some of the stored tiles of deleted jobs. Call it ten times a second: a few tiles at a time delay
  // checkpoints by some milliseconds only.
  core::Status remove_deleted_tiles() { return state_.jobs.remove_deleted_tiles(); }
  // Answers all waiting calls, and all later ones, with UNAVAILABLE.
  void close();

 private:
  class StateLock;
  struct ParkedCall {
    SynchronizeCaller caller;
    std::set<std::string> known_jobs;
    scheduler::Time deadline;
  };
  struct LoadedFilm;

  Coordinator(Options options, store::StateDirectory state, SceneCheck check_scene);

  core::Status restore_job(const store::JobRow& row);
  core::Status restore_damaged_job(const store::JobRow& row, const core::Error& error);
  core::Status add_restored(const scheduler::RestoreJob& event, JobRecord record);
  core::Result<bool> lacks_samples(const store::JobRow& row, const core::TileGrid& grid,
                                   std::map<int, std::vector<core::SampleRange>>& done);
  bool can_be_verified(Produced& provenance) const;
  core::Result<LoadedFilm> load_film(const v1::Job& spec);
  // Empty if the store has no samples of the tile.
  core::Result<TileContent> load_tile(const v1::Job& spec, const core::TileGrid& grid, int tile);
  core::Result<Picture> take_picture(const std::string& id);
  core::Result<core::Image> develop_row(const v1::Job& spec, const core::TileGrid& grid, int row);
  // Copies the tiles from `begin` to `end` from the film while holding the state lock, or else from the
  // store.
  core::Result<std::vector<core::Film::TileSums>> copy_tiles(const v1::Job& spec, const core::TileGrid& grid,
                                                             int begin, int end);

  class QuotaReservation;
  // Reserves one of the submitter's open jobs for a job that is about to be checked. RESOURCE_EXHAUSTED if
  // none is left.
  core::Result<QuotaReservation> reserve_quota(const std::string& submitter);
  core::Status check_bundle(const v1::Bundle& bundle);
  // The answer to a submission whose request_id is known; empty if it is not. ALREADY_EXISTS if it is another
  // submitter's.
  std::optional<core::Result<v1::Job>> answer_to_known(const std::string& request_id,
                                                       const std::string& submitter);
  core::Result<v1::Job> add_job(v1::Job spec, const std::string& request_id, BlobClaims::Hold files);

  struct ChangedJob {
    v1::Job job;
    store::JobRow row;
  };
  core::Result<v1::Job> change_job(const std::string& id, const scheduler::Event& event);
  core::Result<v1::Job> store_change(core::Result<ChangedJob> changed);
  struct Extension;
  core::Result<Extension> prepare_extension(const std::string& id);
  core::Status reopen_job(const std::string& id);
  void fail_job(StateLock& lock, const std::string& id, const std::string& failure);

  // ---- The caller holds the state lock ----
  JobRecord* find(const std::string& id);
  core::Result<ChangedJob> change(StateLock& lock, const std::string& id, const scheduler::Event& event);
  // Whether the film must be read back before the job can take results.
  bool needs_film(const StateLock& lock, const JobRecord& record) const;
  core::Status may_extend(const StateLock& lock, const JobRecord& record, std::uint32_t spp) const;
  core::Status may_open_job(const StateLock& lock, const std::string& submitter) const;
  v1::Job describe_now(const StateLock& lock, const JobRecord& record) const;
  void apply(StateLock& lock, const scheduler::Actions& actions);
  void note_change(const scheduler::JobChange& change);
  void note_workers(const StateLock& lock);
  void answer_due_calls(StateLock& lock);
  static void refuse(StateLock& lock, SynchronizeCaller& caller, const core::Error& error);
  core::Status admit(const StateLock& lock, const v1::SynchronizeRequest& request);
  // Whether the worker is registered with the scheduler and not lost.
  bool is_known(const StateLock& lock, const std::string& id) const;
  void note_troubles(const StateLock& lock, const v1::SynchronizeRequest& request);
  void add_troubles(v1::Job& job) const;
  // FAILED_PRECONDITION if the workers of this farm cannot render more of the job.
  core::Status may_continue(const JobRecord& record) const;
  // Adds to the response the leases that the worker should hold besides those that it has named.
  void tell_with_answer(const scheduler::SubmitResult& event, scheduler::Reply reply,
                        v1::SubmitResultResponse& response);
  struct Delivery;
  core::Status check_token(const v1::SubmitResultRequest& request);
  core::Result<v1::SubmitResultResponse> count_result(StateLock& lock, const v1::SubmitResultRequest& request,
                                                      const Delivery& delivery);
  void empty_tiles(const scheduler::Actions& actions);
  void follow_audits(const scheduler::Actions& actions);
  void note_lack_of_auditors(const StateLock& lock);
  core::Status may_count(const StateLock& lock, const JobRecord& record,
                         const v1::SubmitResultRequest& request);
  void note_rejected_result(StateLock& lock, const std::string& worker, const core::Error& error);
  scheduler::Actions top_up(StateLock& lock, const std::string& worker, bool answer_unchanged);
  void release_parked(StateLock& lock, const std::string& worker, const scheduler::Reply& reply);
  v1::SynchronizeResponse respond(const scheduler::Reply& reply, const std::set<std::string>& known_jobs);

  // ---- Checkpoints ----
  struct TileRef {
    std::string job_id;
    int tile;
  };
  struct TileCopy {
    TileRef ref;
    core::PixelRect rect;
    std::vector<core::SampleRange> done;
    TileContent content;
  };
  std::vector<store::JobRow> changed_rows();
  std::vector<TileRef> changed_tiles();
  core::Status write_tiles(std::span<const TileRef> tiles);
  core::Status write(const std::vector<store::JobRow>& rows);
  void note_stored(const std::vector<store::JobRow>& rows);
  void publish_completions(const std::vector<store::JobRow>& rows);

  const Options options_;
  const SceneCheck check_scene_;

  std::stop_source stopping_;  // cancels the hashing of bundles
  // Internally synchronised:
  store::StateDirectory state_;
  SceneFiles files_;
  const Fingerprinter fingerprinter_;
  const LeaseSigner signer_;
  std::mutex submit_mutex_;      // held while a job is added
  std::mutex checkpoint_mutex_;  // held while a checkpoint is written

  std::mutex state_mutex_;
  // Guarded by state_mutex_:
  scheduler::Scheduler scheduler_;
  std::map<std::string, JobRecord> jobs_;
  std::map<std::string, std::string> job_of_request_;
  std::map<std::string, std::uint64_t> places_;  // quota reservations by submitter
  std::map<std::string, ParkedCall> parked_;     // by worker
  Quarantine quarantine_;
  Troubles troubles_;
  RateLimitedLog rejected_log_, troubles_log_;
  std::set<std::string> to_reopen_;             // jobs
  std::map<std::string, std::string> present_;  // names of the registered workers by id, for the log
  scheduler::Time next_check_{};
  bool checkpoint_is_awaited_ = false;
  bool closed_ = false;
};

}  // namespace tessera::coordinator
