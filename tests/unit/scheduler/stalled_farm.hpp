// SPDX-License-Identifier: Apache-2.0
// A farm in which workers send heartbeats but deliver nothing.
#pragma once

#include <algorithm>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {

class StalledFarm : public Farm {
 protected:
  // Reports its leases every five seconds for so long. Updates `held`, and returns the log messages.
  Actions keep_reporting(const std::string& worker, std::vector<LeaseDescription>& held, Duration time) {
    Actions last;
    for (const Time end = now_ + time; now_ < end;) {
      pass(seconds(5));
      last = handle(Synchronize{{{worker}, worker, "0.1.0", 1}, held, 1, false, fetching_, rendering_});
      held = last.reply->leases;
    }
    return last;
  }
  // The same, while it reports to render this item of its first lease.
  Actions keep_rendering(const std::string& worker, std::vector<LeaseDescription>& held, Duration time,
                         std::size_t item = 0) {
    stuck_in_ = item_of(held.at(0), item);
    return keep_saying(*stuck_in_, worker, held, time);
  }
  Actions keep_saying(const Rendering& rendering, const std::string& worker,
                      std::vector<LeaseDescription>& held, Duration time) {
    rendering_ = rendering;
    Actions last = keep_reporting(worker, held, time);
    rendering_.reset();
    return last;
  }
  static Rendering item_of(const LeaseDescription& lease, std::size_t item) {
    return {lease.id, lease.job, lease.items.at(item)};
  }
  // Delivers a result that counts.
  void show(const std::string& worker) {
    const LeaseDescription lease = lease_to(worker);
    deliver(worker, lease);
  }
  // It hangs in the first item of its lease, which is returned.
  WorkItem lose(const std::string& worker, Duration time = seconds(100)) {
    std::vector<LeaseDescription> held{lease_to(worker)};
    const WorkItem item = held[0].items.at(0);
    last_ = keep_rendering(worker, held, time);
    EXPECT_THAT(held, testing::IsEmpty());
    return item;
  }
  const WorkerView& view(const std::string& worker) {
    views_ = scheduler_->workers(now_);
    return *std::find_if(views_.begin(), views_.end(), [&](const auto& v) { return v.info.name == worker; });
  }

  std::set<JobId> fetching_;
  std::optional<Rendering> rendering_, stuck_in_;
  Actions last_;
  std::vector<WorkerView> views_;
};

}  // namespace tessera::scheduler
