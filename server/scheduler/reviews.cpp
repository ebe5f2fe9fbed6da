// SPDX-License-Identifier: Apache-2.0
// Distrust: finds the unverified samples of distrusted workers, some tiles with each event.
#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {
namespace {

// To look at a job costs as much as so many of its tiles.
constexpr int kTilesPerJob = 64;

}  // namespace

void Scheduler::distrust(const Producer& producer, Actions& actions) {
  producers_.distrust(producer);
  actions.distrusted.push_back(producer);
  if (Worker* const worker = registry_.find(producer.worker)) end_all_leases(*worker);
  reviews_.add_all(last_job_number_);
  review_jobs(actions);
}

void Scheduler::review_jobs(Actions& actions) {
  while (!reviews_.empty() && left_.searched_tiles > 0) {
    ReviewQueue::Position position = reviews_.next();
    const auto found = jobs_.lower_bound(position.job);
    if (found == jobs_.end()) {
      reviews_.finish(position.reopened, std::nullopt);
      continue;
    }
    if (found->first != position.job) position = {.job = found->first, .tile = 0};
    touched_.insert(found->first);
    const bool is_finished = review(found->second, position, actions);
    left_.searched_tiles -= kTilesPerJob;
    if (is_finished) {
      reviews_.finish(position.reopened, position.job);
      finish_review(found->second, position.reopened, actions);
    } else {
      reviews_.continue_at(position);
    }
  }
}

// Advances the position. Whether that was the job's last tile. Done jobs run again only when their films are
// in memory: these are only reported.
bool Scheduler::review(Job& job, ReviewQueue::Position& position, Actions& actions) {
  const bool only_look = job.state() == JobState::kDone && !position.reopened;
  const Ledger& ledger = job.audits().ledger();
  for (int tile = ledger.next_tile(position.tile); tile < ledger.tile_count();
       tile = ledger.next_tile(tile + 1)) {
    position.tile = tile;
    if (left_.searched_tiles <= 0) return false;
    --left_.searched_tiles;
    if (only_look) {
      if (!job.audits().has_doubtful(tile, producers_)) continue;
      actions.reopen.push_back(job.id());
      return true;
    }
    if (!job.doubt(tile, producers_)) continue;
    actions.reviewed_tiles.push_back({job.id(), tile});
    work_appeared_ = true;
  }
  return true;
}

void Scheduler::finish_review(Job& job, bool reopened, Actions& actions) {
  if (job.state() == JobState::kRunning && settled(job)) become(job, JobState::kDone, actions);
  if (reopened && job.state() == JobState::kDone && !settled(job)) become(job, JobState::kRunning, actions);
}

}  // namespace tessera::scheduler
