// SPDX-License-Identifier: Apache-2.0
// Rendered curves.
#include <gtest/gtest.h>

#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A bush of bent strands around the origin, also in an instance.
void add_bush(test::SceneMaker& maker, CurveShape shape, std::uint32_t material) {
  const auto random_direction = [](int i, int k) {
    const auto u = sampling::Sampler(3, i, k, 0).pad(0);
    return sampling::sample_sphere(Vec2{u[0], u[1]});
  };
  CurveStrands strands{CurveBasis::kBSpline, shape, {}, {0.06f}, {}, {}};
  for (int i = 0; i < 40; ++i) {
    Vec3 at{};
    const Vec3 along = 0.3f * random_direction(i, 0);
    for (int k = 0; k < 6; ++k, at = at + along + 0.1f * random_direction(i, k + 1))
      strands.points.push_back(at);
    strands.counts.push_back(6);
  }
  maker.add(CurvesDescription{strands, material});
  maker.description().objects = {{"bush", {CurvesDescription{strands, material}}, {}}};
  maker.add(InstanceDescription{0, translation({0.8f, 0.1f, -0.5f}), std::nullopt});
}

// In an even environment, white curves cannot be told from it, whatever light passes through them.
void expect_invisible(CurveShape shape, const MaterialModel& white) {
  test::SceneMaker maker({.position = {0, 0.5f, 3}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 45});
  add_bush(maker, shape, maker.material(white));
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  const test::Mean mean = test::mean_radiance(maker.build(), {.integrator = Integrator::kMis}, 100);
  EXPECT_NEAR(mean.value, 1, 5 * mean.standard_error + 1e-4);
  EXPECT_LT(mean.standard_error, test::kMaxNoise);
}

Hair white_hair() {
  Hair hair;
  hair.pigment = HairPigment::kAbsorption;
  hair.sigma_a.value = {};
  return hair;
}

TEST(RenderedCurves, OfHairAreInvisibleInAWhiteFurnace) {
  expect_invisible(CurveShape::kRound, white_hair());
  expect_invisible(CurveShape::kFlat, white_hair());
}

TEST(RenderedCurves, AreInvisibleInAWhiteFurnace) {
  expect_invisible(CurveShape::kRound, test::lambert(1));
  expect_invisible(CurveShape::kFlat, test::lambert(1));
}

TEST(RenderedCurves, HaveOpacity) {
  test::SceneMaker maker({.position = {0, 0.5f, 3}, .look_at = {0, 0, 0}, .vertical_fov_degrees = 5});
  const auto material = maker.material(test::lambert(0));
  maker.description().materials[material].opacity = 0.25f;
  // Wider than the image: each camera ray meets one curve.
  maker.add(CurvesDescription{
      {CurveBasis::kLinear, CurveShape::kRound, {{-3, 0, 0}, {3, 0, 0}}, {1}, {2}, {}}, material});
  maker.description().environment = EnvironmentDescription{{Rgb::gray(1)}};
  test::expect_radiance(maker.build(), 0.75, 200);
}

}  // namespace
}  // namespace tessera::core::integrators
