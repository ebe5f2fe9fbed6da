// SPDX-License-Identifier: Apache-2.0
// Whether those who report that a job cannot be rendered are all that could render it.
#pragma once

#include <map>
#include <string>

#include "server/scheduler/farm_state.hpp"

namespace tessera::scheduler {

// Looks at the workers that could render the job and would report it if they cannot.
class Quorum {
 public:
  explicit Quorum(const FarmState& farm) : farm_(farm) {}

  AreAll are_all_names(const Job& job) const;
  AreAll are_all_principals(const Job& job) const;

 private:
  // The stalled workers among those that could otherwise be counted, by a part of their description.
  std::map<std::string, int> stalled_by(const Job& job, std::string WorkerInfo::*part) const;

  const FarmState& farm_;
};

}  // namespace tessera::scheduler
