// SPDX-License-Identifier: Apache-2.0
#include "core/math/elementary.hpp"

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <random>

#include "core/math/bessel.hpp"
#include "core/math/simd_double.hpp"

namespace core = tessera::core;

TEST(Elementary, SineAndCosineAreAccurateOverTheirDomain) {
  for (int i = -1000000; i <= 1000000; i += 37) {
    const float x = static_cast<float>(i) * 0.01f;
    ASSERT_NEAR(core::sin(x), std::sin(static_cast<double>(x)), 1e-7) << x;
    ASSERT_NEAR(core::cos(x), std::cos(static_cast<double>(x)), 1e-7) << x;
  }
}

TEST(Elementary, SineAndCosineOfTurnsAreAccurate) {
  constexpr double kTwoPi = 6.28318530717958647692;
  for (int i = -100000; i <= 100000; ++i) {
    const float turns = static_cast<float>(i) * 1.37e-5f;
    const core::SinCos found = core::sin_cos_turns(turns);
    ASSERT_NEAR(found.sin, std::sin(kTwoPi * static_cast<double>(turns)), 1.5e-7) << turns;
    ASSERT_NEAR(found.cos, std::cos(kTwoPi * static_cast<double>(turns)), 1.5e-7) << turns;
  }
  for (int quarter = -4000000; quarter <= 4000000; quarter += 250001) {
    const core::SinCos found = core::sin_cos_turns(static_cast<float>(quarter) / 4);
    EXPECT_EQ(std::fabs(found.sin), quarter % 2 != 0 ? 1 : 0) << quarter;
    EXPECT_EQ(std::fabs(found.cos), quarter % 2 != 0 ? 0 : 1) << quarter;
  }
}

TEST(Elementary, ArcTangentIsAccurateInAllQuadrants) {
  std::mt19937 random(1);
  std::uniform_real_distribution<float> coordinate(-3, 3);
  for (int i = 0; i < 100000; ++i) {
    const float x = coordinate(random), y = coordinate(random);
    ASSERT_NEAR(core::atan2(y, x), std::atan2(static_cast<double>(y), static_cast<double>(x)), 5e-7)
        << y << " " << x;
  }
  EXPECT_EQ(core::atan2(0.0f, 0.0f), 0);
  EXPECT_FLOAT_EQ(core::atan2(0.0f, -1.0f), core::kPi);
  EXPECT_FLOAT_EQ(core::atan2(-1.0f, 0.0f), -core::kPi / 2);
  constexpr float kTiny = 0x1p-149f, kHuge = std::numeric_limits<float>::max();
  EXPECT_FLOAT_EQ(core::atan2(kTiny, kTiny), core::kPi / 4);
  EXPECT_FLOAT_EQ(core::atan2(kHuge, -kHuge), core::kPi * 3 / 4);
}

TEST(Elementary, ExponentialAndLogarithmAreAccurate) {
  for (double x = -700; x <= 700; x += 0.37) ASSERT_NEAR(core::exp(x) / std::exp(x), 1, 1e-13) << x;
  for (double x = 1e-300; x < 1e300; x *= 1.7)
    ASSERT_NEAR(core::log(x), std::log(x), 1e-13 * std::fabs(std::log(x)) + 1e-15) << x;
  EXPECT_EQ(core::exp(0), 1);
  for (double x = 0x1p-1074; x < 1e-300; x *= 3)
    ASSERT_NEAR(core::log(x), std::log(x), 1e-13 * std::fabs(std::log(x))) << x;
  for (int i = -10000; i <= 10000; ++i) {
    const double x = 1 + i * 0x1p-40;
    ASSERT_NEAR(core::log(x), std::log(x), 1e-15 * std::fabs(std::log(x))) << i;
  }
  EXPECT_EQ(core::log(1), 0);
  EXPECT_EQ(core::exp(-1000), 0);
  EXPECT_EQ(core::exp(1000), std::numeric_limits<double>::infinity());
}

TEST(Elementary, PowerIsAccurateAndKnowsItsEdges) {
  for (double base = 0.001; base < 10; base += 0.013)
    for (double exponent = -5; exponent < 5; exponent += 0.31)
      ASSERT_NEAR(core::pow(base, exponent) / std::pow(base, exponent), 1, 1e-13) << base << " " << exponent;
  EXPECT_EQ(core::pow(0, 2.4), 0);
  EXPECT_EQ(core::pow(0, 0), 1);
  EXPECT_EQ(core::pow(7, 0), 1);
  EXPECT_EQ(core::pow(0, -1), std::numeric_limits<double>::infinity());
}

// To the bit, over all that the functions distinguish.
TEST(Elementary, LanesAreWhatEachIsAlone) {
  std::mt19937_64 generator(2);
  const auto in = [&](double low, double high) {
    return std::uniform_real_distribution<double>(low, high)(generator);
  };
  for (int i = 0; i < 20000; ++i) {
    alignas(64) std::array<double, 8> x, positive, base, exponent;
    for (std::size_t lane = 0; lane < 8; ++lane) {
      x[lane] = i % 2 == 0 ? in(-2, 2) : in(-750, 750);
      positive[lane] = i % 2 == 0 ? in(0.4, 2.5) : std::ldexp(in(0.5, 1), static_cast<int>(in(-1070, 1020)));
      base[lane] = generator() % 16 == 0 ? 0 : in(0, 3);
      exponent[lane] = generator() % 16 == 0 ? 0 : in(-20, 200);
    }
    const auto all = [](const std::array<double, 8>& of) { return core::DoubleN::load(of.data()); };
    alignas(64) std::array<double, 8> exponentials, logarithms, powers, bessels;
    exp(all(x)).store(exponentials.data());
    log(all(positive)).store(logarithms.data());
    pow(all(base), all(exponent)).store(powers.data());
    core::scaled_bessel_i0(all(base) * 3).store(bessels.data());
    for (std::size_t lane = 0; lane < 8; ++lane) {
      ASSERT_EQ(exponentials[lane], core::exp(x[lane])) << x[lane];
      ASSERT_EQ(logarithms[lane], core::log(positive[lane])) << positive[lane];
      ASSERT_EQ(powers[lane], core::pow(base[lane], exponent[lane])) << base[lane] << ' ' << exponent[lane];
      ASSERT_EQ(bessels[lane], core::scaled_bessel_i0(base[lane] * 3)) << base[lane];
    }
  }
}
