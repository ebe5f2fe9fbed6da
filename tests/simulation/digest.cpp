// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/digest.hpp"

namespace tessera::simulation {

using namespace scheduler;

void Digest::add(std::uint64_t number) {
  // A step of splitmix64 (Steele et al. 2014).
  hash_ += number + 0x9e3779b97f4a7c15;
  hash_ = (hash_ ^ hash_ >> 30) * 0xbf58476d1ce4e5b9;
  hash_ = (hash_ ^ hash_ >> 27) * 0x94d049bb133111eb;
  hash_ ^= hash_ >> 31;
}

void Digest::add(std::string_view text) {
  add(text.size());
  for (const char c : text) add(static_cast<std::uint64_t>(static_cast<unsigned char>(c)));
}

void Digest::add(const WorkItem& item) {
  add(static_cast<std::uint64_t>(item.tile));
  add(std::uint64_t{item.samples.begin} << 32 | item.samples.end);
}

void Digest::add(const TileOfJob& tile) {
  add(tile.job.value);
  add(static_cast<std::uint64_t>(tile.tile));
}

void Digest::add(const Reply& reply) {
  add(std::uint64_t{reply.changed});
  add(static_cast<std::uint64_t>(reply.heartbeat_timeout.count()));
  add(reply.leases.size());
  for (const LeaseDescription& lease : reply.leases) {
    add(lease.id.value);
    add(lease.job.value);
    add(lease.token);
    for (const WorkItem& item : lease.items) add(item);
  }
}

void Digest::add(const Event& event, Time time, const Actions& actions) {
  add(event.index());
  add(static_cast<std::uint64_t>(time.time_since_epoch().count()));
  add(actions.status ? std::string_view{} : std::string_view{actions.status.error().message});
  if (actions.reply) add(*actions.reply);
  for (const Verdict verdict : actions.verdicts) add(static_cast<std::uint64_t>(verdict));
  for (const JobChange& change : actions.job_changes) {
    add(change.id.value);
    add(static_cast<std::uint64_t>(change.from) << 8 | static_cast<std::uint64_t>(change.to));
  }
  for (const Disproof& disproof : actions.disproved) add(disproof.because);
  for (const TileOfJob& tile : actions.dropped_tiles) add(tile);
  for (const TileOfJob& tile : actions.reviewed_tiles) add(tile);
  for (const JobId& job : actions.reopen) add(job.value);
  for (const std::string& contradiction : actions.contradictions) add(contradiction);
  for (const Unaudited& job : actions.unaudited) {
    add(job.job.value);
    add(job.ranges);
  }
  for (const std::string& stalled : actions.stalled) add(stalled);
  for (const WorkerId& worker : actions.wake) add(worker.value);
}

}  // namespace tessera::simulation
