// Linear radiometric colour with the primaries of Rec. 709: radiance, reflectance or throughput.
#pragma once

#include <cmath>

namespace tessera::core {

struct Rgb {
  float r = 0, g = 0, b = 0;

  static constexpr Rgb gray(float v) { return {v, v, v}; }

  float operator[](int channel) const { return channel == 0 ? r : channel == 1 ? g : b; }
  Rgb& operator+=(Rgb o) { return *this = {r + o.r, g + o.g, b + o.b}; }
  Rgb& operator*=(Rgb o) { return *this = {r * o.r, g * o.g, b * o.b}; }
  Rgb& operator*=(float s) { return *this = {r * s, g * s, b * s}; }
  bool operator==(const Rgb&) const = default;
};

inline Rgb operator+(Rgb a, Rgb b) {
  return {a.r + b.r, a.g + b.g, a.b + b.b};
}
inline Rgb operator-(Rgb a, Rgb b) {
  return {a.r - b.r, a.g - b.g, a.b - b.b};
}
inline Rgb operator*(Rgb a, Rgb b) {
  return {a.r * b.r, a.g * b.g, a.b * b.b};
}
inline Rgb operator*(Rgb a, float s) {
  return {a.r * s, a.g * s, a.b * s};
}
inline Rgb operator*(float s, Rgb a) {
  return a * s;
}
inline Rgb operator/(Rgb a, float s) {
  return {a.r / s, a.g / s, a.b / s};
}

inline bool is_black(Rgb c) {
  return c.r == 0 && c.g == 0 && c.b == 0;
}
inline bool is_finite(Rgb c) {
  return std::isfinite(c.r) && std::isfinite(c.g) && std::isfinite(c.b);
}
inline float max_component(Rgb c) {
  return c.r > c.g ? (c.r > c.b ? c.r : c.b) : (c.g > c.b ? c.g : c.b);
}

// What lights are weighed by when one is chosen: a blue lamp's noise is as large as a green one's.
inline float mean(Rgb c) {
  constexpr float kThird = 1.0f / 3;
  return c.r * kThird + c.g * kThird + c.b * kThird;
}

// Relative luminance (ITU-R BT.709-6, item 3.2).
inline float luminance(Rgb c) {
  return 0.2126f * c.r + 0.7152f * c.g + 0.0722f * c.b;
}

}  // namespace tessera::core
