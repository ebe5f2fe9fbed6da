// SPDX-License-Identifier: Apache-2.0
#include "server/scheduler/reviews.hpp"

namespace tessera::scheduler {
namespace {

// To look at a job costs as much as so many of its tiles.
constexpr int kTilesPerJob = 64;

}  // namespace

void Reviews::distrust(const Producer& producer, Actions& actions) {
  farm_.producers.distrust(producer);
  actions.distrusted.push_back(producer);
  if (Worker* const worker = farm_.registry.find(producer.worker)) leases_.end_all(*worker);
  farm_.reviews.add_all(farm_.last_job_number);
  advance(actions);
}

void Reviews::advance(Actions& actions) {
  while (!farm_.reviews.empty() && farm_.step.left.searched_tiles > 0) {
    ReviewQueue::Position position = farm_.reviews.next();
    const auto found = farm_.jobs.lower_bound(position.job);
    if (found == farm_.jobs.end()) {
      farm_.reviews.finish(position.reopened, std::nullopt);
      continue;
    }
    if (found->first != position.job) position = {.job = found->first, .tile = 0};
    farm_.touched.insert(found->first);
    const bool is_finished = review(found->second, position, actions);
    farm_.step.left.searched_tiles -= kTilesPerJob;
    if (is_finished) {
      farm_.reviews.finish(position.reopened, position.job);
      finish(found->second, position.reopened, actions);
    } else {
      farm_.reviews.continue_at(position);
    }
  }
}

// Advances the position. Whether that was the job's last tile. Done jobs run again only when their films are
// in memory: these are only reported.
bool Reviews::review(Job& job, ReviewQueue::Position& position, Actions& actions) {
  const bool only_look = job.state() == JobState::kDone && !position.reopened;
  const Ledger& ledger = job.audits().ledger();
  for (int tile = ledger.next_tile(position.tile); tile < ledger.tile_count();
       tile = ledger.next_tile(tile + 1)) {
    position.tile = tile;
    if (farm_.step.left.searched_tiles <= 0) return false;
    --farm_.step.left.searched_tiles;
    if (only_look) {
      if (!job.audits().has_doubtful(tile, farm_.producers)) continue;
      actions.reopen.push_back(job.id());
      return true;
    }
    if (!job.doubt(tile, farm_.producers)) continue;
    actions.reviewed_tiles.push_back({job.id(), tile});
    farm_.step.work_appeared = true;
  }
  return true;
}

void Reviews::finish(Job& job, bool reopened, Actions& actions) {
  if (job.state() == JobState::kRunning && farm_.settled(job)) jobs_.become(job, JobState::kDone, actions);
  if (reopened && job.state() == JobState::kDone && !farm_.settled(job))
    jobs_.become(job, JobState::kRunning, actions);
}

Worker* Reviews::on(const Distrust& event, Actions& actions) {
  distrust(event.producer, actions);
  return nullptr;
}

Worker* Reviews::on(const Trust& event, Actions&) {
  farm_.producers.trust(event.producer);
  farm_.step.work_appeared = true;
  return nullptr;
}

}  // namespace tessera::scheduler
