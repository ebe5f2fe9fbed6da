// SPDX-License-Identifier: Apache-2.0
#include "server/coordinator/coordinator.hpp"

#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include <cstdlib>
#include <limits>
#include <utility>

#include "server/coordinator/state_lock.hpp"
#include "server/coordinator/wire.hpp"

namespace tessera::coordinator {

namespace {

constexpr auto kCheckPeriod = std::chrono::seconds(1);

scheduler::Options scheduler_options(const Options& options, std::uint32_t epoch, const LeaseSigner& signer) {
  scheduler::Options result;
  result.epoch = epoch;
  result.lease_duration = options.lease_duration;
  result.forget_after = 10 * options.lease_duration;
  result.audit_share = options.audit_share;
  result.audit_secret = random_number();
  result.sign = [signer](scheduler::LeaseId lease, const scheduler::WorkerId& holder,
                         const scheduler::JobId& job) { return signer.sign(lease, holder, job); };
  return result;
}

// Converts a time of the scheduler's clock to milliseconds since 1970-01-01 UTC.
std::int64_t wall_ms(scheduler::Time time, scheduler::Time now) {
  const auto since_1970 = std::chrono::system_clock::now().time_since_epoch() - (now - time);
  return std::chrono::duration_cast<std::chrono::milliseconds>(since_1970).count();
}

}  // namespace

Coordinator::Coordinator(Options options, store::StateDirectory state, SceneCheck check_scene)
    : options_(std::move(options)),
      check_scene_(std::move(check_scene)),
      state_(std::move(state)),
      files_(state_.blobs, {options_.limits, options_.keep_unused_blobs, options_.now}),
      fingerprinter_(state_.jobs.secret()),
      signer_(state_.jobs.secret()),
      scheduler_(scheduler_options(options_, state_.jobs.epoch(), signer_)) {}

Coordinator::~Coordinator() {
  close();
}

core::Result<std::unique_ptr<Coordinator>> Coordinator::open(Options options, store::StateDirectory state,
                                                             SceneCheck check_scene) {
  std::unique_ptr<Coordinator> coordinator(
      new Coordinator(std::move(options), std::move(state), std::move(check_scene)));
  if (const auto& torn_end = coordinator->state_.jobs.torn_end())
    spdlog::warn("{}: continuing with what was written before", *torn_end);
  const auto rows = coordinator->state_.jobs.jobs();
  if (!rows) return core::fail(rows.error());
  for (const store::JobRow& row : *rows) {
    if (auto restored = coordinator->restore_job(row); !restored) return core::fail(restored.error());
  }
  if (!rows->empty()) spdlog::info("recovered {} jobs from the state directory", rows->size());
  return coordinator;
}

core::Result<v1::Job> Coordinator::job(const std::string& id) {
  const StateLock lock(*this);
  const JobRecord* record = find(id);
  if (record == nullptr) return core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id));
  v1::Job job = describe_now(lock, *record);
  add_troubles(job);
  return job;
}

core::Result<v1::Job> Coordinator::job_without_bundle(const std::string& id) {
  const StateLock lock(*this);
  const JobRecord* record = find(id);
  if (record == nullptr) return core::fail(core::ErrorCode::kNotFound, fmt::format("there is no job {}", id));
  v1::Job job = summarise(*record, *scheduler_.job({id}, lock.now()));
  add_troubles(job);
  return job;
}

void Coordinator::add_troubles(v1::Job& job) const {
  if (job.state() != v1::JOB_STATE_RUNNING) return;
  for (std::string& trouble : troubles_.of_job(job.id())) job.add_troubles(std::move(trouble));
}

std::vector<v1::Job> Coordinator::jobs(const v1::ListJobsRequest& request) {
  const std::size_t most =
      request.max_jobs() == 0 ? std::numeric_limits<std::size_t>::max() : request.max_jobs();
  const StateLock lock(*this);
  std::vector<v1::Job> result;
  for (const scheduler::JobView& view : scheduler_.jobs(lock.now(), request.id_prefix(), most)) {
    result.push_back(summarise(jobs_.at(view.id.value), view));
  }
  return {result.rbegin(), result.rend()};
}

std::vector<v1::ListWorkersResponse::Worker> Coordinator::workers() {
  const StateLock lock(*this);
  std::vector<v1::ListWorkersResponse::Worker> result;
  for (const scheduler::WorkerView& worker : scheduler_.workers(lock.now())) {
    result.push_back(to_wire(worker, wall_ms(worker.last_seen, lock.now())));
    result.back().set_rejected_results(quarantine_.refusals(worker.info.id.value));
    for (std::string& trouble : troubles_.of_worker(worker.info.id.value))
      result.back().add_troubles(std::move(trouble));
    if (!quarantine_.is_quarantined(worker.info.id.value)) continue;
    result.back().set_quarantined(true);
    result.back().set_quarantine_reason(quarantine_.because(worker.info.id.value, worker.info.machine));
  }
  return result;
}

bool Coordinator::tick() {
  StateLock lock(*this);
  apply(lock, scheduler_.handle(scheduler::Tick{}, lock.now()));
  answer_due_calls(lock);
  if (lock.now() < next_check_) return checkpoint_is_awaited_;
  next_check_ = lock.now() + kCheckPeriod;
  note_workers(lock);
  rejected_log_.flush(lock.now());
  troubles_log_.flush(lock.now());
  note_lack_of_auditors(lock);
  if (const auto broken = scheduler_.check_invariants(scheduler::CheckDepth::kCounters)) {
    spdlog::critical("a defect, please report it with this line: {}", *broken);
    std::abort();
  }
  return checkpoint_is_awaited_;
}

void Coordinator::answer_due_calls(StateLock& lock) {
  // Callers that have gone are given nothing in any case; this only removes them.
  const bool look_for_gone = lock.now() >= next_check_;
  std::vector<std::string> due;
  for (const auto& [worker, call] : parked_) {
    if (call.deadline <= lock.now() || (look_for_gone && call.caller.is_gone())) due.push_back(worker);
  }
  for (const std::string& worker : due) apply(lock, top_up(lock, worker, true));
}

void Coordinator::note_workers(const StateLock& lock) {
  std::map<std::string, std::string> present;
  std::set<std::string> known;
  for (const scheduler::WorkerView& worker : scheduler_.workers(lock.now())) {
    known.insert(worker.info.id.value);
    if (!worker.silent) present.emplace(worker.info.id.value, worker.info.name);
  }
  quarantine_.forget_others(known);
  troubles_.forget_others(known);
  for (const auto& [id, name] : present) {
    if (present_.count(id) == 0) spdlog::info("worker {} ({}) registered", name, id);
  }
  for (const auto& [id, name] : present_) {
    if (present.count(id) == 0) spdlog::warn("worker {} ({}) is lost", name, id);
  }
  present_ = std::move(present);
}

void Coordinator::close() {
  stopping_.request_stop();
  StateLock lock(*this);
  closed_ = true;
  for (auto& [worker, call] : parked_) {
    refuse(lock, call.caller, {core::ErrorCode::kUnavailable, "the coordinator is stopping: try again"});
  }
  parked_.clear();
}

JobRecord* Coordinator::find(const std::string& id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

v1::Job Coordinator::describe_now(const StateLock& lock, const JobRecord& record) const {
  return describe(record, *scheduler_.job({record.spec->id()}, lock.now()));
}

void Coordinator::apply(StateLock& lock, const scheduler::Actions& actions) {
  std::vector<scheduler::Actions> todo{actions};
  std::set<std::string> asked;  // each worker once: leases for one worker are not free for the next
  while (!todo.empty()) {
    const scheduler::Actions next = std::move(todo.back());
    todo.pop_back();
    follow_audits(next);
    for (const scheduler::JobChange& change : next.job_changes) note_change(change);
    for (const std::string& stalled : next.stalled) spdlog::warn("{}", stalled);
    for (const scheduler::WorkerId& worker : next.wake) {
      if (asked.insert(worker.value).second) todo.push_back(top_up(lock, worker.value, false));
    }
  }
}

void Coordinator::note_change(const scheduler::JobChange& change) {
  JobRecord* record = find(change.id.value);
  if (record == nullptr) return;
  ++record->revision;
  record->finished_ms.reset();
  record->unpublished_completion.reset();
  if (change.to == scheduler::JobState::kDone || change.to == scheduler::JobState::kFailed) {
    record->unpublished_completion = record->revision;
    checkpoint_is_awaited_ = true;
  }
  if (is_finished(change.to)) {
    record->finished_ms = std::chrono::duration_cast<std::chrono::milliseconds>(
                              std::chrono::system_clock::now().time_since_epoch())
                              .count();
  }
  spdlog::info("job {} ({}) is {}", change.id.value, record->spec->name(),
               scheduler::job_state_name(change.to));
  if (change.to == scheduler::JobState::kFailed) {
    spdlog::error("job {}: {}", change.id.value, scheduler_.job(change.id, {})->failure);
  }
}

}  // namespace tessera::coordinator
