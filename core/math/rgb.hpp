// SPDX-License-Identifier: Apache-2.0
// Linear radiometric colour with the primaries of Rec. 709: radiance, reflectance or throughput.
// RgbOf<FloatN> is a vector of them (core/math/simd.hpp).
#pragma once

#include <cmath>

#include "core/math/lanes.hpp"

namespace tessera::core {

template <typename T>
struct RgbOf {
  T r{}, g{}, b{};

  static constexpr RgbOf gray(T v) { return {v, v, v}; }

  T operator[](int channel) const { return channel == 0 ? r : channel == 1 ? g : b; }
  RgbOf& operator+=(RgbOf o) { return *this = {r + o.r, g + o.g, b + o.b}; }
  RgbOf& operator*=(RgbOf o) { return *this = {r * o.r, g * o.g, b * o.b}; }
  RgbOf& operator*=(T s) { return *this = {r * s, g * s, b * s}; }
  bool operator==(const RgbOf&) const = default;

  friend RgbOf operator+(RgbOf a, RgbOf b) { return {a.r + b.r, a.g + b.g, a.b + b.b}; }
  friend RgbOf operator-(RgbOf a, RgbOf b) { return {a.r - b.r, a.g - b.g, a.b - b.b}; }
  friend RgbOf operator*(RgbOf a, RgbOf b) { return {a.r * b.r, a.g * b.g, a.b * b.b}; }
  friend RgbOf operator*(RgbOf a, T s) { return {a.r * s, a.g * s, a.b * s}; }
  friend RgbOf operator*(T s, RgbOf a) { return a * s; }
  friend RgbOf operator/(RgbOf a, T s) { return {a.r / s, a.g / s, a.b / s}; }
};
using Rgb = RgbOf<float>;

template <typename T = float>
MaskOf<T> is_black(RgbOf<T> c) {
  return (c.r == 0) & (c.g == 0) & (c.b == 0);
}
inline bool is_finite(Rgb c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}
template <typename T = float>
T max_component(RgbOf<T> c) {
  const T rg = select(c.r > c.g, c.r, c.g);
  return select(rg > c.b, rg, c.b);
}
template <typename T>
RgbOf<T> select(MaskOf<T> mask, RgbOf<T> a, RgbOf<T> b) {
  return {select(mask, a.r, b.r), select(mask, a.g, b.g), select(mask, a.b, b.b)};
}

// The weight by which lights are chosen: noise from a blue lamp is as large as from a green one.
template <typename T = float>
T mean(RgbOf<T> c) {
  constexpr float kThird = 1.0f / 3;
  return c.r * kThird + c.g * kThird + c.b * kThird;
}

// Relative luminance (ITU-R BT.709-6, item 3.2).
template <typename T = float>
T luminance(RgbOf<T> c) {
  return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

}  // namespace tessera::core
