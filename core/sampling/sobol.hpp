// SPDX-License-Identifier: Apache-2.0
// The first four dimensions of Sobol's sequence (Sobol' 1967), with the direction numbers of Joe and Kuo
// 2008, and Owen scrambling by hashing (Laine and Karras 2011, improved by Vegdahl 2021).
#pragma once

#include <array>
#include <cstdint>

#include "core/math/simd_integer.hpp"

namespace tessera::core::sampling {

inline constexpr int kSobolDimensions = 4;

// Point `index` of the sequence with the bits of each coordinate reversed (lowest bit first), as
// owen_scramble_reversed takes them. Points 0 to 2^k - 1 are stratified in all elementary intervals.
std::array<std::uint32_t, kSobolDimensions> sobol_reversed(std::uint32_t index);
std::array<U32xN, kSobolDimensions> sobol_reversed(U32xN index);

constexpr std::uint32_t reverse_bits(std::uint32_t v) {
  v = ((v >> 1) & 0x55555555u) | ((v & 0x55555555u) << 1);
  v = ((v >> 2) & 0x33333333u) | ((v & 0x33333333u) << 2);
  v = ((v >> 4) & 0x0f0f0f0fu) | ((v & 0x0f0f0f0fu) << 4);
  v = ((v >> 8) & 0x00ff00ffu) | ((v & 0x00ff00ffu) << 8);
  return (v >> 16) | (v << 16);
}

// Nested uniform scrambling of a coordinate with reversed bits: whether a bit is flipped depends only on
// `seed` and the more significant bits. The result's bits are also reversed.
template <typename U>
constexpr U owen_scramble_reversed(U v, U seed) {
  v = v ^ (v * 0x3d20adeau);
  v = v + seed;
  v = v * ((seed >> 16) | 1u);
  v = v ^ (v * 0x05526c56u);
  return v ^ (v * 0x53a22864u);
}

}  // namespace tessera::core::sampling
