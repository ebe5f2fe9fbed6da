// SPDX-License-Identifier: Apache-2.0
#include "proto/state_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tessera::proto {

namespace {

// From the first one after the unspecified one to the last.
template <typename State>
std::map<std::string, State> states_by_name(State last) {
  std::map<std::string, State> states;
  for (int state = 1; state <= last; ++state)
    states[state_name(static_cast<State>(state))] = static_cast<State>(state);
  return states;
}

}  // namespace

std::string short_id(const std::string& id) {
  return id.substr(0, 12);
}

std::string state_name(v1::JobState state) {
  switch (state) {
    case v1::JOB_STATE_VALIDATING:
      return "validating";
    case v1::JOB_STATE_RUNNING:
      return "running";
    case v1::JOB_STATE_PAUSED:
      return "paused";
    case v1::JOB_STATE_DONE:
      return "done";
    case v1::JOB_STATE_CANCELLED:
      return "cancelled";
    case v1::JOB_STATE_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

std::string event_name(v1::JobEvent::Kind kind) {
  switch (kind) {
    case v1::JobEvent::KIND_SUBMITTED:
      return "submitted";
    case v1::JobEvent::KIND_VALIDATED:
      return "validated";
    case v1::JobEvent::KIND_STARTED:
      return "started";
    case v1::JobEvent::KIND_PAUSED:
      return "paused";
    case v1::JobEvent::KIND_RESUMED:
      return "resumed";
    case v1::JobEvent::KIND_EXTENDED:
      return "extended";
    case v1::JobEvent::KIND_DONE:
      return "done";
    case v1::JobEvent::KIND_CANCELLED:
      return "cancelled";
    case v1::JobEvent::KIND_FAILED:
      return "failed";
    default:
      return "unknown";
  }
}

bool is_queued(const v1::Job& job) {
  return job.state() == v1::JOB_STATE_RUNNING && job.active_workers() == 0 && job.queue_position() > 0;
}

v1::WorkerState state_of(const v1::Worker& worker) {
  const bool has_leases = worker.held_leases() > 0;
  if (worker.quarantined()) return v1::WORKER_STATE_QUARANTINED;
  if (worker.silent()) return v1::WORKER_STATE_SILENT;
  if (worker.drain_requested()) return has_leases ? v1::WORKER_STATE_DRAINING : v1::WORKER_STATE_DRAINED;
  if (worker.draining()) return v1::WORKER_STATE_LEAVING;
  if (worker.stuck()) return v1::WORKER_STATE_STUCK;
  if (worker.cooldowns().empty()) return has_leases ? v1::WORKER_STATE_WORKING : v1::WORKER_STATE_IDLE;
  const bool only_fetches = std::all_of(worker.cooldowns().begin(), worker.cooldowns().end(),
                                        [](const auto& cooldown) { return cooldown.fetching(); });
  return only_fetches ? v1::WORKER_STATE_FETCHING : v1::WORKER_STATE_IN_COOLDOWN;
}

std::string state_name(v1::WorkerState state) {
  switch (state) {
    case v1::WORKER_STATE_QUARANTINED:
      return "quarantined";
    case v1::WORKER_STATE_SILENT:
      return "silent";
    case v1::WORKER_STATE_DRAINING:
      return "draining";
    case v1::WORKER_STATE_DRAINED:
      return "drained";
    case v1::WORKER_STATE_LEAVING:
      return "leaving";
    case v1::WORKER_STATE_STUCK:
      return "stuck";
    case v1::WORKER_STATE_FETCHING:
      return "fetching";
    case v1::WORKER_STATE_IN_COOLDOWN:
      return "in cooldown";
    case v1::WORKER_STATE_WORKING:
      return "working";
    case v1::WORKER_STATE_IDLE:
      return "idle";
    default:
      return "unknown";
  }
}

std::map<std::string, v1::JobState> job_states_by_name() {
  return states_by_name<v1::JobState>(v1::JobState_MAX);
}

std::map<std::string, v1::WorkerState> worker_states_by_name() {
  return states_by_name<v1::WorkerState>(v1::WorkerState_MAX);
}

std::vector<std::string> worker_remarks(const v1::Worker& worker) {
  std::vector<std::string> remarks;
  if (!worker.quarantine_reason().empty()) remarks.push_back("is quarantined: " + worker.quarantine_reason());
  if (worker.stuck())
    remarks.push_back("still renders a lease that it lost, and gets no other until it is finished with it");
  for (const auto& cooldown : worker.cooldowns()) {
    remarks.push_back(fmt::format(
        "gets no lease of job {} {}", short_id(cooldown.job_id()),
        cooldown.fetching()
            ? "until it has fetched its scene"
            : fmt::format("for {} s, or until it delivers some of it", cooldown.remaining().seconds())));
  }
  for (const std::string& trouble : worker.troubles()) remarks.push_back("says: " + trouble);
  return remarks;
}

std::optional<double> seconds_left(const v1::Job& job) {
  if (job.state() != v1::JOB_STATE_RUNNING || !(job.samples_per_second() > 0)) return std::nullopt;
  const std::uint64_t done = std::min(job.samples_done(), job.samples_total());
  const double left = static_cast<double>(job.samples_total() - done) +  //
                      static_cast<double>(job.samples_to_verify());
  return left / job.samples_per_second();
}

}  // namespace tessera::proto
