// SPDX-License-Identifier: Apache-2.0
// A hostile worker that sends what no honest worker sends: invalid leases, items, times and numbers, other
// workers' leases, and other workers' ids and names. Only its results for leases of its own can count.
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

  // Sends one message about one of the jobs "1" to "jobs" or an unknown one, perhaps under the name of
  // `victim`.
  void speak(int jobs, const std::string& victim);

  // Whether it has delivered results, which may be of samples that kill honest workers.
  bool has_delivered() const { return has_delivered_; }
  // Jobs whose scenes it reported not to be able to build.
  const std::set<scheduler::JobId>& refused() const { return refused_; }

 private:
  scheduler::JobId any_job(int jobs);
  scheduler::LeaseId any_lease();
  // One of its own leases if it has any, otherwise an invented one.
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
