// SPDX-License-Identifier: Apache-2.0
// A farm with audits, and workers that are honest or lie.
#pragma once

#include <string>
#include <utility>
#include <vector>

#include "tests/unit/scheduler/farm.hpp"

namespace tessera::scheduler {

// Honest sums are linear in the number of samples, like those of a film.
inline Fingerprint honest(const WorkItem& item) {
  Fingerprint total;
  for (std::uint32_t s = item.samples.begin; s < item.samples.end; ++s)
    total.add(sums(1000 * static_cast<std::uint64_t>(item.tile + 1) + s));
  return total;
}

inline Fingerprint wrong(const WorkItem& item) {
  Fingerprint total = honest(item);
  total.add(sums(7));
  return total;
}

// The sums that a worker delivers for an item.
using Sums = Fingerprint (*)(const WorkItem&);

// Audits a share of all ranges.
class AuditsOf : public Farm {
 protected:
  explicit AuditsOf(double share) : Farm(audited(share)) {}

  Actions deliver_sums(const std::string& worker, const LeaseDescription& lease,
                       const std::vector<WorkItem>& items, Sums sums_of, bool finished = true) {
    SubmitResult result{{worker}, lease.job, lease.id, items, 0.25, finished};
    for (const WorkItem& item : items) result.fingerprints.push_back(sums_of(item));
    return handle(result);
  }
  Actions deliver_sums(const std::string& worker, const LeaseDescription& lease, Sums sums_of) {
    return deliver_sums(worker, lease, lease.items, sums_of);
  }
  // Renders leases until there are none.
  void render(const std::string& worker, Sums sums_of = honest) {
    for (int rounds = 0; rounds < 1000 && !HasFailure(); ++rounds) {
      const Reply reply = sync(worker);
      if (reply.leases.empty()) return;
      for (const LeaseDescription& lease : reply.leases) deliver_sums(worker, lease, sums_of);
    }
    ADD_FAILURE() << "there is no end to the work";
  }
  // Lets the workers take turns until none is given a lease.
  void render_together(const std::vector<std::pair<std::string, Sums>>& workers) {
    for (int rounds = 0; rounds < 1000 && state("job") == JobState::kRunning; ++rounds) {
      for (const auto& [worker, sums_of] : workers) {
        const Reply reply = sync(worker);
        for (const LeaseDescription& lease : reply.leases) deliver_sums(worker, lease, sums_of);
      }
    }
  }
  WorkerView worker(const std::string& id) {
    for (const WorkerView& view : scheduler_->workers(now_)) {
      if (view.info.id.value == id) return view;
    }
    return {};
  }

 private:
  static Options audited(double share) {
    Options options;
    options.audit_share = share;
    options.audit_secret = 17;
    // A first lease has up to 100,000 samples, which is all of a small job.
    options.sizing.first_lease_seconds = 2;
    options.sizing.end_divisor = 0.01;
    return options;
  }
};

}  // namespace tessera::scheduler
