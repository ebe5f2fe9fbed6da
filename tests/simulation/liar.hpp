// SPDX-License-Identifier: Apache-2.0
// Says to a coordinator what no honest worker says: of leases, items, times and numbers that are none, of
// other workers' leases, under other workers' ids and names. Only what it says of leases that it was given
// itself can count, like any other result.
#pragma once

#include <set>
#include <string>
#include <vector>

#include "tests/simulation/coordinator.hpp"
#include "tests/simulation/world.hpp"

namespace tessera::simulation {

class Liar {
 public:
  Liar(World& world, Coordinator& coordinator) : world_(world), coordinator_(coordinator) {}

  // One message, about one of jobs "1" to "jobs" or one that is none; perhaps in the name of `victim`.
  void speak(int jobs, const std::string& victim);

  // Whether it has delivered results, which may be of samples that kill honest workers.
  bool has_delivered() const { return has_delivered_; }
  // Jobs whose scenes it said it cannot build.
  const std::set<scheduler::JobId>& refused() const { return refused_; }

 private:
  scheduler::JobId any_job(int jobs);
  scheduler::LeaseId any_lease();
  // Of one that it was given, if there was any; else made up.
  scheduler::LeaseDescription any_own_lease(int jobs);
  void take(const scheduler::Reply& reply);
  void forge(int jobs, const std::string& victim);
  scheduler::WorkItem any_item();
  std::vector<scheduler::WorkItem> any_items();
  double any_seconds();
  void deliver(int jobs);
  void synchronize(int jobs, const std::string& victim);

  World& world_;
  Coordinator& coordinator_;
  bool has_delivered_ = false;
  std::set<scheduler::JobId> refused_;
  std::vector<scheduler::LeaseDescription> given_;
};

}  // namespace tessera::simulation
