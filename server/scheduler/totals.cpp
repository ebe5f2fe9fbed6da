// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/totals.hpp"

namespace tessera::scheduler {

JobTotals::Share JobTotals::share_of(const Job& job) {
  if (job.state() != JobState::kRunning) return {.state = job.state()};
  return {.state = job.state(),
          .missing_samples = job.total() - job.done(),
          .samples_to_verify = job.to_verify()};
}

void JobTotals::update(const Job& job) {
  const Share now = share_of(job);
  const auto [known, is_new] = shares_.try_emplace(job.number(), now);
  if (!is_new) subtract(known->second);
  known->second = now;
  add(now);
}

void JobTotals::remove(JobNumber job) {
  const auto known = shares_.find(job);
  if (known == shares_.end()) return;
  subtract(known->second);
  shares_.erase(known);
}

bool JobTotals::counts(JobNumber job, const Share& share) const {
  const auto known = shares_.find(job);
  return known != shares_.end() && known->second == share;
}

void JobTotals::add(const Share& share) {
  ++jobs_[static_cast<std::size_t>(share.state)];
  missing_samples_ += share.missing_samples;
  samples_to_verify_ += share.samples_to_verify;
}

void JobTotals::subtract(const Share& share) {
  --jobs_[static_cast<std::size_t>(share.state)];
  missing_samples_ -= share.missing_samples;
  samples_to_verify_ -= share.samples_to_verify;
}

void JobTotals::write_to(Totals& totals) const {
  totals.jobs = jobs_;
  totals.missing_samples = missing_samples_;
  totals.samples_to_verify = samples_to_verify_;
}

}  // namespace tessera::scheduler
