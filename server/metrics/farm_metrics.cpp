// SPDX-License-Identifier: Apache-2.0
// Jobs, workers and results.
#include <array>
#include <limits>
#include <string>

#include "server/metrics/histogram.hpp"
#include "server/metrics/parts.hpp"

namespace tessera::metrics {

namespace {

// The time that the farm needs for what running jobs lack, at its present speed.
double backlog_seconds(const scheduler::Totals& totals) {
  const double samples = static_cast<double>(totals.missing_samples + totals.samples_to_verify);
  if (samples == 0) return 0;
  if (totals.samples_per_second > 0) return samples / totals.samples_per_second;
  return std::numeric_limits<double>::infinity();
}

}  // namespace

void write_jobs(common::MetricWriter& writer, const farm::Totals& totals) {
  const scheduler::Totals& farm = totals.scheduler;
  writer.begin_gauge("tessera_jobs", "Jobs in memory by state");
  writer.add(static_cast<double>(totals.validating_jobs), {{"state", "validating"}});
  for (std::size_t i = 0; i < farm.jobs.size(); ++i)
    writer.add(static_cast<double>(farm.jobs[i]),
               {{"state", std::string(job_state_name(static_cast<scheduler::JobState>(i)))}});
  writer.begin_counter("tessera_jobs_ended_total", "Jobs that have ended, by how they ended");
  for (const auto state :
       {scheduler::JobState::kDone, scheduler::JobState::kCancelled, scheduler::JobState::kFailed}) {
    const auto at = static_cast<std::size_t>(state);
    writer.add(static_cast<double>(farm.counts.job_changes[at] + totals.ended_unvalidated[at]),
               {{"state", std::string(job_state_name(state))}});
  }
  writer.gauge("tessera_backlog_samples", "Pixel samples that running jobs lack, and those to be verified",
               static_cast<double>(farm.missing_samples + farm.samples_to_verify));
  writer.gauge("tessera_backlog_seconds",
               "Time for the backlog at the present speed; infinite while nothing is rendered",
               backlog_seconds(farm));
  writer.gauge("tessera_samples_per_second", "Pixel samples accepted per second, over the last seconds",
               farm.samples_per_second);
  writer.counter("tessera_samples_accepted_total", "Pixel samples accepted",
                 static_cast<double>(farm.counts.accepted_samples));
}

void write_workers(common::MetricWriter& writer, const farm::Totals& totals) {
  const scheduler::Totals& farm = totals.scheduler;
  writer.begin_gauge("tessera_workers", "Registered workers by what they do");
  for (std::size_t i = 0; i < farm.workers.size(); ++i)
    writer.add(static_cast<double>(farm.workers[i]),
               {{"state", std::string(worker_activity_name(static_cast<scheduler::WorkerActivity>(i)))}});
  writer.gauge("tessera_quarantined_workers", "Workers in quarantine, registered or not",
               static_cast<double>(totals.quarantined_workers));
  writer.gauge("tessera_waiting_workers", "Workers whose heartbeat waits for an answer",
               static_cast<double>(totals.waiting_calls));
  writer.begin_counter("tessera_leases_granted_total",
                       "Leases granted, and leases taken over from an earlier run or a lost worker");
  writer.add(static_cast<double>(farm.counts.granted_leases), {{"kind", "new"}});
  writer.add(static_cast<double>(farm.counts.adopted_leases), {{"kind", "adopted"}});
  writer.begin_counter("tessera_leases_ended_total", "Leases that have ended, by how they ended");
  for (std::size_t i = 0; i < farm.counts.ended_leases.size(); ++i) {
    const auto state = static_cast<scheduler::LeaseState>(i);
    if (is_live(state)) continue;
    writer.add(static_cast<double>(farm.counts.ended_leases[i]),
               {{"state", std::string(lease_state_name(state))}});
  }
}

void write_results(common::MetricWriter& writer, const farm::Totals& totals,
                   const dispatch::ResultCounts& counts) {
  const scheduler::EventCounts& events = totals.scheduler.counts;
  writer.begin_counter("tessera_result_items_total", "Items of results by what became of them");
  writer.add(static_cast<double>(events.accepted_items), {{"verdict", "accepted"}});
  writer.add(static_cast<double>(events.audited_items), {{"verdict", "audited"}});
  writer.add(static_cast<double>(events.dropped_items + counts.items_of_unknown_jobs()),
             {{"verdict", "dropped"}});
  writer.begin_counter("tessera_results_rejected_total", "Results that were rejected as a whole, by reason");
  for (std::size_t i = 0; i < dispatch::kRejectionReasons; ++i) {
    const auto reason = static_cast<dispatch::RejectedFor>(i);
    writer.add(static_cast<double>(counts.rejected(reason)),
               {{"reason", std::string(dispatch::rejection_name(reason))}});
  }
}

void write_state_lock(common::MetricWriter& writer, const farm::Farm& farm) {
  writer.begin_histogram("tessera_state_lock_hold_seconds",
                         "How long the state lock was held, each time; all calls wait for it");
  writer.add(to_prometheus(farm.lock_holds()));
}

void write_first_samples(common::MetricWriter& writer, const farm::Farm& farm) {
  writer.begin_histogram("tessera_first_samples_seconds",
                         "Time from the submission of a job until its first samples were counted");
  writer.add(to_prometheus(farm.first_samples()));
}

}  // namespace tessera::metrics
