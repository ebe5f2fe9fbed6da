// SPDX-License-Identifier: Apache-2.0
// The lanes of a vector as an array, to set or read individually.
#pragma once

#include <array>
#include <cstddef>

#include "core/math/rgb.hpp"
#include "core/math/simd_integer.hpp"
#include "core/math/vec3.hpp"

namespace tessera::core {

class FloatLanes {
 public:
  FloatLanes() = default;
  explicit FloatLanes(FloatN a) { a.store(values_); }
  float operator[](std::size_t lane) const { return values_[lane]; }
  void set(std::size_t lane, float value) { values_[lane] = value; }
  FloatN all() const { return FloatN::load(values_); }

 private:
  alignas(32) float values_[kLaneCount];
};

class WordLanes {
 public:
  WordLanes() = default;
  explicit WordLanes(U32xN a) { a.store(values_); }
  std::uint32_t operator[](std::size_t lane) const { return values_[lane]; }
  void set(std::size_t lane, std::uint32_t value) { values_[lane] = value; }
  U32xN all() const { return U32xN::load(values_); }

 private:
  alignas(32) std::uint32_t values_[kLaneCount];
};

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
