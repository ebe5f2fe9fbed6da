// SPDX-License-Identifier: Apache-2.0
// Keeps stb_image from taking much more memory than an image's pixels need.
#pragma once

#include <cstddef>
#include <cstdint>

namespace tessera::core {

// While it lives, stb_image takes no piece of memory in this thread that decoding a picture of this size,
// from a file of this length, does not need. One at a time in a thread.
class StbMemory {
 public:
  StbMemory(std::int64_t width, std::int64_t height, std::size_t file_bytes);
  ~StbMemory();
  StbMemory(const StbMemory&) = delete;
  StbMemory& operator=(const StbMemory&) = delete;

  // Whether stb asked for more than that.
  bool was_exceeded() const;
  // Whether the machine had no more.
  bool ran_out() const;
};

}  // namespace tessera::core
