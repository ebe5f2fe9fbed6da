// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/disk.hpp"

#include <algorithm>

namespace tessera::simulation {

using namespace scheduler;

void Disk::refuse(Duration duration) {
  world_.note(
      fmt::format("the disk refuses to write for {:.1f} s", std::chrono::duration<double>(duration).count()));
  refuses_until_ = world_.now() + duration;
}

bool Disk::written() {
  if (!refuses()) return true;
  if (!refused_since_) refused_since_ = world_.now();
  return false;
}

bool Disk::insert(const JobId& id, const JobRow& row) {
  if (!written()) return false;
  jobs_.push_back({id, row, ModelFilm(row.shape), {}});
  return true;
}

bool Disk::update(const JobId& id, const JobRow& row) {
  StoredJob* const job = find(id);
  if (job == nullptr || !written()) return false;
  if (row.revision < job->row.revision) return true;
  job->row = row;
  job->film.extend(row.shape);
  return true;
}

bool Disk::write_tile(const JobId& id, int tile, const ModelFilm& content,
                      const std::vector<ProducedItem>& provenance) {
  if (!written()) return false;
  StoredJob* const job = find(id);
  if (job == nullptr) return true;
  job->film.copy_tile(tile, content);
  job->provenance[tile] = provenance;
  return true;
}

void Disk::dropped(const JobId& job, int tile) {
  std::erase_if(accepted_,
                [&](const Accepted& entry) { return entry.job == job && entry.item.tile == tile; });
}

bool Disk::remove(const JobId& id) {
  if (!written()) return false;
  std::erase_if(jobs_, [&](const StoredJob& job) { return job.id == id; });
  std::erase_if(accepted_, [&](const Accepted& entry) { return entry.job == id; });
  return true;
}

Disk::StoredJob* Disk::find(const JobId& id) {
  const auto found =
      std::find_if(jobs_.begin(), jobs_.end(), [&](const StoredJob& job) { return job.id == id; });
  return found == jobs_.end() ? nullptr : &*found;
}

const Disk::StoredJob* Disk::stored(const JobId& id) const {
  const auto found =
      std::find_if(jobs_.begin(), jobs_.end(), [&](const StoredJob& job) { return job.id == id; });
  return found == jobs_.end() ? nullptr : &*found;
}

void Disk::accepted(const JobId& job, const WorkItem& item) {
  accepted_.push_back({world_.now(), job, item});
}

void Disk::coordinator_crashed() {
  const Time until =
      std::min(world_.now(), refused_since_.value_or(world_.now())) - seconds(kPromisedSeconds);
  const auto lost = [&](const Accepted& entry) {
    const StoredJob* const job = find(entry.job);
    if (job != nullptr && job->film.has(entry.item)) return false;
    if (entry.time <= until) {
      world_.fail(fmt::format("job {} tile {} samples [{}, {}) were accepted {:.3f} s ago and are lost",
                              entry.job.value, entry.item.tile, entry.item.samples.begin,
                              entry.item.samples.end,
                              std::chrono::duration<double>(world_.now() - entry.time).count()));
    }
    return true;
  };
  std::erase_if(accepted_, lost);
  refused_since_.reset();
}

}  // namespace tessera::simulation
