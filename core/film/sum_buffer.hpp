// SPDX-License-Identifier: Apache-2.0
// Compact storage of exact fixed-point sums. Not thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera::core {

// An array of sums, initially 0. It takes no memory while all are 0, 4 bytes each while all are below 2^32
// (radiance 64), and 8 bytes beyond. The representation depends only on the largest sum, not on the order
// of additions.
class SumBuffer {
 public:
  SumBuffer() = default;
  explicit SumBuffer(std::size_t size) : size_(size) {}

  std::size_t size() const { return size_; }
  // Adds to the sums from `begin` on, with saturation.
  void add(std::size_t begin, std::span<const std::uint64_t> terms);
  std::vector<std::uint64_t> values() const;
  std::size_t memory_bytes() const;

  bool operator==(const SumBuffer&) const = default;

 private:
  void widen();

  std::size_t size_ = 0;
  // At most one of these is non-empty.
  std::vector<std::uint32_t> narrow_;
  std::vector<std::uint64_t> wide_;
};

}  // namespace tessera::core
