// SPDX-License-Identifier: Apache-2.0
// The fingerprint of a result's sums, kept to compare them with those of another worker. Plain values.
//
// The number is linear in the sums: each sum is multiplied by a secret coefficient, and the products are
// added modulo 2^128. So the fingerprints of the parts of a range add up to that of the whole, however it was
// divided. Sums saturate, which is not linear: fingerprints are comparable only if no sum saturated, or if
// both ranges were divided in the same way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera::scheduler {

struct Fingerprint {
  std::uint64_t low = 0, high = 0;
  // An upper bound on every sum, also when parts are added; infinite if a sum has saturated.
  float largest = 0;

  void add(const Fingerprint& other) {
    low += other.low;
    high += other.high + (low < other.low ? 1 : 0);
    largest += other.largest;
  }
  bool operator==(const Fingerprint&) const = default;
};

// Whether both are of the same sums. If a pixel's sum saturated and the ranges were divided differently, this
// cannot be decided, and the answer is yes.
inline bool same_sums(const Fingerprint& a, const Fingerprint& b) {
  if (a.low == b.low && a.high == b.high) return true;
  // A saturated sum is at least 2^64; the half of it allows for the rounding of `largest`.
  constexpr float kMayBeCutOff = 0x1p63F;
  const bool both_may_be_cut_off = a.largest >= kMayBeCutOff && b.largest >= kMayBeCutOff;
  return both_may_be_cut_off && (std::isinf(a.largest) || std::isinf(b.largest));
}

}  // namespace tessera::scheduler
