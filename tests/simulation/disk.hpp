// SPDX-License-Identifier: Apache-2.0
// The durable state of the model's coordinator: rows of jobs, and tiles of films, each written separately.
// Can fail writes for a while. Checks the promise about accepted work.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/events.hpp"
#include "server/scheduler/views.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

// Work that was accepted earlier than this before a crash of the coordinator survives it.
inline constexpr double kPromisedSeconds = 2.0;

struct JobRow {
  scheduler::JobShape shape;
  int priority = 0;
  std::uint32_t max_workers = 0;
  scheduler::JobState state = scheduler::JobState::kRunning;
  std::string failure;
  // Of two copies, the later one has the higher number.
  std::uint64_t revision = 0;
};

inline bool is_stored_as(const JobRow& row, const scheduler::JobView& job) {
  return row.state == job.state && row.shape == job.shape && row.priority == job.priority &&
         row.max_workers == job.max_workers;
}

class Disk {
 public:
  struct StoredJob {
    scheduler::JobId id;
    JobRow row;
    ModelFilm film;
    // By tile.
    std::map<int, std::vector<scheduler::ProducedItem>> provenance;
  };

  explicit Disk(World& world) : world_(world) {}

  // Fails every write during this time.
  void refuse(Duration duration);
  bool refuses() const { return world_.now() < refuses_until_; }

  // ---- Writes. False: the write failed and changed nothing. ----
  bool insert(const scheduler::JobId& id, const JobRow& row);
  // An older copy changes nothing.
  bool update(const scheduler::JobId& id, const JobRow& row);
  bool write_tile(const scheduler::JobId& id, int tile, const ModelFilm& content,
                  const std::vector<scheduler::ProducedItem>& provenance);
  bool remove(const scheduler::JobId& id);

  // In the order of submission.
  const std::vector<StoredJob>& jobs() const { return jobs_; }
  const StoredJob* stored(const scheduler::JobId& id) const;

  // ---- The promise ----
  void accepted(const scheduler::JobId& job, const scheduler::WorkItem& item);
  // The tile's samples were found to be wrong.
  void dropped(const scheduler::JobId& job, int tile);
  // Everything that was accepted before the start of the checkpoint is written.
  void checkpoint_is_complete() { refused_since_.reset(); }
  // Reports accepted work that is lost although it should have survived, and forgets other lost work.
  void coordinator_crashed();

 private:
  struct Accepted {
    Time time;
    scheduler::JobId job;
    scheduler::WorkItem item;
  };

  StoredJob* find(const scheduler::JobId& id);
  bool written();

  World& world_;
  Time refuses_until_{};
  // The first failed write since the last complete checkpoint.
  std::optional<Time> refused_since_;
  std::vector<StoredJob> jobs_;
  std::vector<Accepted> accepted_;
};

}  // namespace tessera::simulation
