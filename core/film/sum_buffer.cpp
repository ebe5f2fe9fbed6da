// SPDX-License-Identifier: Apache-2.0
#include "core/film/sum_buffer.hpp"

#include <cassert>
#include <functional>
#include <numeric>

#include "core/film/fixed_point.hpp"

namespace tessera::core {

void SumBuffer::reserve(std::size_t begin, std::span<const std::uint64_t> terms) {
  assert(begin + terms.size() <= size_);
  if (!wide_.empty()) return;
  auto bits = std::accumulate(terms.begin(), terms.end(), std::uint64_t{0}, std::bit_or<>());
  if (bits == 0) return;
  narrow_.resize(size_);
  for (std::size_t i = 0; i < terms.size(); ++i) bits |= narrow_[begin + i] + terms[i];
  if (bits >> 32 != 0) widen();
}

void SumBuffer::add(std::size_t begin, std::span<const std::uint64_t> terms) {
  reserve(begin, terms);
  if (!narrow_.empty()) {
    for (std::size_t i = 0; i < terms.size(); ++i) narrow_[begin + i] += static_cast<std::uint32_t>(terms[i]);
  } else if (!wide_.empty()) {
    for (std::size_t i = 0; i < terms.size(); ++i)
      wide_[begin + i] = add_saturating(wide_[begin + i], terms[i]);
  }
}

void SumBuffer::widen() {
  wide_.assign(narrow_.begin(), narrow_.end());
  narrow_ = std::vector<std::uint32_t>();  // frees the memory, unlike {}
}

std::vector<std::uint64_t> SumBuffer::values() const {
  if (!wide_.empty()) return wide_;
  std::vector<std::uint64_t> sums(narrow_.begin(), narrow_.end());
  sums.resize(size_);
  return sums;
}

std::size_t SumBuffer::memory_bytes() const {
  return narrow_.capacity() * sizeof(narrow_[0]) + wide_.capacity() * sizeof(wide_[0]);
}

}  // namespace tessera::core
