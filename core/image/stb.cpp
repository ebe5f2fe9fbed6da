// SPDX-License-Identifier: Apache-2.0
// stb_image, which reads BMP from memory, is compiled here once.
#include <stdlib.h>

#include <limits>

#include "core/image/stb_memory.hpp"

namespace tessera::core {
namespace {

struct StbUse {
  std::size_t largest = std::numeric_limits<std::size_t>::max();  // limit on a single allocation
  bool exceeded = false, ran_out = false;
};
thread_local StbUse use;

void* note(void* memory) {
  if (memory == nullptr) use.ran_out = true;
  return memory;
}

bool may_take(std::size_t size) {
  if (size <= use.largest) return true;
  use.exceeded = true;
  return false;
}

void* take(std::size_t size) {
  return may_take(size) ? note(calloc(1, size)) : nullptr;
}

void* take_more(void* memory, std::size_t size) {
  return may_take(size) ? note(realloc(memory, size)) : nullptr;
}

// The largest allocation is an image of four bytes per pixel.
std::size_t largest_piece(std::int64_t width, std::int64_t height, std::size_t file_bytes) {
  constexpr std::int64_t kBytesPerPixel = 20, kPadding = 32;
  constexpr std::size_t kTables = std::size_t{1} << 16;
  return static_cast<std::size_t>(kBytesPerPixel * (width + kPadding) * (height + kPadding)) +
         2 * file_bytes + kTables;
}

}  // namespace

StbMemory::StbMemory(std::int64_t width, std::int64_t height, std::size_t file_bytes) {
  use = {largest_piece(width, height, file_bytes), false, false};
}
StbMemory::~StbMemory() {
  use = {};
}
bool StbMemory::was_exceeded() const {
  return use.exceeded;
}
bool StbMemory::ran_out() const {
  return use.ran_out;
}

}  // namespace tessera::core

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_BMP
#define STBI_NO_STDIO
#define STBI_MAX_DIMENSIONS 65536
// Broken files make stb_image read uninitialised tables and fail assertions. Zeroed memory gives the same
// pixels everywhere, and failed assertions must not end the program.
#define STBI_MALLOC(size) tessera::core::take(size)
#define STBI_REALLOC(memory, size) tessera::core::take_more(memory, size)
#define STBI_FREE(memory) free(memory)
#define STBI_ASSERT(condition) ((void)0)
#include <stb_image.h>
