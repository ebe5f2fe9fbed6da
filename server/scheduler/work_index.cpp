// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/work_index.hpp"

namespace tessera::scheduler {

WorkIndex::Entry WorkIndex::entry_for(const Job& job, const Producers& producers) {
  if (job.state() != JobState::kRunning) return {};
  const bool has_free = job.free() > 0;
  const bool has_audits = job.audits().any_waiting();
  const bool has_copies = job.may_have_copies();
  if (!job.may_have_another_holder()) return {.limited = has_free || has_audits};
  const JobIndex::Place place{.priority = job.policy().priority,
                              .virtual_finish = job.virtual_finish,
                              .last_served = job.last_served};
  Entry entry;
  if (has_free) entry.free = place;
  if (has_audits && !has_free) {
    entry.audits = place;
    entry.audits->excluded = job.audits().excluded(producers);
  }
  if (has_copies) entry.copies = place;
  return entry;
}

WorkIndex::Entry WorkIndex::entry_of(JobNumber job) const {
  return {free_.place_of(job), audits_.place_of(job), copies_.place_of(job), limited_.contains(job)};
}

void WorkIndex::set(JobNumber job, const Entry& entry) {
  free_.set(job, entry.free);
  audits_.set(job, entry.audits);
  copies_.set(job, entry.copies);
  if (entry.limited) {
    limited_.insert(job);
  } else {
    limited_.erase(job);
  }
}

}  // namespace tessera::scheduler
