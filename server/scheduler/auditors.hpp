// SPDX-License-Identifier: Apache-2.0
// Which workers could audit a job that lacks nothing else.
#pragma once

#include <optional>
#include <set>

#include "server/scheduler/eligibility.hpp"
#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

// Whether the job lacks nothing but audits that were chosen by lot.
bool lacks_only_lots(const Job& job);
// Whether the job lacks nothing but samples to verify, and nobody verifies any.
bool is_unattended(const Job& job);

class Auditors {
 public:
  explicit Auditors(const FarmState& farm) : farm_(farm), eligibility_(farm) {}

  std::optional<WorkerId> find(const Job& job) const;

 private:
  static bool is_no_help(const Job& job, const Worker& worker);
  std::optional<WorkerId> find_at_work(const Job& job) const;
  std::optional<WorkerId> find_among(const Job& job, const std::set<WorkerId>& workers) const;
  bool would_audit(const Job& job, const WorkerId& worker) const;

  const FarmState& farm_;
  const Eligibility eligibility_;
};

}  // namespace tessera::scheduler
