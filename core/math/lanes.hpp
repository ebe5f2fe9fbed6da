// What formulae need that are written once for one number and for eight at a time (core/math/simd.hpp): types
// that belong together, and choices without a branch. T is float or Float8.
#pragma once

namespace tessera::core {

// MaskOf<T> is what comparisons of T answer, WideOf<T> the same lanes in double precision. kLanes<T> is how
// many there are.
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
constexpr float select(bool mask, float a, float b) {
  return mask ? a : b;
}
constexpr double select(bool mask, double a, double b) {
  return mask ? a : b;
}

constexpr double widened(float x) {
  return static_cast<double>(x);
}
constexpr float rounded(double x) {
  return static_cast<float>(x);
}

}  // namespace tessera::core
