// SPDX-License-Identifier: Apache-2.0
// Integer hashing: converts counters to random bits.
#pragma once

#include <cstdint>

#include "core/math/lanes.hpp"

namespace tessera::core::sampling {

// A bijection of 64-bit numbers (scalar or vector) in which every output bit depends on all input bits
// (Steele, Lea and Flood 2014, the finalizer of SplitMix64, variant 13 of Stafford 2011).
template <typename U = std::uint64_t>
constexpr U mix_bits(U v) {
  v = (v ^ (v >> 30)) * U(0xbf58476d1ce4e5b9u);
  v = (v ^ (v >> 27)) * U(0x94d049bb133111ebu);
  return v ^ (v >> 31);
}

template <typename U = std::uint64_t>
constexpr U hash(U a, std::uint64_t b) {
  return mix_bits<U>(a + U(mix_bits(b + 0x9e3779b97f4a7c15u)));
}

// A number in [0, 1) with 24 bits: the largest is 1 - 2^-24.
template <typename U>
constexpr auto unit_float(U bits) {
  return to_float(bits >> 8) * 0x1p-24f;
}

}  // namespace tessera::core::sampling
