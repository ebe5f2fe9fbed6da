// SPDX-License-Identifier: Apache-2.0
// Who has rendered something, so that it can be said long after; and who of them is trusted. Not thread-safe.
#pragma once

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "server/scheduler/types.hpp"

namespace tessera::scheduler {

// A process that rendered, the name it goes by, and WorkerInfo::machine. A name is chosen by whoever starts
// the worker, and proves nothing. Empty: unknown.
struct Producer {
  std::string name;
  WorkerId worker;
  std::string machine{};
  auto operator<=>(const Producer&) const = default;
};

// For sentences.
inline const std::string& called(const Producer& producer) {
  return producer.name.empty() ? producer.worker.value : producer.name;
}

// Whether one cannot vouch for the other: they are of one name, or one and the same.
inline bool are_one(const Producer& a, const Producer& b) {
  return a.worker == b.worker || (!a.name.empty() && a.name == b.name);
}

// Stands for an author where there are many of them to remember.
using ProducerNumber = std::uint32_t;

class Producers {
 public:
  ProducerNumber number(const Producer& producer) {
    const auto [known, is_new] =
        numbers_.try_emplace(producer, static_cast<ProducerNumber>(producers_.size()));
    if (is_new) producers_.push_back(producer);
    return known->second;
  }
  const Producer& at(ProducerNumber number) const { return producers_[number]; }
  // A worker says its name, which may have delivered something before it did.
  void introduce(const Producer& producer) {
    const auto nameless = numbers_.find({{}, producer.worker});
    if (producer.name.empty() || nameless == numbers_.end() || numbers_.contains(producer)) return;
    const ProducerNumber number = nameless->second;
    numbers_.erase(nameless);
    numbers_.emplace(producer, number);
    producers_[number] = producer;
  }

  // Every other worker of its machine as well; not those of its name, which anybody can take.
  void distrust(const Producer& producer) {
    distrusted_workers_.insert(producer.worker);
    if (!producer.machine.empty()) distrusted_machines_.insert(producer.machine);
  }
  bool is_distrusted(const Producer& producer) const {
    return distrusted_workers_.contains(producer.worker) || distrusted_machines_.contains(producer.machine);
  }

 private:
  std::map<Producer, ProducerNumber> numbers_;
  std::vector<Producer> producers_;
  std::set<WorkerId> distrusted_workers_;
  std::set<std::string> distrusted_machines_;
};

}  // namespace tessera::scheduler
