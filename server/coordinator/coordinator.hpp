// SPDX-License-Identifier: Apache-2.0
// The coordinator: the scheduler, the films and the store, behind one gate.
//
// Every method takes its turn at one lock, in which it advances the scheduler by one event and does what
// follows from it; decompression, disks and scene validation stay outside. Methods speak the messages of the
// contract, but know nothing of RPC. There are no threads here: whoever runs a coordinator calls tick() and
// checkpoint() regularly. Thread-safe. Errors are those of the contract (proto/tessera/v1).
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
  // A worker that is silent for so long loses its leases. See scheduler::Options.
  scheduler::Duration lease_duration = std::chrono::seconds(10);
  // Of jobs and bundles. What a scene may hold is for whoever checks scenes.
  server::Limits limits{};
  // Blobs that no job names are kept for so long after they were last uploaded or submitted, while nobody
  // wants their room: for somebody who tries one scene after another.
  std::chrono::seconds keep_unused_blobs = std::chrono::hours(24);
  // The share of ranges that another worker renders again, to compare the bits: 0 to 1.
  double audit_share = 0;
  // The determinism fingerprint of the workers that may join: that of the coordinator's own release, unless
  // an operator names another.
  std::string fingerprint{core::kDeterminismFingerprint};
  // The clock. Tests bring their own.
  std::function<scheduler::Time()> now = std::chrono::steady_clock::now;
};

// What a scene file says of its pictures.
struct CheckedScene {
  v1::RenderSettings settings;  // overrides applied
  v1::DisplaySettings display;
  std::vector<std::string> warnings{};
};

// Loads and validates a scene whose blobs are all here. May block.
using SceneCheck = std::function<core::Result<CheckedScene>(const v1::Bundle&, const v1::RenderOverrides&)>;

struct Picture {
  v1::Job job;  // when the picture began to be taken
  core::Image image;
};

// Who waits for the answer to a Synchronize.
struct SynchronizeCaller {
  // Called exactly once, on any thread, outside the gate.
  std::function<void(core::Result<v1::SynchronizeResponse>)> answer;
  // Whether nobody listens any more; asked until then, on any thread. Nothing is leased to it then.
  std::function<bool()> is_gone = [] { return false; };
  // See scheduler::WorkerInfo.
  std::string principal{};
};

class Coordinator {
 public:
  // Takes up every job of `state` where it was checkpointed. Errors name the file that cannot be read.
  static core::Result<std::unique_ptr<Coordinator>> open(Options options, store::StateDirectory state,
                                                         SceneCheck check_scene);
  ~Coordinator();

  // ---- For users ----
  using Texts = google::protobuf::RepeatedPtrField<std::string>;
  // Blocks while the scene is validated and the job is stored. `submitter`: who calls, where callers have
  // names. `warnings` gets those about the scene's files.
  core::Result<v1::Job> submit_job(const v1::SubmitJobRequest& request, const std::string& submitter = {},
                                   Texts* warnings = nullptr);
  core::Result<v1::Job> job(const std::string& id);
  core::Result<v1::Job> job_without_bundle(const std::string& id);
  // Those that are asked for, newest first, without their bundles.
  std::vector<v1::Job> jobs(const v1::ListJobsRequest& request = {});
  // These return when the change is stored.
  core::Result<v1::Job> cancel_job(const std::string& id);
  core::Result<v1::Job> pause_job(const std::string& id);
  core::Result<v1::Job> resume_job(const std::string& id);
  core::Result<v1::Job> extend_job(const std::string& id, std::uint32_t spp);
  core::Result<v1::Job> update_job(const v1::UpdateJobRequest& request);
  // Returns when the job is forgotten; remove_deleted_tiles() removes its film from the store.
  core::Status delete_job(const std::string& id);
  // Each tile as it is when it is copied, of a job that is done all as they were when it was. Holds the gate
  // for a few tiles at a time.
  core::Result<Picture> picture(const std::string& id);
  std::vector<v1::ListWorkersResponse::Worker> workers();

  // ---- For workers ----
  // Answers at once, or when there is something to change, or before the worker must be heard of again.
  void synchronize(const v1::SynchronizeRequest& request, SynchronizeCaller caller);
  core::Result<v1::SubmitResultResponse> submit_result(const v1::SubmitResultRequest& request);

  const store::BlobStore& blobs() const { return state_.blobs; }
  // Who needs them, and their room.
  SceneFiles& files() { return files_; }
  // A worker could not be given a blob for this reason. If it is missing or damaged, also when it is read
  // once more, every unfinished job that needs it fails with the sentence, and the file is removed, so that
  // submitting again mends it. Blocks while the blob is read.
  void blob_is_lost(const proto::Digest& digest, const core::Error& noticed);

  // ---- For whoever runs it ----
  // Lets time pass: takes leases from silent workers, answers calls that have waited long enough. Due about
  // every 100 ms. Whether somebody waits for a checkpoint: users are told of a job that is done, or has
  // failed, after the next one. Ends the process if an invariant is broken, rather than let it spoil a
  // picture.
  bool tick();
  // Writes what has changed since the last one. After an error everything not written is tried again next
  // time.
  core::Status checkpoint();
  // Lets done jobs run again of which workers that were quarantined have rendered something that nobody has
  // verified. Due now and then; blocks while films are read back.
  void reopen_jobs();
  // Removes some of the stored tiles of deleted jobs. Due ten times a second: a few at a time hold up
  // checkpoints for some milliseconds.
  core::Status remove_deleted_tiles() { return state_.jobs.remove_deleted_tiles(); }
  // Answers all waiting calls, and every later one, with UNAVAILABLE.
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
  // Empty where the store has nothing of the tile.
  core::Result<TileContent> load_tile(const v1::Job& spec, const core::TileGrid& grid, int tile);
  core::Result<Picture> take_picture(const std::string& id);
  core::Result<core::Image> develop_row(const v1::Job& spec, const core::TileGrid& grid, int row);
  // The tiles from `begin` to `end`, of the film in one turn at the gate, or else of the store.
  core::Result<std::vector<core::Film::TileSums>> copy_tiles(const v1::Job& spec, const core::TileGrid& grid,
                                                             int begin, int end);

  class QuotaReservation;
  // Among the submitter's open jobs, for one that is about to be checked. RESOURCE_EXHAUSTED if there is
  // none.
  core::Result<QuotaReservation> reserve_quota(const std::string& submitter);
  core::Status check_bundle(const v1::Bundle& bundle);
  // What to answer a submission with whose request_id is known already. ALREADY_EXISTS: it is another
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

  // ---- Within a turn ----
  JobRecord* find(const std::string& id);
  core::Result<ChangedJob> change(StateLock& lock, const std::string& id, const scheduler::Event& event);
  // Whether its film must be read back before it can take results again.
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
  // Whether the scheduler has heard of the worker lately.
  bool is_known(const StateLock& lock, const std::string& id) const;
  void note_troubles(const StateLock& lock, const v1::SynchronizeRequest& request);
  void add_troubles(v1::Job& job) const;
  // Whether workers of this farm can render more of it.
  core::Status may_continue(const JobRecord& record) const;
  // Gives the worker what it should hold besides what it has named.
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

  std::stop_source stopping_;  // ends the hashing of bundles
  // Thread-safe by themselves:
  store::StateDirectory state_;
  SceneFiles files_;
  const Fingerprinter fingerprinter_;
  const LeaseSigner signer_;
  std::mutex submit_mutex_;      // one job is added at a time
  std::mutex checkpoint_mutex_;  // one checkpoint is written at a time

  std::mutex state_mutex_;
  // Guarded by state_mutex_:
  scheduler::Scheduler scheduler_;
  std::map<std::string, JobRecord> jobs_;
  std::map<std::string, std::string> job_of_request_;
  std::map<std::string, std::uint64_t> places_;  // taken by each submitter for jobs that are being checked
  std::map<std::string, ParkedCall> parked_;     // by worker
  Quarantine quarantine_;
  Troubles troubles_;
  RateLimitedLog rejected_log_, troubles_log_;
  std::set<std::string> to_reopen_;             // jobs
  std::map<std::string, std::string> present_;  // names of the workers that are heard of, by id; for the log
  scheduler::Time next_check_{};
  bool checkpoint_is_awaited_ = false;
  bool closed_ = false;
};

}  // namespace tessera::coordinator
