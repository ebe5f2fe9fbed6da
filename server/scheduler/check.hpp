// SPDX-License-Identifier: Apache-2.0
// The invariants of a scheduler (scheduler.hpp). Each function returns the first violation as a sentence.
#pragma once

#include <cstddef>
#include <optional>
#include <string>

#include "server/scheduler/eligibility.hpp"
#include "server/scheduler/farm_view.hpp"

namespace tessera::scheduler {

class Invariants {
 public:
  explicit Invariants(const FarmState& farm) : farm_(farm), eligibility_(farm) {}

  // See FarmView::check_invariants() and check_some().
  std::optional<std::string> check(CheckDepth depth) const;
  std::optional<std::string> check_some(CheckCursor& cursor, std::size_t most) const;

 private:
  std::optional<std::string> check_next(CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_leases(const Job& job, CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_workers(CheckCursor& cursor, std::size_t& left) const;
  std::optional<std::string> check_job(const Job& job) const;
  std::optional<std::string> check_lease(const Job& job, const Lease& lease) const;
  std::optional<std::string> check_worker(const Worker& worker) const;
  std::optional<std::string> check_held(const Worker& worker, const HeldLease& held) const;
  std::optional<std::string> check_idle(const Worker& worker) const;
  std::optional<std::string> check_sums() const;
  std::optional<std::string> check_every_job(const Worker& worker) const;
  std::optional<std::string> check_choice(const Worker& worker) const;
  std::optional<JobNumber> chosen_of_all(const Worker& worker, bool also_refused) const;

  const FarmState& farm_;
  const Eligibility eligibility_;
};

}  // namespace tessera::scheduler
