// SPDX-License-Identifier: Apache-2.0
// Fixed-point sums as the film keeps them: exact whatever their size, in no more memory than it takes. Not
// thread-safe.
#pragma once

#include <cstdint>
#include <span>
#include <vector>

namespace tessera::core {

// So many sums, all 0 at first, which takes no memory; 4 bytes each while all are below 2^32 (64, as
// radiance), and 8 from then on. How it is kept follows from the largest sum alone, not from how that came
// about.
class SumBuffer {
 public:
  SumBuffer() = default;
  explicit SumBuffer(std::size_t size) : size_(size) {}

  std::size_t size() const { return size_; }
  // Takes the memory that add() of the same would take.
  void reserve(std::size_t begin, std::span<const std::uint64_t> terms);
  // add() of what reserve() was called with last. Cannot fail.
  void add_reserved(std::size_t begin, std::span<const std::uint64_t> terms) noexcept;
  // Adds to the sums from `begin` on, with saturation.
  void add(std::size_t begin, std::span<const std::uint64_t> terms);
  std::vector<std::uint64_t> values() const;
  // Replaces the values by these, in the memory that they have.
  void copy_to(std::vector<std::uint64_t>& values) const;
  std::size_t memory_bytes() const;

  bool operator==(const SumBuffer&) const = default;

 private:
  void widen();

  std::size_t size_ = 0;
  // At most one of them has elements.
  std::vector<std::uint32_t> narrow_;
  std::vector<std::uint64_t> wide_;
};

}  // namespace tessera::core
