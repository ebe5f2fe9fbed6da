// SPDX-License-Identifier: Apache-2.0
// Who rendered samples (provenance), and which producers are trusted. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// A worker process, its name, WorkerInfo::machine, and WorkerInfo::principal if that is individual. A name is
// chosen by whoever starts the worker, and proves nothing. Empty: unknown.
struct Producer {
  std::string name;
  WorkerId worker;
  std::string machine{};
  std::string principal{};
  auto operator<=>(const Producer&) const = default;
};

// The name for messages.
inline const std::string& called(const Producer& producer) {
  return producer.name.empty() ? producer.worker.value : producer.name;
}

// What audits tell apart: individual principals, else names, else workers.
struct Identity {
  std::string principal{}, name{};
  WorkerId worker{};
  auto operator<=>(const Identity&) const = default;
};

inline Identity identity_of(const Producer& producer) {
  if (!producer.principal.empty()) return {.principal = producer.principal};
  if (!producer.name.empty()) return {.name = producer.name};
  return {.worker = producer.worker};
}

// Whether the two cannot audit each other: they have one identity or are the same worker.
inline bool are_one(const Producer& a, const Producer& b) {
  if (a.worker == b.worker) return true;
  if (!a.principal.empty() || !b.principal.empty()) return a.principal == b.principal;
  return !a.name.empty() && a.name == b.name;
}

// Stands for a producer in large tables.
using ProducerNumber = std::uint32_t;

// Stands for an Identity in large tables.
using IdentityNumber = std::uint32_t;
// Several identities, or one of which no producer is known.
inline constexpr IdentityNumber kNoIdentity = 0;

class Producers {
 public:
  ProducerNumber number(const Producer& producer);
  const Producer& at(ProducerNumber number) const { return producers_[number]; }
  // Records a worker's name. The worker may have delivered results before it was known.
  void introduce(const Producer& producer);

  // The identity of a producer with a number, at the time when it got that.
  IdentityNumber identity(ProducerNumber number) const { return identity_of_[number]; }
  IdentityNumber identity(const Producer& producer) const;

  // Distrusts every worker of its machine and of its principal as well, but not those with its name, which
  // anybody can take.
  void distrust(const Producer& producer);
  // Trusts the worker, its machine and its principal again.
  void trust(const Producer& producer);
  bool is_distrusted(const Producer& producer) const;
  // How often distrust() or trust() was called.
  std::uint64_t times_changed() const { return times_changed_; }

 private:
  std::map<Producer, ProducerNumber> numbers_;
  std::vector<Producer> producers_;
  std::map<Identity, IdentityNumber> identities_;
  // By producer.
  std::vector<IdentityNumber> identity_of_;
  std::set<WorkerId> distrusted_workers_;
  std::set<std::string> distrusted_machines_, distrusted_principals_;
  std::uint64_t times_changed_ = 0;
};

}  // namespace tessera::scheduler
