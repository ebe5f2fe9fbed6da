// SPDX-License-Identifier: Apache-2.0
#include "tests/simulation/quarantine.hpp"

#include <algorithm>

namespace tessera::simulation {

using scheduler::Producer;

namespace {

bool share(const std::string& a, const std::string& b) {
  return !a.empty() && a == b;
}

}  // namespace

void Quarantine::add(const Producer& producer) {
  if (!has(producer.worker)) entries_.push_back(producer);
}

std::vector<Producer> Quarantine::lift(std::size_t number) {
  const Producer chosen = entries_.at(number);
  const auto kept = std::stable_partition(entries_.begin(), entries_.end(), [&](const Producer& entry) {
    return entry.worker != chosen.worker && !share(entry.machine, chosen.machine) &&
           !share(entry.principal, chosen.principal);
  });
  const std::vector<Producer> lifted(kept, entries_.end());
  entries_.erase(kept, entries_.end());
  return lifted;
}

bool Quarantine::has(const scheduler::WorkerId& worker) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Producer& entry) { return entry.worker == worker; });
}

bool Quarantine::covers(const Producer& worker) const {
  return std::any_of(entries_.begin(), entries_.end(), [&](const Producer& entry) {
    return entry.worker == worker.worker || share(entry.principal, worker.principal);
  });
}

bool Quarantine::refuses(const Producer& worker, bool is_registered) const {
  return covers(worker) || (!is_registered && has_machine(worker.machine));
}

bool Quarantine::has_machine(const std::string& machine) const {
  return std::any_of(entries_.begin(), entries_.end(),
                     [&](const Producer& entry) { return share(entry.machine, machine); });
}

}  // namespace tessera::simulation
