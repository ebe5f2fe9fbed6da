// SPDX-License-Identifier: Apache-2.0
// Gradient noise in space and its sums over octaves. Stateless; thread-safe. T is float or FloatN; each lane
// has the bits of the scalar.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>

#include "core/math/lanes.hpp"
#include "core/math/vec3.hpp"
#include "core/math/word_lanes.hpp"

namespace tessera::core {

// The permutation of Perlin 2002, as floats; twice, so that sums of two entries need no wrapping.
extern const std::array<float, 512> kNoisePermutation;

// Each octave has this frequency relative to the one before (Pharr et al. 2023, section 10.3).
inline constexpr float kLacunarity = 1.99f;

// A coordinate as a cell of the noise, modulo 256, and the place in it.
template <typename T>
struct NoiseCell {
  explicit NoiseCell(T x) {
    using std::floor;
    const T whole = floor(x), wrapped = whole - floor(whole * (1.0f / 256)) * 256.0f;
    const MaskOf<T> is_valid = (wrapped >= 0.0f) & (wrapped < 256.0f);  // not of infinity and NaN
    index = select(is_valid, wrapped, T(0.0f));
    offset = x - whole;
  }

  T index, offset;
};

namespace noise_detail {

template <typename T>
T permuted(T index) {
  return look_up(kNoisePermutation.data(), to_word(index));
}

// The product of the offset with the gradient of a lattice point (Perlin 2002, with the last four gradients
// in the order of pbrt).
template <typename T>
T gradient_product(T x, T y, T z, T dx, T dy, T dz) {
  using Word = WordOf<T>;
  const Word hash = to_word(permuted(permuted(permuted(x) + y) + z)) & Word(15);
  const auto is_any_of = [&](std::uint32_t a, std::uint32_t b) {
    return (hash == Word(a)) | (hash == Word(b));
  };
  const MaskOf<T> is_edge = is_any_of(12, 13);
  const T u = select(((hash & Word(8)) == Word(0)) | is_edge, dx, dy);
  const T v = select(((hash & Word(12)) == Word(0)) | is_edge, dy, dz);
  return select((hash & Word(1)) == Word(0), u, -u) + select((hash & Word(2)) == Word(0), v, -v);
}

template <typename T>
T fade(T t) {
  return t * t * t * (t * (t * 6.0f - 15.0f) + 10.0f);
}

template <typename T>
T between(T share, T a, T b) {
  return (1.0f - share) * a + share * b;
}

}  // namespace noise_detail

// Perlin's improved noise, about -1 to 1, 0 at whole coordinates; it repeats after 256.
template <typename T>
T perlin_noise(Vec3Of<T> p) {
  using namespace noise_detail;
  const NoiseCell<T> x(p.x), y(p.y), z(p.z);
  const auto corner = [&](float i, float j, float k) {
    return gradient_product<T>(x.index + i, y.index + j, z.index + k, x.offset - i, y.offset - j,
                               z.offset - k);
  };
  const T wx = fade(x.offset), wy = fade(y.offset), wz = fade(z.offset);
  const auto along_x = [&](float j, float k) { return between(wx, corner(0, j, k), corner(1, j, k)); };
  return between(wz, between(wy, along_x(0, 0), along_x(1, 0)), between(wy, along_x(0, 1), along_x(1, 1)));
}

// Fractional Brownian motion: octaves of noise, each `roughness` times as high as the one before.
template <typename T>
T fbm(Vec3Of<T> p, float roughness, int octaves) {
  T sum = 0.0f;
  float frequency = 1, height = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum = sum + perlin_noise<T>(p * T(frequency)) * height;
    frequency *= kLacunarity;
    height *= roughness;
  }
  return sum;
}

// The same of the absolute value of noise. 0.2, its mean, stands for the first octave that is left out, as in
// pbrt.
template <typename T>
T turbulence(Vec3Of<T> p, float roughness, int octaves) {
  using std::fabs;
  constexpr float kMeanOfNoise = 0.2f;
  T sum = 0.0f;
  float frequency = 1, height = 1;
  for (int octave = 0; octave < octaves; ++octave) {
    sum = sum + fabs(perlin_noise<T>(p * T(frequency))) * height;
    frequency *= kLacunarity;
    height *= roughness;
  }
  return sum + kMeanOfNoise * height;
}

}  // namespace tessera::core
