// SPDX-License-Identifier: Apache-2.0
// A farm on a fake clock for scripted tests, with short names for events. The invariants are checked after
// each event.
#pragma once

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <memory>
#include <ostream>
#include <string>
#include <vector>

#include "server/scheduler/scheduler.hpp"

namespace tessera::scheduler {

using std::chrono::milliseconds;
using std::chrono::seconds;

template <typename Tag>
void PrintTo(const TextId<Tag>& id, std::ostream* out) {
  *out << id.value;
}
inline void PrintTo(const LeaseId& id, std::ostream* out) {
  *out << id.value;
}
inline void PrintTo(const WorkItem& item, std::ostream* out) {
  *out << "tile " << item.tile << " [" << item.samples.begin << ", " << item.samples.end << ")";
}
inline void PrintTo(const LeaseDescription& lease, std::ostream* out) {
  *out << "lease " << lease.id.value << " of " << lease.job.value << ": "
       << testing::PrintToString(lease.items);
}
inline void PrintTo(const JobChange& change, std::ostream* out) {
  *out << change.id.value << " from " << job_state_name(change.from) << " to " << job_state_name(change.to);
}

inline Fingerprint sums(std::uint64_t of) {
  return {of, 0, 1};
}

// A job of several tiles, small enough for cheap invariant checks: two rows of `tiles / 2`.
inline JobShape tiles(int count, std::uint32_t spp) {
  return {count / 2 * core::kTilePx, 2 * core::kTilePx, spp};
}
inline constexpr std::uint64_t kTilePixels = core::kTilePx * core::kTilePx;

class Farm : public testing::Test {
 protected:
  explicit Farm(Options options = {}) : options_(options), scheduler_(std::make_unique<Scheduler>(options)) {}

  Actions handle(const Event& event) {
    Actions actions = scheduler_->handle(event, now_);
    const auto wrong = scheduler_->check_invariants(CheckDepth::kEverySample);
    EXPECT_FALSE(wrong) << *wrong;
    return actions;
  }

  void pass(Duration time) { now_ += time; }
  void tick() { handle(Tick{}); }

  void submit(const std::string& job, JobShape shape, int priority = 0, std::uint32_t max_workers = 0) {
    ASSERT_TRUE(handle(SubmitJob{{job}, shape, priority, max_workers}).status);
  }

  // With one thread, so that a first lease of unknown speed has 12,500 pixel samples: the first sample of
  // four tiles.
  Reply sync(const std::string& worker, std::vector<LeaseDescription> held = {}, int wanted = 1,
             bool draining = false) {
    return *handle(Synchronize{{{worker}, worker, "0.1.0", 1, worker}, std::move(held), wanted, draining})
                .reply;
  }
  // The only lease of the worker's reply.
  LeaseDescription lease_to(const std::string& worker) {
    const Reply reply = sync(worker);
    EXPECT_EQ(reply.leases.size(), 1u);
    return reply.leases.empty() ? LeaseDescription{} : reply.leases[0];
  }

  Actions deliver(const std::string& worker, const LeaseDescription& lease, std::vector<WorkItem> items,
                  bool finished = true, double render_seconds = 0.25) {
    return handle(SubmitResult{{worker}, lease.job, lease.id, std::move(items), render_seconds, finished});
  }
  Actions deliver(const std::string& worker, const LeaseDescription& lease) {
    return deliver(worker, lease, lease.items);
  }

  // Renders leases of the worker until there are none. Returns all items.
  std::vector<WorkItem> render_all(const std::string& worker) {
    std::vector<WorkItem> rendered;
    for (int rounds = 0; rounds < 1000 && !HasFailure(); ++rounds) {
      const Reply reply = sync(worker);
      if (reply.leases.empty()) return rendered;
      for (const LeaseDescription& lease : reply.leases) {
        rendered.insert(rendered.end(), lease.items.begin(), lease.items.end());
        deliver(worker, lease);
      }
    }
    EXPECT_TRUE(HasFailure()) << "there is no end to the work";
    return rendered;
  }

  JobView job(const std::string& id) { return *scheduler_->job({id}, now_); }
  JobState state(const std::string& id) { return job(id).state; }

  // Restarts the coordinator with the current jobs.
  void restart() {
    std::vector<RestoreJob> stored;
    for (const JobView& view : scheduler_->jobs(now_)) {
      stored.push_back({view.id,
                        view.shape,
                        view.priority,
                        view.state,
                        view.failure,
                        {},
                        view.max_workers,
                        {},
                        view.failure_details});
      for (int tile = 0; tile < view.shape.grid().tile_count(); ++tile) {
        stored.back().done.push_back(scheduler_->done(view.id, tile));
        for (const ProducedItem& item : scheduler_->provenance(view.id, tile))
          stored.back().provenance.push_back(item);
      }
    }
    ++options_.epoch;
    start_again(stored);
  }
  void start_again(const std::vector<RestoreJob>& stored) {
    scheduler_ = std::make_unique<Scheduler>(options_);
    for (const RestoreJob& job : stored) handle(job);
  }

  Options options_;
  Time now_{};
  std::unique_ptr<Scheduler> scheduler_;
};

// A farm in which a worker's first lease is one sample of one tile.
class FarmOfSmallLeases : public Farm {
 protected:
  FarmOfSmallLeases() : Farm(small_leases()) {}

 private:
  static Options small_leases() {
    Options options;
    options.sizing.first_lease_seconds = options.sizing.shortest_lease_seconds = 0.05;
    return options;
  }
};

}  // namespace tessera::scheduler
