// SPDX-License-Identifier: Apache-2.0
#include "core/sampling/sobol.hpp"

namespace tessera::core::sampling {
namespace {

using Point = std::array<std::uint32_t, kSobolDimensions>;

// A primitive polynomial of degree s with inner coefficients a, and the first s direction numbers m
// (Joe and Kuo 2008, new-joe-kuo-6, dimensions 2 to 4).
struct Polynomial {
  int s;
  std::uint32_t a;
  std::array<std::uint32_t, 3> m;
};
constexpr std::array<Polynomial, kSobolDimensions - 1> kPolynomials{
    {{1, 0, {1}}, {2, 1, {1, 3}}, {3, 1, {1, 3, 1}}}};

// Direction numbers v_1 ... v_32 by the recurrence of Bratley and Fox 1988.
constexpr std::array<std::uint32_t, 32> direction_numbers(const Polynomial& p) {
  std::array<std::uint32_t, 32> v{};
  for (int i = 0; i < 32; ++i) {
    const auto at = static_cast<std::size_t>(i);
    if (i < p.s) {
      v[at] = p.m[at] << (31 - i);
      continue;
    }
    const std::uint32_t back = v[at - static_cast<std::size_t>(p.s)];
    v[at] = back ^ (back >> p.s);
    for (int k = 1; k < p.s; ++k)
      if ((p.a >> (p.s - 1 - k)) & 1) v[at] ^= v[at - static_cast<std::size_t>(k)];
  }
  return v;
}

// Bit-reversed direction numbers of all dimensions, by index bit. Dimension 0 is van der Corput's sequence.
constexpr std::array<Point, 32> kDirections = [] {
  std::array<Point, 32> directions{};
  for (std::size_t bit = 0; bit < 32; ++bit) directions[bit][0] = 1u << bit;
  for (std::size_t d = 1; d < kSobolDimensions; ++d) {
    const auto v = direction_numbers(kPolynomials[d - 1]);
    for (std::size_t bit = 0; bit < 32; ++bit) directions[bit][d] = reverse_bits(v[bit]);
  }
  return directions;
}();

constexpr Point add_modulo_two(Point a, const Point& b) {
  for (std::size_t d = 0; d < kSobolDimensions; ++d) a[d] ^= b[d];
  return a;
}

// The contribution of each value of each byte of the index: four table lookups replace 32 conditional
// additions.
using ByteTable = std::array<std::array<Point, 256>, 4>;
constexpr ByteTable kByteTable = [] {
  ByteTable table{};
  for (std::size_t byte = 0; byte < 4; ++byte) {
    for (std::size_t bit = 0; bit < 8; ++bit) {
      const std::size_t step = std::size_t{1} << bit;
      for (std::size_t v = 0; v < step; ++v)
        table[byte][v + step] = add_modulo_two(table[byte][v], kDirections[byte * 8 + bit]);
    }
  }
  return table;
}();

// Inlined, because points in lanes would otherwise pass through memory.
[[gnu::always_inline]] inline Point point_of(std::uint32_t index) {
  const Point low = add_modulo_two(kByteTable[0][index & 255], kByteTable[1][(index >> 8) & 255]);
  const Point high = add_modulo_two(kByteTable[2][(index >> 16) & 255], kByteTable[3][index >> 24]);
  return add_modulo_two(low, high);
}

}  // namespace

std::array<std::uint32_t, kSobolDimensions> sobol_reversed(std::uint32_t index) {
  return point_of(index);
}

std::array<U32xN, kSobolDimensions> sobol_reversed(U32xN index) {
  std::array<std::uint32_t, 8> indices;
  index.store(indices.data());
  std::array<Point, 8> points;
  for (std::size_t lane = 0; lane < 8; ++lane) points[lane] = point_of(indices[lane]);
  return transpose(points);
}

}  // namespace tessera::core::sampling
