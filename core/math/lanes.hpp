// SPDX-License-Identifier: Apache-2.0
// Types and functions for formulae that are written once for scalars and vectors (core/math/simd.hpp):
// associated types and branch-free selection. T is float, FloatN or FloatVector.
#pragma once

#include <bit>
#include <cstdint>
#include <type_traits>

namespace tessera::core {

// MaskOf<T> is the result of comparing T, WideOf<T> the same lanes in double precision. kLanes<T> is the
// number of lanes.
template <typename T>
struct Lanes;
template <>
struct Lanes<float> {
  using Mask = bool;
  using Wide = double;
  static constexpr int kCount = 1;
};
template <typename T>
using MaskOf = typename Lanes<T>::Mask;
template <typename T>
using WideOf = typename Lanes<T>::Wide;
template <typename T>
inline constexpr int kLanes = Lanes<T>::kCount;

constexpr bool any(bool mask) {
  return mask;
}
constexpr bool all(bool mask) {
  return mask;
}
constexpr std::uint32_t select(bool mask, std::uint32_t a, std::uint32_t b) {
  return mask ? a : b;
}
// Branch-free, for unpredictable conditions.
constexpr float select(bool mask, float a, float b) {
  const std::uint32_t all = mask ? ~std::uint32_t{0} : 0;
  const auto of_a = std::bit_cast<std::uint32_t>(a), of_b = std::bit_cast<std::uint32_t>(b);
  return std::bit_cast<float>((of_a & all) | (of_b & ~all));
}
constexpr double select(bool mask, double a, double b) {
  return mask ? a : b;
}

constexpr bool select_mask(bool mask, bool a, bool b) {
  return mask ? a : b;
}

// The larger one, or the first if they are equal or either is NaN, as std::max; likewise the smaller one.
template <typename T>
T larger(T a, T b) {
  return select(a < b, b, a);
}
template <typename T>
T smaller(T a, T b) {
  return select(b < a, b, a);
}

// As std::clamp.
template <typename T>
T clamp_between(T x, std::type_identity_t<T> low, std::type_identity_t<T> high) {
  return select(x < low, low, select(high < x, high, x));
}

constexpr std::uint32_t as_bits(float x) {
  return std::bit_cast<std::uint32_t>(x);
}
constexpr float as_float(std::uint32_t bits) {
  return std::bit_cast<float>(bits);
}
// Requires x < 2^31.
constexpr float to_float(std::uint32_t x) {
  return static_cast<float>(static_cast<std::int32_t>(x));
}
constexpr std::uint32_t low_word(std::uint64_t x) {
  return static_cast<std::uint32_t>(x);
}
constexpr std::uint32_t high_word(std::uint64_t x) {
  return static_cast<std::uint32_t>(x >> 32);
}
constexpr double widened(float x) {
  return static_cast<double>(x);
}
constexpr float to_float(double x) {
  return static_cast<float>(x);
}

// 2^k for integers k from -1022 to 1023, from a sum that has k + 1023 in its lowest bits.
inline constexpr double kExponentMagic = 0x1p52 + 1023;
constexpr double power_of_two(double k) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(k + kExponentMagic) << 52);
}
// A positive number that is not subnormal is 2^exponent_near_one(x) mantissa_near_one(x), with a mantissa in
// [sqrt(1/2), sqrt(2)).
inline constexpr double kSqrtHalf = 0.70710678118654752440;
constexpr std::uint64_t bits_above_sqrt_half(double x) {
  return std::bit_cast<std::uint64_t>(x) - std::bit_cast<std::uint64_t>(kSqrtHalf);
}
constexpr double exponent_near_one(double x) {
  return static_cast<double>(static_cast<std::int64_t>(bits_above_sqrt_half(x)) >> 52);
}
constexpr double mantissa_near_one(double x) {
  return std::bit_cast<double>(std::bit_cast<std::uint64_t>(x) - (bits_above_sqrt_half(x) >> 52 << 52));
}

}  // namespace tessera::core
