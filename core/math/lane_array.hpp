// SPDX-License-Identifier: Apache-2.0
// The lanes of a vector as an array, to set or read individually.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>

#include "core/math/rgb.hpp"
#include "core/math/simd_double.hpp"
#include "core/math/simd_integer.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

// The vector of such numbers.
FloatN vector_of(float);
U32xN vector_of(std::uint32_t);
DoubleN vector_of(double);

// The same types for every instruction set, unlike DoubleN.
template <typename Number>
class LaneArray {
 public:
  using Vector = decltype(vector_of(Number()));

  LaneArray() = default;
  explicit LaneArray(Vector a) { a.store(values_); }
  Number operator[](std::size_t lane) const { return values_[lane]; }
  void set(std::size_t lane, Number value) { values_[lane] = value; }
  Vector all() const { return Vector::load(values_); }

 private:
  alignas(kLaneCount * sizeof(Number)) Number values_[kLaneCount];
};
using FloatLanes = LaneArray<float>;
using WordLanes = LaneArray<std::uint32_t>;
using DoubleLanes = LaneArray<double>;

// f of the numbers in each lane, for functions that have no vector form.
template <typename F, typename... Floats>
FloatN in_each_lane(const F& f, FloatN first, Floats... others) {
  FloatLanes results;
  [&](const FloatLanes& a, const auto&... more) {
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) results.set(lane, f(a[lane], more[lane]...));
  }(FloatLanes(first), FloatLanes(others)...);
  return results.all();
}
template <typename F, typename... Floats>
float in_each_lane(const F& f, float first, Floats... others) {
  return f(first, others...);
}

class Vec3Lanes {
 public:
  Vec3Lanes() = default;
  explicit Vec3Lanes(Vec3Of<FloatN> a) : x_(a.x), y_(a.y), z_(a.z) {}
  Vec3 operator[](std::size_t lane) const { return {x_[lane], y_[lane], z_[lane]}; }
  void set(std::size_t lane, Vec3 v) { x_.set(lane, v.x), y_.set(lane, v.y), z_.set(lane, v.z); }
  Vec3Of<FloatN> all() const { return {x_.all(), y_.all(), z_.all()}; }

 private:
  FloatLanes x_, y_, z_;
};

class RgbLanes {
 public:
  RgbLanes() = default;
  explicit RgbLanes(RgbOf<FloatN> a) : r_(a.r), g_(a.g), b_(a.b) {}
  Rgb operator[](std::size_t lane) const { return {r_[lane], g_[lane], b_[lane]}; }
  void set(std::size_t lane, Rgb c) { r_.set(lane, c.r), g_.set(lane, c.g), b_.set(lane, c.b); }
  RgbOf<FloatN> all() const { return {r_.all(), g_.all(), b_.all()}; }

 private:
  FloatLanes r_, g_, b_;
};

}  // namespace tessera::core
