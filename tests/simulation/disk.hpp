// SPDX-License-Identifier: Apache-2.0
// What survives a crash of the model's coordinator: rows of jobs, and tiles of films, each by itself. Can
// refuse to write for a while. Keeps the promise about accepted work in mind.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <utility>
#include <vector>

#include "server/scheduler/events.hpp"
#include "tests/simulation/model_film.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

// Accepted work that is older than this when the coordinator crashes is there when it starts again.
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

  // Every write fails until then.
  void refuse(Duration duration);
  bool refuses() const { return world_.now() < refuses_until_; }

  // ---- Writing. False: it was refused, and nothing was written. ----
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
  // All that was accepted before the checkpoint began is written.
  void checkpoint_is_complete() { refused_since_.reset(); }
  // Complains of accepted work that is gone although it should have survived, and strikes the rest that is
  // gone.
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
  // Its first refusal since the last complete checkpoint.
  std::optional<Time> refused_since_;
  std::vector<StoredJob> jobs_;
  std::vector<Accepted> accepted_;
};

}  // namespace tessera::simulation
