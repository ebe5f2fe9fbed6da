// SPDX-License-Identifier: Apache-2.0
// Prefetching of memory that will be read soon.
#pragma once

#include <cstddef>
#include <span>

namespace tessera::core {

// Prefetches all cache lines that contain these bytes.
inline void prefetch_bytes(std::span<const std::byte> bytes) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t line = 0; line < bytes.size(); line += kCacheLine) __builtin_prefetch(&bytes[line]);
  if (!bytes.empty()) __builtin_prefetch(&bytes.back());
  // Keeps the function from being empty for the optimiser: GCC 12 treats a function that only prefetches as
  // one without effects, and drops calls to it.
  asm volatile("");
}

template <typename T>
void prefetch(const T& what) {
  prefetch_bytes(std::as_bytes(std::span(&what, 1)));
}

}  // namespace tessera::core
