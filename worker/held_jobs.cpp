// SPDX-License-Identifier: Apache-2.0
#include "worker/held_jobs.hpp"

#include <algorithm>
#include <utility>

#include "core/base/printable.hpp"
#include "worker/lease_messages.hpp"

namespace tessera::worker {
namespace {

constexpr std::size_t kIdleJobsKept = 16;
constexpr std::size_t kMaxJobs = static_cast<std::size_t>(kMaxLeases) + kIdleJobsKept;
// How long a trouble is reported after it last occurred; it recurs if the job is leased again.
constexpr std::chrono::minutes kTroubleShown{10};

}  // namespace

HeldJobs::Entry* HeldJobs::entry(const std::string& id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second;
}

bool HeldJobs::add(const v1::JobSpec& spec) {
  if (jobs_.size() >= kMaxJobs && !jobs_.contains(spec.job_id())) return false;
  const auto [job, is_new] = jobs_.try_emplace(spec.job_id());
  if (is_new) job->second.spec = spec;
  return is_new;
}

const v1::JobSpec* HeldJobs::find(const std::string& id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : &found->second.spec;
}

void HeldJobs::forget_idle(const IsHeld& is_held) {
  std::size_t idle = 0;
  std::erase_if(jobs_, [&](const auto& job) {
    const bool needed = is_held(job.first) || job.second.stage == Stage::kFetching;
    return !needed && ++idle > kIdleJobsKept;
  });
}

// A fetch continues when the leases of the job have gone to others.
void HeldJobs::report(v1::SynchronizeRequest& request, const IsHeld& is_held) const {
  for (const auto& [id, entry] : jobs_) {
    request.add_known_job_ids(id);
    const bool comes_next = entry.stage == Stage::kWanted && is_held(id);
    if (comes_next || entry.stage == Stage::kFetching) request.add_fetching_job_ids(id);
    if (entry.trouble.empty() || Clock::now() - entry.trouble_at > kTroubleShown) continue;
    v1::Trouble& trouble = *request.add_troubles();
    trouble.set_job_id(id);
    trouble.set_text(core::printable(entry.trouble));
  }
}

bool HeldJobs::begin_fetch(const std::string& id) {
  Entry& job = jobs_.at(id);
  if (job.stage != Stage::kWanted) return false;
  job.stage = Stage::kFetching;
  return true;
}

void HeldJobs::fetched(std::shared_ptr<const Job> job) {
  Entry* const known = entry(job->id);
  if (known == nullptr) return;
  known->stage = Stage::kReady;
  known->job = std::move(job);
}

Duration HeldJobs::next_delay(Entry& entry) const {
  Duration delay = delays_.first;
  for (int i = 0; i < entry.failures && delay < delays_.longest; ++i) delay *= 2;
  ++entry.failures;
  return std::min(delay, delays_.longest);
}

void HeldJobs::make_unusable(const std::string& id, const std::string& trouble,
                             const std::string& decline_reason) {
  Entry* const job = entry(id);
  if (job == nullptr) return;
  job->stage = Stage::kUnusable;
  job->job.reset();
  job->decline_reason = decline_reason;
  job->trouble = trouble;
  job->trouble_at = Clock::now();
  job->give_back_at = Clock::now() + next_delay(*job);
}

void HeldJobs::rendered(const std::string& id) {
  Entry* const job = entry(id);
  if (job == nullptr) return;
  job->failures = 0;
  job->trouble.clear();
}

void HeldJobs::given_back(const std::string& id) {
  Entry* const job = entry(id);
  if (job != nullptr && job->stage == Stage::kUnusable) job->stage = Stage::kWanted;
}

std::shared_ptr<const Job> HeldJobs::ready(const std::string& id) const {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : found->second.job;
}

std::vector<std::shared_ptr<const Job>> HeldJobs::in_hand(const IsHeld& is_held) const {
  std::vector<std::shared_ptr<const Job>> jobs;
  for (const auto& [id, entry] : jobs_)
    if (entry.job && is_held(id)) jobs.push_back(entry.job);
  return jobs;
}

bool HeldJobs::is_unusable(const std::string& id) const {
  const auto found = jobs_.find(id);
  return found != jobs_.end() && found->second.stage == Stage::kUnusable;
}

}  // namespace tessera::worker
