// SPDX-License-Identifier: Apache-2.0
// A number that follows from everything that a scheduler was asked and decided. Two builds whose farms have
// the same digests make the same decisions.
#pragma once

#include <cstdint>
#include <string_view>

#include "server/scheduler/events.hpp"

namespace tessera::simulation {

class Digest {
 public:
  // An event that was handled at this time, and the actions that followed.
  void add(const scheduler::Event& event, scheduler::Time time, const scheduler::Actions& actions);
  std::uint64_t value() const { return hash_; }

 private:
  void add(std::string_view text);
  void add(std::uint64_t number);
  void add(const scheduler::WorkItem& item);
  void add(const scheduler::TileOfJob& tile);
  void add(const scheduler::Reply& reply);

  std::uint64_t hash_ = 0xcbf29ce484222325;
};

}  // namespace tessera::simulation
