// SPDX-License-Identifier: Apache-2.0
// Lists of what one event has changed.
#pragma once

#include <algorithm>
#include <vector>

namespace tessera::scheduler {

// Appends the id unless it is in the list. The list must be short.
template <typename Id>
void note_change(std::vector<Id>& list, const Id& id) {
  if (std::find(list.begin(), list.end(), id) == list.end()) list.push_back(id);
}

}  // namespace tessera::scheduler
