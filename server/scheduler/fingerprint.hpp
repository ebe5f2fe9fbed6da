// SPDX-License-Identifier: Apache-2.0
// What the scheduler keeps of a result's sums, to compare them with those of another worker. Plain values.
//
// The number is linear in the sums, so that the fingerprints of parts of a range add up to that of the whole,
// however it was cut: whoever makes them multiplies each sum by a secret coefficient, and adds modulo 2^128.
// Sums add with saturation, which is not linear; so one is only a fingerprint's equal if no sum was cut off,
// or if both were cut in the same way.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>

namespace tessera::scheduler {

struct Fingerprint {
  std::uint64_t low = 0, high = 0;
  // No sum is larger, in parts added together; infinite if one has reached the end of its range.
  float largest = 0;

  void add(const Fingerprint& other) {
    low += other.low;
    high += other.high + (low < other.low ? 1 : 0);
    largest += other.largest;
  }
  bool operator==(const Fingerprint&) const = default;
};

// Whether these are of the same sums. Where a pixel's sum does not fit its 64 bits and the range was cut in
// another way, that cannot be told, and is taken to be so.
inline bool same_sums(const Fingerprint& a, const Fingerprint& b) {
  if (a.low == b.low && a.high == b.high) return true;
  // What is cut off was at least 2^64; half of it leaves room for the rounding of `largest`.
  constexpr float kMayBeCutOff = 0x1p63F;
  const bool both_may_be_cut_off = a.largest >= kMayBeCutOff && b.largest >= kMayBeCutOff;
  return both_may_be_cut_off && (std::isinf(a.largest) || std::isinf(b.largest));
}

}  // namespace tessera::scheduler
