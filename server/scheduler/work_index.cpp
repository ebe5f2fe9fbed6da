// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/work_index.hpp"

#include <limits>

namespace tessera::scheduler {

namespace {

JobIndex::Place place_for(const Job& job) {
  return {.priority = job.policy().priority,
          .virtual_finish = job.virtual_finish,
          .last_served = job.last_served};
}

}  // namespace

WorkIndex::Entry WorkIndex::entry_for(const Job& job, const Producers& producers) {
  if (job.state() != JobState::kRunning) return {};
  const bool has_free = job.free() > 0;
  const bool has_audits = job.audits().any_waiting();
  const bool has_copies = job.may_have_copies();
  if (!job.may_have_another_holder()) return {.limited = has_free || has_audits};
  const JobIndex::Place place = place_for(job);
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

WorkIndex::Rank WorkIndex::rank_of(JobNumber job, const JobIndex::Place& place) {
  return {-std::int64_t{place.priority}, place.virtual_finish, place.last_served, job};
}

std::size_t WorkIndex::served_before(const Job& job) const {
  return free_ranks_.order_of_key(rank_of(job.number(), place_for(job)));
}

std::size_t WorkIndex::of_higher_priority(const Job& job) const {
  constexpr double kFirst = -std::numeric_limits<double>::infinity();
  return free_ranks_.order_of_key(Rank{-std::int64_t{job.policy().priority}, kFirst, 0, 0});
}

void WorkIndex::set(JobNumber job, const Entry& entry) {
  const std::optional<JobIndex::Place> before = free_.place_of(job);
  if (before != entry.free) {
    if (before) free_ranks_.erase(rank_of(job, *before));
    if (entry.free) free_ranks_.insert(rank_of(job, *entry.free));
  }
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
