// SPDX-License-Identifier: Apache-2.0
#include "proto/state_text.hpp"

#include <fmt/format.h>

#include <algorithm>

namespace tessera::proto {

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

std::string worker_state(const v1::Worker& worker) {
  if (worker.quarantined()) return "quarantined";
  if (worker.silent()) return "silent";
  if (worker.drain_requested()) return worker.held_leases() > 0 ? "draining" : "drained";
  if (worker.draining()) return "leaving";
  if (worker.stuck()) return "stuck";
  if (worker.cooldowns().empty()) return worker.held_leases() > 0 ? "working" : "idle";
  const bool only_fetches = std::all_of(worker.cooldowns().begin(), worker.cooldowns().end(),
                                        [](const auto& cooldown) { return cooldown.fetching(); });
  return only_fetches ? "fetching" : "in cooldown";
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
