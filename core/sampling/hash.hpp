// Integer hashing: how counters become random bits.
#pragma once

#include <cstdint>

namespace tessera::core {

// A bijection of 64-bit numbers whose output bits each depend on all input bits (Steele, Lea and Flood 2014,
// the finalizer of SplitMix64, variant 13 of Stafford 2011).
constexpr std::uint64_t mix_bits(std::uint64_t v) {
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9u;
  v = (v ^ (v >> 27)) * 0x94d049bb133111ebu;
  return v ^ (v >> 31);
}

constexpr std::uint64_t hash(std::uint64_t a, std::uint64_t b) {
  return mix_bits(a + mix_bits(b + 0x9e3779b97f4a7c15u));
}

// In [0, 1), with 24 bits: the largest is 1 - 2^-24.
constexpr float unit_float(std::uint32_t bits) {
  return static_cast<float>(bits >> 8) * 0x1p-24f;
}

}  // namespace tessera::core
