// SPDX-License-Identifier: Apache-2.0
// A compact set of those who have rendered samples of a job, to find the jobs of a worker that turns out to
// be wrong. A worker that is not in the set can seem to be, with negligible probability. Not thread-safe.
#pragma once

#include <cstdint>
#include <set>
#include <string>

#include "server/scheduler/producer.hpp"

namespace tessera::film {

class ProducerKeys {
 public:
  ProducerKeys() = default;
  // Of bytes of encode(). Other bytes give some set.
  explicit ProducerKeys(const std::string& bytes);

  // Adds the worker, its machine and its principal.
  void add(const scheduler::Producer& producer);
  // Whether the set has the worker, or another one of its machine or principal.
  bool contains(const scheduler::Producer& producer) const;
  std::string encode() const;

 private:
  std::set<std::uint64_t> keys_;
};

}  // namespace tessera::film
