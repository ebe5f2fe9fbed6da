// SPDX-License-Identifier: Apache-2.0
// Walks over all jobs or workers under many short holds of the state lock. What is added or removed meanwhile
// may be visited or not.
#pragma once

#include <cstddef>
#include <map>
#include <optional>
#include <string>

#include "server/farm/state_lock.hpp"

namespace tessera::farm {

// How many are visited under one hold, which takes some hundred nanoseconds for each.
inline constexpr std::size_t kVisitedAtOnce = 256;

// Calls visit(lock, id, value) for each element of a map of the state, such as &State::jobs.
template <typename Value, typename Visit>
void visit_in_steps(Farm& farm, std::map<std::string, Value> State::*map, const Visit& visit) {
  for (std::optional<std::string> from(""); from;) {
    StateLock lock(farm);
    std::map<std::string, Value>& all = lock.operator->()->*map;
    auto next = all.lower_bound(*from);
    for (std::size_t i = 0; i < kVisitedAtOnce && next != all.end(); ++i, ++next)
      visit(lock, next->first, next->second);
    from = next == all.end() ? std::nullopt : std::optional(next->first);
  }
}

}  // namespace tessera::farm
