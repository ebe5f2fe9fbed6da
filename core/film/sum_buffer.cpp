// SPDX-License-Identifier: Apache-2.0
#include "core/film/sum_buffer.hpp"

#include <cassert>
#include <functional>
#include <numeric>

#include "core/film/fixed_point.hpp"

namespace tessera::core {

namespace {

// The bits of all terms.
std::uint64_t bits_of(std::span<const std::uint64_t> terms) {
  return std::accumulate(terms.begin(), terms.end(), std::uint64_t{0}, std::bit_or<>());
}

// The bits of all terms, and of their sums with the others.
std::uint64_t bits_of_sums(std::span<const std::uint64_t> terms, const std::uint32_t* others) {
  std::uint64_t bits = 0;
  for (std::size_t i = 0; i < terms.size(); ++i) bits |= terms[i] | (others[i] + terms[i]);
  return bits;
}

}  // namespace

void SumBuffer::reserve(std::size_t begin, std::span<const std::uint64_t> terms) {
  assert(begin + terms.size() <= size_);
  if (!wide_.empty()) return;
  const bool is_zero = narrow_.empty();
  const std::uint64_t bits = is_zero ? bits_of(terms) : bits_of_sums(terms, narrow_.data() + begin);
  const bool fits = bits >> 32 == 0;
  if (!fits && is_zero) {
    wide_.resize(size_);
  } else if (!fits) {
    widen();
  } else if (bits != 0) {
    narrow_.resize(size_);
  }
}

void SumBuffer::add(std::size_t begin, std::span<const std::uint64_t> terms) {
  reserve(begin, terms);
  add_reserved(begin, terms);
}

void SumBuffer::add_reserved(std::size_t begin, std::span<const std::uint64_t> terms) noexcept {
  assert(begin + terms.size() <= size_);
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
  std::vector<std::uint64_t> values;
  copy_to(values);
  return values;
}

void SumBuffer::copy_to(std::vector<std::uint64_t>& values) const {
  wide_.empty() ? values.assign(narrow_.begin(), narrow_.end()) : values.assign(wide_.begin(), wide_.end());
  values.resize(size_);
}

std::size_t SumBuffer::memory_bytes() const {
  return narrow_.capacity() * sizeof(narrow_[0]) + wide_.capacity() * sizeof(wide_[0]);
}

}  // namespace tessera::core
