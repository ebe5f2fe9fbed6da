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

// A worker process, its name and WorkerInfo::machine. A name is chosen by whoever starts the worker, and
// proves nothing. Empty: unknown.
struct Producer {
  std::string name;
  WorkerId worker;
  std::string machine{};
  auto operator<=>(const Producer&) const = default;
};

// The name for messages.
inline const std::string& called(const Producer& producer) {
  return producer.name.empty() ? producer.worker.value : producer.name;
}

// Whether the two cannot audit each other: they have the same name or are the same worker.
inline bool are_one(const Producer& a, const Producer& b) {
  return a.worker == b.worker || (!a.name.empty() && a.name == b.name);
}

// Stands for a producer in large tables.
using ProducerNumber = std::uint32_t;

// Stands for a name, or for a worker without one. Producers of one identity cannot audit each other.
using IdentityNumber = std::uint32_t;
// Several identities, or one of which no producer is known.
inline constexpr IdentityNumber kNoIdentity = 0;

class Producers {
 public:
  ProducerNumber number(const Producer& producer) {
    const auto [known, is_new] =
        numbers_.try_emplace(producer, static_cast<ProducerNumber>(producers_.size()));
    if (!is_new) return known->second;
    producers_.push_back(producer);
    const auto next = static_cast<IdentityNumber>(identities_.size() + 1);
    identity_of_.push_back(identities_.try_emplace(identity_key(producer), next).first->second);
    return known->second;
  }
  const Producer& at(ProducerNumber number) const { return producers_[number]; }
  // Records a worker's name. The worker may have delivered results before it was known.
  void introduce(const Producer& producer) {
    const auto nameless = numbers_.find({{}, producer.worker});
    if (producer.name.empty() || nameless == numbers_.end() || numbers_.contains(producer)) return;
    const ProducerNumber number = nameless->second;
    numbers_.erase(nameless);
    numbers_.emplace(producer, number);
    producers_[number] = producer;
  }

  // The identity of a producer with a number, at the time when it got that.
  IdentityNumber identity(ProducerNumber number) const { return identity_of_[number]; }
  IdentityNumber identity(const Producer& producer) const {
    const auto known = identities_.find(identity_key(producer));
    return known == identities_.end() ? kNoIdentity : known->second;
  }

  // Distrusts every worker of its machine as well, but not those with its name, which anybody can take.
  void distrust(const Producer& producer) {
    ++times_distrusted_;
    distrusted_workers_.insert(producer.worker);
    if (!producer.machine.empty()) distrusted_machines_.insert(producer.machine);
  }
  bool is_distrusted(const Producer& producer) const {
    return distrusted_workers_.contains(producer.worker) || distrusted_machines_.contains(producer.machine);
  }
  // How often distrust() was called.
  std::uint64_t times_distrusted() const { return times_distrusted_; }

 private:
  // The name, or else the worker.
  static std::pair<std::string, WorkerId> identity_key(const Producer& producer) {
    return producer.name.empty() ? std::pair{std::string{}, producer.worker}
                                 : std::pair{producer.name, WorkerId{}};
  }

  std::map<Producer, ProducerNumber> numbers_;
  std::vector<Producer> producers_;
  std::map<std::pair<std::string, WorkerId>, IdentityNumber> identities_;
  // By producer.
  std::vector<IdentityNumber> identity_of_;
  std::set<WorkerId> distrusted_workers_;
  std::set<std::string> distrusted_machines_;
  std::uint64_t times_distrusted_ = 0;
};

}  // namespace tessera::scheduler
