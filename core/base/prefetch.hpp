// SPDX-License-Identifier: Apache-2.0
// Asking memory for what will be read soon.
#pragma once

#include <cstddef>
#include <span>

namespace tessera::core {

// All lines of the cache that these bytes are in.
inline void prefetch_bytes(std::span<const std::byte> bytes) {
  constexpr std::size_t kCacheLine = 64;
  for (std::size_t line = 0; line < bytes.size(); line += kCacheLine) __builtin_prefetch(&bytes[line]);
  if (!bytes.empty()) __builtin_prefetch(&bytes.back());
  // Nothing. But GCC 12 takes a function that does no more than to prefetch for one that does nothing at all,
  // and drops calls of it.
  asm volatile("");
}

template <typename T>
void prefetch(const T& what) {
  prefetch_bytes(std::as_bytes(std::span(&what, 1)));
}

}  // namespace tessera::core
