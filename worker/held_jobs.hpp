// SPDX-License-Identifier: Apache-2.0
// The jobs of a worker's leases, and the state of each until its leases are rendered. Not thread-safe;
// guarded by LeaseTracker.
//
//   WANTED ──begin_fetch──▶ FETCHING ──fetched──▶ READY ──scene cannot be built──▶ UNUSABLE
//      │  ◀─────────────────────────── lease given back ──────────────────────────── ▲
//      └──────────────── files cannot be fetched, or are too large ──────────────────┘
//
// Leases of an unusable job are given back after a delay that grows with every failure, since the coordinator
// may lease the job to this worker again.
#pragma once

#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

#include "tessera/v1/worker_service.pb.h"
#include "worker/held_lease.hpp"
#include "worker/job.hpp"

namespace tessera::worker {

class HeldJobs {
 public:
  using Clock = std::chrono::steady_clock;
  // How long a lease of an unusable job is kept before it is given back: after the first failure, and at
  // most.
  struct Delays {
    Duration first = std::chrono::seconds(1), longest = std::chrono::seconds(30);
  };
  // Whether a lease of the job is held.
  using IsHeld = std::function<bool(const std::string& job_id)>;

  explicit HeldJobs(Delays delays) : delays_(delays) {}

  // Returns whether the job is new. Ignores it if very many are known.
  bool add(const v1::JobSpec& spec);
  // Null if it is unknown.
  const v1::JobSpec* find(const std::string& id) const;
  // Forgets jobs without leases whose files are not being fetched, but for a few: a farm that alternates
  // between jobs need not send them again.
  void forget_idle(const IsHeld& is_held);
  // Fills in the known jobs, those whose files are or will be fetched, and the troubles.
  void report(v1::SynchronizeRequest& request, const IsHeld& is_held) const;

  // A known job whose files are wanted is being fetched from now on. Returns whether it was one.
  bool begin_fetch(const std::string& id);
  void fetched(std::shared_ptr<const Job> job);
  // The trouble is reported until a piece of the job is rendered. With a reason, the coordinator gets that
  // when the leases are given back.
  void make_unusable(const std::string& id, const std::string& trouble,
                     const std::string& decline_reason = "");
  void rendered(const std::string& id);
  // A lease of the job was given back: an unusable one can be tried again.
  void given_back(const std::string& id);

  // Null unless the job is ready.
  std::shared_ptr<const Job> ready(const std::string& id) const;
  // The ready jobs of the leases.
  std::vector<std::shared_ptr<const Job>> in_hand(const IsHeld& is_held) const;
  bool is_unusable(const std::string& id) const;
  // Of an unusable job: when its leases are given back, and why (may be empty).
  Clock::time_point give_back_at(const std::string& id) const { return jobs_.at(id).give_back_at; }
  const std::string& decline_reason(const std::string& id) const { return jobs_.at(id).decline_reason; }

 private:
  enum class Stage { kWanted, kFetching, kReady, kUnusable };
  struct Entry {
    v1::JobSpec spec;
    Stage stage = Stage::kWanted;
    std::shared_ptr<const Job> job;  // set in READY
    int failures = 0;
    std::string decline_reason;        // set in UNUSABLE, if it is one to report
    Clock::time_point give_back_at{};  // set in UNUSABLE
    std::string trouble;               // the last reason why it was not rendered; empty once it is
    Clock::time_point trouble_at{};
  };

  Entry* entry(const std::string& id);
  Duration next_delay(Entry& entry) const;

  const Delays delays_;
  std::map<std::string, Entry> jobs_;
};

}  // namespace tessera::worker
