// SPDX-License-Identifier: Apache-2.0
// The outcomes of audits, and what follows from them. Part of the scheduler; audits.hpp has the audits of one
// job.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "server/scheduler/farm_state.hpp"
#include "server/scheduler/jobs.hpp"
#include "server/scheduler/leases.hpp"
#include "server/scheduler/reviews.hpp"

namespace tessera::scheduler {

class Auditing {
 public:
  Auditing(FarmState& farm, Leases& leases, Jobs& jobs, Reviews& reviews)
      : farm_(farm), leases_(leases), jobs_(jobs), reviews_(reviews) {}

  Worker* on(const DropTile& event, Actions& actions);

  // Takes the result's item as an audit of samples that are in the film.
  std::optional<Ruling> take(Job& job, const SubmitResult& event, std::size_t item);
  void follow(Job& job, const Ruling& ruling, Actions& actions);
  void restore_producers(Job& job, const std::vector<ProducedItem>& provenance);
  Producer producer_of(const SubmitResult& result) const;

 private:
  void disprove(const Job& job, const Ruling& ruling, ProducerNumber producer, Actions& actions);
  void drop_tile(Job& job, int tile, Actions& actions);

  FarmState& farm_;
  Leases& leases_;
  Jobs& jobs_;
  Reviews& reviews_;
};

}  // namespace tessera::scheduler
