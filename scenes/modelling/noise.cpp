// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/noise.hpp"

#include <cmath>

#include "core/sampling/hash.hpp"

namespace tessera::modelling {

using core::Vec3;

namespace {

std::uint64_t hash_at(std::int32_t a, std::int32_t b, std::int32_t c) {
  const auto bits = [](std::int32_t v) { return std::uint64_t{static_cast<std::uint32_t>(v)}; };
  return core::sampling::hash(bits(a), core::sampling::hash(bits(b), bits(c)));
}

struct Lattice {
  std::int32_t x, y, z;
  Vec3 offset;  // of p from (x, y, z), in [0, 1)
};

Lattice lattice_cell(Vec3 p) {
  const Vec3 base{std::floor(p.x), std::floor(p.y), std::floor(p.z)};
  return {static_cast<std::int32_t>(base.x), static_cast<std::int32_t>(base.y),
          static_cast<std::int32_t>(base.z), p - base};
}

// The dot product of `d` with one of the twelve directions to the edges of a cube.
float gradient_dot(std::uint64_t hash_value, Vec3 d) {
  const float first = hash_value & 1 ? -1.0f : 1.0f, second = hash_value & 2 ? -1.0f : 1.0f;
  switch ((hash_value >> 2) % 3) {
    case 0:
      return first * d.x + second * d.y;
    case 1:
      return first * d.y + second * d.z;
    default:
      return first * d.z + second * d.x;
  }
}

// A point in the unit cube and a number, each in steps of 1 / 65536.
struct RandomPoint {
  Vec3 position;
  float random;
};

RandomPoint random_point(std::int32_t x, std::int32_t y, std::int32_t z) {
  const std::uint64_t bits = hash_at(x, y, z);
  const auto part = [bits](int i) { return static_cast<float>(bits >> (16 * i) & 0xffff) * 0x1p-16f; };
  return {{part(0), part(1), part(2)}, part(3)};
}

float fade(float t) {
  return t * t * t * (t * (t * 6 - 15) + 10);
}
float mix_linearly(float a, float b, float t) {
  return a + t * (b - a);
}

}  // namespace

float random_at(std::int32_t a, std::int32_t b, std::int32_t c) {
  return core::sampling::unit_float(static_cast<std::uint32_t>(hash_at(a, b, c) >> 32));
}

float noise(Vec3 p) {
  const Lattice cell = lattice_cell(p);
  const auto corner = [&cell](int i, int j, int k) {
    const Vec3 to_corner{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
    return gradient_dot(hash_at(cell.x + i, cell.y + j, cell.z + k), cell.offset - to_corner);
  };
  const float u = fade(cell.offset.x), v = fade(cell.offset.y), w = fade(cell.offset.z);
  const auto along_x = [&](int j, int k) { return mix_linearly(corner(0, j, k), corner(1, j, k), u); };
  const auto along_y = [&](int k) { return mix_linearly(along_x(0, k), along_x(1, k), v); };
  return mix_linearly(along_y(0), along_y(1), w);
}

float fractal_noise(Vec3 p, int octaves) {
  float sum = 0, weight = 1;
  for (int i = 0; i < octaves; ++i) {
    sum += weight * noise(p);
    p = p * 2 + Vec3{17.1f, 31.7f, 47.3f};
    weight *= 0.5f;
  }
  return sum;
}

Cell cellular_noise(Vec3 p) {
  const Lattice cell = lattice_cell(p);
  Cell found{10, 0};
  const auto visit = [&](int i, int j, int k) {
    const RandomPoint point = random_point(cell.x + i, cell.y + j, cell.z + k);
    const Vec3 corner{static_cast<float>(i), static_cast<float>(j), static_cast<float>(k)};
    const float distance = length(corner + point.position - cell.offset);
    if (distance < found.nearest) found = {distance, point.random};
  };
  for (int k = -1; k <= 1; ++k) {
    for (int j = -1; j <= 1; ++j) {
      for (int i = -1; i <= 1; ++i) visit(i, j, k);
    }
  }
  return found;
}

}  // namespace tessera::modelling
