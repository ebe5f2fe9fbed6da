// SPDX-License-Identifier: Apache-2.0
// Which workers the model's coordinator gives nothing: the rules of farm::Quarantine, written independently.
// Entries survive a crash of the coordinator once they are stored.
#pragma once

#include <string>
#include <vector>

#include "server/scheduler/producer.hpp"

namespace tessera::simulation {

class Quarantine {
 public:
  // No change if the worker has an entry.
  void add(const scheduler::Producer& producer);
  // Removes the entry of this number, and those of its machine and of its principal. Returns all of them.
  std::vector<scheduler::Producer> lift(std::size_t number);
  const std::vector<scheduler::Producer>& entries() const { return entries_; }

  // Whether the worker has an entry itself.
  bool has(const scheduler::WorkerId& worker) const;
  // The same, or its principal has one.
  bool covers(const scheduler::Producer& worker) const;
  // Whether the worker is refused. Workers that were registered before their machine was quarantined are
  // judged by their own results.
  bool refuses(const scheduler::Producer& worker, bool is_registered) const;
  bool has_machine(const std::string& machine) const;

  void store() { stored_ = entries_; }
  void crashed() { entries_ = stored_; }

 private:
  std::vector<scheduler::Producer> entries_, stored_;
};

}  // namespace tessera::simulation
