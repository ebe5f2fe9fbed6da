// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

// Directions all over a hemisphere.
Vec3 above(int i) {
  const auto [u, other] = test::random_numbers(i);
  const float z = 0.05f + 0.95f * other, rho = std::sqrt(1 - z * z), phi = 2 * kPi * u.x;
  return {rho * std::cos(phi), rho * std::sin(phi), z};
}

// Layers attenuate each other for the viewer's direction alone, and are not reciprocal.
std::vector<test::BsdfCase> reciprocal_cases() {
  std::vector<test::BsdfCase> cases;
  for (const auto& one : test::bsdf_cases())
    if (!std::holds_alternative<Principled>(one.material.model)) cases.push_back(one);
  return cases;
}

class Reciprocity : public testing::TestWithParam<test::BsdfCase> {};

TEST_P(Reciprocity, OfReflection) {
  const shading::Bsdf bsdf = GetParam().bsdf();
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = above(2 * i), b = above(2 * i + 1);
    const float there = bsdf.evaluate(a, b).value.g / b.z, back = bsdf.evaluate(b, a).value.g / a.z;
    ASSERT_NEAR(there, back, 1e-3f * there + 1e-6f);
  }
}

// Radiance over the squared index of refraction is what is passed on alike both ways (Veach 1997,
// section 5.2).
class TransmissionReciprocity : public testing::TestWithParam<test::BsdfCase> {};

TEST_P(TransmissionReciprocity, ButForTheSquaredIndex) {
  const Glass& glass = std::get<Glass>(GetParam().material.model);
  const float eta = GetParam().outside ? glass.ior.value : 1 / glass.ior.value;
  const shading::Bsdf near(GetParam().material, {}, {}, GetParam().outside);
  const shading::Bsdf far(GetParam().material, {}, {}, !GetParam().outside);
  int lit = 0;
  for (int i = 0; i < 1000; ++i) {
    const Vec3 a = above(2 * i), b = above(2 * i + 1);
    // Seen from the far side, z points the other way.
    const float there = near.evaluate(a, {b.x, b.y, -b.z}).value.g / b.z;
    const float back = far.evaluate(b, {a.x, a.y, -a.z}).value.g / a.z;
    ASSERT_NEAR(there * eta * eta, back, 2e-3f * back + 5e-4f);
    lit += there > 0;
  }
  EXPECT_GT(lit, 100);
}

std::vector<test::BsdfCase> glass_cases() {
  std::vector<test::BsdfCase> cases;
  for (const auto& one : test::bsdf_cases())
    if (std::holds_alternative<Glass>(one.material.model)) cases.push_back(one);
  return cases;
}

INSTANTIATE_TEST_SUITE_P(All, TransmissionReciprocity, testing::ValuesIn(glass_cases()),
                         [](const auto& test_case) { return test_case.param.name; });
INSTANTIATE_TEST_SUITE_P(All, Reciprocity, testing::ValuesIn(reciprocal_cases()),
                         [](const auto& test_case) { return test_case.param.name; });

}  // namespace
}  // namespace tessera::core
