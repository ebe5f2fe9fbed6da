// SPDX-License-Identifier: Apache-2.0
// Applies the outcome of audits: quarantines workers, clears wrong tiles, and reopens done jobs.
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "server/coordinator/state_lock.hpp"

namespace tessera::coordinator {

namespace {

// A job may have no auditor for a moment between two leases.
constexpr int kChecksUntilSaid = 5;

}  // namespace

// Must run before the accepted items of the same result are added.
void Coordinator::empty_tiles(const scheduler::Actions& actions) {
  for (const scheduler::TileOfJob& dropped : actions.dropped_tiles) {
    spdlog::warn("tile {} of job {} is rendered again: some of it was wrong", dropped.tile,
                 dropped.job.value);
    jobs_.at(dropped.job.value).film->clear(dropped.tile);
  }
}

void Coordinator::follow_audits(const scheduler::Actions& actions) {
  for (const scheduler::TileOfJob& reviewed : actions.reviewed_tiles) {
    const JobRecord* const record = find(reviewed.job.value);
    if (record != nullptr && record->film) record->film->mark_changed(reviewed.tile);
  }
  for (const scheduler::Disproof& disproof : actions.disproved) {
    const scheduler::Producer& producer = disproof.producer;
    if (!quarantine_.quarantined(producer.worker.value, producer.machine, disproof.because)) continue;
    spdlog::error("worker {} ({}) is quarantined: {}. Its other results are verified by others",
                  called(producer), producer.worker.value, disproof.because);
  }
  for (const std::string& contradiction : actions.contradictions) spdlog::warn("{}", contradiction);
  for (const scheduler::JobId& job : actions.reopen) to_reopen_.insert(job.value);
  for (const scheduler::Unaudited& unaudited : actions.unaudited) {
    spdlog::warn(
        "job {}: {} ranges that were chosen to be audited were not: there was no worker of another name",
        unaudited.job.value, unaudited.ranges);
  }
}

// Warns once about each job whose remaining audits no present worker can do.
void Coordinator::note_lack_of_auditors(const StateLock& lock) {
  for (auto& [id, record] : jobs_) {
    const scheduler::JobView view = *scheduler_.job({id}, lock.now());
    const bool waits = view.state == scheduler::JobState::kRunning &&
                       view.samples_done == view.samples_total && view.active_workers == 0;
    record.checks_without_auditor = waits ? record.checks_without_auditor + 1 : 0;
    if (record.checks_without_auditor != kChecksUntilSaid) continue;
    spdlog::warn(
        "job {} ({}) lacks nothing but {} samples to verify: start a worker of another name (--name)", id,
        record.spec->name(), view.samples_to_verify);
  }
}

}  // namespace tessera::coordinator
