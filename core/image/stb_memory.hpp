// SPDX-License-Identifier: Apache-2.0
// Limits the memory that stb_image allocates to about an image's pixels.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::core {

// During its lifetime, stb_image's allocations in this thread are limited to the largest that an image of
// this size, from a file of this length, needs. At most one per thread.
class StbMemory {
 public:
  StbMemory(std::int64_t width, std::int64_t height, std::size_t file_bytes);
  ~StbMemory();
  StbMemory(const StbMemory&) = delete;
  StbMemory& operator=(const StbMemory&) = delete;

  // Whether stb exceeded the limit.
  bool was_exceeded() const;
  // Whether the system ran out of memory.
  bool ran_out() const;
};

}  // namespace tessera::core
