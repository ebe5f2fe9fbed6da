// SPDX-License-Identifier: Apache-2.0
// Sixteen lanes compute what each would alone. Compiled for AVX-512.
#include "core/math/simd_avx512.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <random>

namespace tessera::core {
namespace {

constexpr std::size_t kCount = 16;
constexpr float kInfinity = std::numeric_limits<float>::infinity();
using Floats = std::array<float, kCount>;

struct alignas(64) Pair {
  Floats a, b;
};

// Numbers of all sizes and both signs, some of them alike.
Pair numbers(std::mt19937& generator) {
  std::uniform_real_distribution<float> mantissa(-1, 1);
  std::uniform_int_distribution<int> exponent(-30, 30);
  Pair pair;
  for (std::size_t i = 0; i < kCount; ++i) {
    pair.a[i] = std::ldexp(mantissa(generator), exponent(generator));
    pair.b[i] = i % 5 == 0   ? pair.a[i]
                : i % 5 == 1 ? -pair.a[i]
                             : std::ldexp(mantissa(generator), exponent(generator));
  }
  return pair;
}

FloatVector lanes(const Floats& values) {
  return FloatVector::load(values.data());
}

void expect_bits(FloatVector all, std::size_t lane, float expected) {
  alignas(64) Floats values;
  all.store(values.data());
  ASSERT_EQ(as_bits(values[lane]), as_bits(expected)) << lane;
}

bool has(MaskVector mask, std::size_t lane) {
  return (mask.bits() >> lane & 1) != 0;
}

TEST(FloatVector, ComputesLaneByLane) {
  std::mt19937 generator(1);
  for (int round = 0; round < 200; ++round) {
    const Pair pair = numbers(generator);
    const FloatVector a = lanes(pair.a), b = lanes(pair.b);
    for (std::size_t i = 0; i < kCount; ++i) {
      const float x = pair.a[i], y = pair.b[i];
      expect_bits(a + b, i, x + y);
      expect_bits(a - b, i, x - y);
      expect_bits(-a, i, -x);
      expect_bits(a * b, i, x * y);
      expect_bits(a / b, i, x / y);
      expect_bits(max(a, b), i, x > y ? x : y);
      expect_bits(min(a, b), i, x < y ? x : y);
      expect_bits(fabs(a), i, std::fabs(x));
      expect_bits(max_magnitude(a, b), i, std::max(std::fabs(x), std::fabs(y)));
      expect_bits(multiply_add(a, b, a), i, std::fma(x, y, x));
      expect_bits(multiply_subtract(a, b, a), i, std::fma(x, y, -x));
      expect_bits(negative_multiply_add(a, b, a), i, std::fma(-x, y, x));
      expect_bits(select(a < b, a, b), i, x < y ? x : y);
      expect_bits(as_float(as_bits(a) + 1u), i, as_float(as_bits(x) + 1u));
      ASSERT_EQ(has(a < b, i), x < y);
      ASSERT_EQ(has(a <= b, i), x <= y);
      ASSERT_EQ(has(a > b, i), x > y);
      ASSERT_EQ(has(a >= b, i), x >= y);
      ASSERT_EQ(has(a == b, i), x == y);
      ASSERT_EQ(has(signbit(a), i), std::signbit(x));
    }
    ASSERT_EQ(least(a), *std::min_element(pair.a.begin(), pair.a.end()));
  }
}

TEST(FloatVector, IsTheSecondNumberWhereTheFirstIsNone) {
  const FloatVector nan(std::numeric_limits<float>::quiet_NaN()), one(1), infinity(kInfinity);
  expect_bits(max(nan, one), 3, 1);
  expect_bits(min(nan, one), 3, 1);
  expect_bits(max(one, infinity), 3, kInfinity);
  for (const MaskVector told : {nan<one, nan <= one, nan> one, nan >= one, nan == nan})
    EXPECT_FALSE(any(told));
  EXPECT_TRUE(all(!(nan < one)));
}

TEST(DoubleVector, ComputesLaneByLane) {
  std::mt19937 generator(2);
  alignas(64) std::array<double, kCount> values;
  for (int round = 0; round < 200; ++round) {
    const Pair pair = numbers(generator);
    const DoubleVector a = widened(lanes(pair.a)), b = widened(lanes(pair.b));
    const auto expect = [&](DoubleVector all, const auto& of_one) {
      all.store(values.data());
      for (std::size_t i = 0; i < kCount; ++i)
        ASSERT_EQ(values[i], of_one(double{pair.a[i]}, double{pair.b[i]})) << i;
    };
    expect(a + b, [](double x, double y) { return x + y; });
    expect(a - b, [](double x, double y) { return x - y; });
    expect(-a, [](double x, double) { return -x; });
    expect(a * b, [](double x, double y) { return x * y; });
    expect(a / b, [](double x, double y) { return x / y; });
    expect(fabs(a), [](double x, double) { return std::fabs(x); });
    expect(sqrt(fabs(a)), [](double x, double) { return std::sqrt(std::fabs(x)); });
    expect(copysign(a, b), [](double x, double y) { return std::copysign(x, y); });
    expect(select(a < b, a, b), [](double x, double y) { return x < y ? x : y; });
    for (std::size_t i = 0; i < kCount; ++i) {
      const double x = pair.a[i], y = pair.b[i];
      expect_bits(to_float(a / b), i, static_cast<float>(x / y));
      ASSERT_EQ(has(a > b, i), x > y);
      ASSERT_EQ(has(a >= b, i), x >= y);
    }
  }
}

TEST(DoubleN, ComparesAndChoosesLaneByLane) {
  std::mt19937 generator(3);
  alignas(64) std::array<double, 8> values;
  for (int round = 0; round < 200; ++round) {
    const Pair pair = numbers(generator);
    const DoubleN a = DoubleN::of([&](std::size_t i) { return pair.a[i]; });
    const DoubleN b = DoubleN::of([&](std::size_t i) { return double{pair.b[i]}; });
    const unsigned odd = 0xaau;
    select(odd, a, b).store(values.data());
    for (std::size_t i = 0; i < 8; ++i) ASSERT_EQ(values[i], double{i % 2 == 1 ? pair.a[i] : pair.b[i]});
    select(a < b, a, b).store(values.data());
    for (std::size_t i = 0; i < 8; ++i) ASSERT_EQ(values[i], double{std::min(pair.a[i], pair.b[i])});
    for (std::size_t i = 0; i < 8; ++i) ASSERT_EQ((a >= b).bits() >> i & 1, pair.a[i] >= pair.b[i] ? 1u : 0u);
  }
}

}  // namespace
}  // namespace tessera::core
