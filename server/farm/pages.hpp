// SPDX-License-Identifier: Apache-2.0
// Pages of lists.
#pragma once

#include <algorithm>
#include <cstdint>

namespace tessera::farm {

// How many entries a page has at most, by the page_size of its request.
inline int page_size(std::uint32_t asked) {
  constexpr std::uint32_t kMaxPageSize = 1000;
  return static_cast<int>(asked == 0 ? kMaxPageSize : std::min(asked, kMaxPageSize));
}

}  // namespace tessera::farm
