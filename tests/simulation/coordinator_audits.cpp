// SPDX-License-Identifier: Apache-2.0
// How the model's coordinator handles dishonest workers.
#include <algorithm>

#include "tests/simulation/coordinator.hpp"

namespace tessera::simulation {

using namespace scheduler;

namespace {

constexpr int kRejectionsUntilQuarantine = 3;

}  // namespace

void Coordinator::empty_tiles(const Actions& actions) {
  for (const TileOfJob& dropped : actions.dropped_tiles) {
    world_.note(fmt::format("tile {} of job {} is dropped", dropped.tile, dropped.job.value));
    films_.at(dropped.job).clear(dropped.tile);
    disk_.dropped(dropped.job, dropped.tile);
  }
}

void Coordinator::follow_audits(const Actions& actions) {
  for (const Disproof& disproof : actions.disproved) {
    world_.note(fmt::format("{} is quarantined: {}", called(disproof.producer), disproof.because));
    if (!is_expected_liar(disproof.producer.worker))
      world_.fail(
          fmt::format("{} is honest, but was quarantined: {}", called(disproof.producer), disproof.because));
    quarantine_.add(disproof.producer);
  }
  for (const std::string& contradiction : actions.contradictions) world_.note(contradiction);
  for (const Unaudited& job : actions.unaudited) {
    world_.note(fmt::format("job {} is done with {} ranges unaudited", job.job.value, job.ranges));
    if (clock_error_ > Duration::zero()) unaudited_.insert(job.job);
  }
  for (const JobId& job : actions.reopen) {
    if (to_reopen_.insert(job).second) reopen_later(job);
  }
}

// A worker's id contains its host's name.
bool Coordinator::is_expected_liar(const WorkerId& worker) const {
  return is_liar(worker) || std::any_of(liars_.begin(), liars_.end(), [&](const std::string& host) {
           return worker.value.find("." + host + ".") != std::string::npos;
         });
}

// The film of a done job must be read back first.
void Coordinator::reopen_later(const JobId& job) {
  world_.after(seconds(world_.random.real(0, 2)), [this, job, run = run_] {
    const auto reopen = [this, job, run] {
      if (up() && run == run_ && to_reopen_.erase(job) > 0) handle(ReopenJob{job});
    };
    if (up() && run == run_ && !delayed(reopen)) reopen();
  });
}

std::optional<WorkerInfo> Coordinator::registered(const WorkerId& worker) const {
  const WorkerInfo* const info = scheduler_->worker_info(worker);
  return info == nullptr ? std::nullopt : std::optional(*info);
}

// Its principal may have been quarantined since its last call, for another worker.
bool Coordinator::is_refused(const WorkerInfo& worker) {
  const bool is_registered = registered(worker.id).has_value();
  if (!quarantine_.refuses(producer_of(worker), is_registered)) return false;
  if (is_registered) handle(Dismiss{worker.id});
  return true;
}

bool Coordinator::is_refused(const SubmitResult& result) const {
  const auto known = registered(result.worker);
  return quarantine_.refuses(known ? producer_of(*known) : Producer{{}, result.worker, {}, result.principal},
                             known.has_value());
}

bool Coordinator::is_foreign(const WorkerId& worker, const std::string& principal) const {
  const auto owner = owners_.find(worker);
  return owner != owners_.end() && owner->second.principal != principal;
}

void Coordinator::check_quarantined() {
  for (const WorkerView& worker : workers())
    if (worker.held_leases > 0 && quarantine_.has(worker.info.id))
      world_.fail(fmt::format("worker {} is quarantined, and holds leases", worker.info.id.value));
}

// Only in farms with audits, as in real ones. Results of unregistered workers count against nobody.
void Coordinator::note_refusal(const WorkerId& worker) {
  if (options_.audit_share == 0 || !is_liar(worker) || !registered(worker)) return;
  if (++refused_ % kRejectionsUntilQuarantine != 0) return;
  quarantined({kLiar, worker, kLiar});
}

void Coordinator::quarantined(const Producer& producer) {
  world_.note(fmt::format("{} is quarantined", called(producer)));
  referee_.expect_audits();
  handle(Dismiss{producer.worker, true});
  quarantine_.add(producer);
}

// If everything is audited, and honest workers of at least two names are present, no wrong sample remains;
// unless the clock jumps so far that the coordinator stops waiting for auditors. Of quarantined workers and
// principals none ever does.
void Coordinator::check_bits() {
  for (const JobView& job : jobs()) {
    if (job.state != JobState::kDone) continue;
    const bool is_audited = options_.audit_share >= 1 && !unaudited_.contains(job.id);
    for (const auto& [tile, spoilers] : films_.at(job.id).spoilt()) {
      const bool any_quarantined = std::any_of(spoilers.begin(), spoilers.end(), [&](const WorkerId& worker) {
        const auto owner = owners_.find(worker);
        return quarantine_.covers(owner == owners_.end() ? Producer{{}, worker} : owner->second);
      });
      if (is_audited || any_quarantined)
        world_.fail(fmt::format("job {} is done, with wrong bits in tile {}", job.id.value, tile));
    }
  }
}

}  // namespace tessera::simulation
