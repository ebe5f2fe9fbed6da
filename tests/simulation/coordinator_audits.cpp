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
    workers_aside_.insert(disproof.producer.worker);
    if (!disproof.producer.machine.empty()) machines_aside_.insert(disproof.producer.machine);
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

bool Coordinator::is_refused(const WorkerInfo& worker) const {
  if (workers_aside_.contains(worker.id)) return true;
  const auto known = workers();
  const auto is_it = [&](const WorkerView& each) { return each.info.id == worker.id; };
  return machines_aside_.contains(worker.machine) && std::none_of(known.begin(), known.end(), is_it);
}

// Only in farms with audits, as in real ones.
void Coordinator::note_refusal(const WorkerId& worker) {
  if (options_.audit_share == 0 || !is_liar(worker) || ++refused_ % kRejectionsUntilQuarantine != 0) return;
  quarantined({kLiar, worker, kLiar});
}

void Coordinator::quarantined(const Producer& producer) {
  world_.note(fmt::format("{} is quarantined", called(producer)));
  workers_aside_.insert(producer.worker);
  machines_aside_.insert(producer.machine);
  referee_.expect_audits();
  handle(Dismiss{producer.worker, true});
}

// If everything is audited, and honest workers of at least two names are present, no wrong sample remains;
// unless the clock jumps so far that the coordinator stops waiting for auditors.
void Coordinator::check_bits() {
  if (options_.audit_share < 1) return;
  for (const JobView& job : jobs()) {
    const std::optional<int> spoilt = films_.at(job.id).spoilt_tile();
    if (job.state == JobState::kDone && spoilt && !unaudited_.contains(job.id))
      world_.fail(fmt::format("job {} is done, with wrong bits in tile {}", job.id.value, *spoilt));
  }
}

}  // namespace tessera::simulation
