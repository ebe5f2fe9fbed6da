// SPDX-License-Identifier: Apache-2.0
// Lamps that emit by procedural textures: light samples find what paths find.
#include <gtest/gtest.h>

#include <cmath>

#include "core/integrators/render.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A lamp over a floor. The cell of the pattern at the origin of both spaces is black.
Scene lit_by(PatternSpace space, float scale) {
  test::SceneMaker maker({.position = {0, 1.2f, 3}, .look_at = {0, 0.3f, 0}, .vertical_fov_degrees = 50});
  const auto floor = maker.material(test::lambert(0.6f)),
             lamp = maker.material(test::lambert(0), Rgb::gray(8));
  ProceduralTexture checkerboard{
      .pattern = CheckerboardPattern{.even = {Rgb::gray(0), -1}, .odd = {Rgb::gray(1), -1}}, .space = space};
  checkerboard.transform = scaling({scale, scale, scale});
  maker.description().textures.push_back({.image = nullptr, .procedural = checkerboard});
  maker.description().materials[lamp].emission.texture = 0;
  maker.add(QuadDescription{{-3, 0, 3}, {6, 0, 0}, {0, 0, -6}, floor});
  maker.add(QuadDescription{{-0.9f, 1.5f, -0.8f}, {1.9f, 0, 0}, {0, 0, 1.9f}, lamp});
  return maker.build();
}

void expect_mean_of_paths(const Scene& scene) {
  const auto mean_of = [&](Integrator integrator) {
    return test::mean_radiance(scene, {.integrator = integrator}, 256 / test::kEffortDivisor, 24);
  };
  const test::Mean paths = mean_of(Integrator::kNaive);
  ASSERT_GT(paths.value, 0);
  for (const Integrator integrator : {Integrator::kNee, Integrator::kMis}) {
    const test::Mean mean = mean_of(integrator);
    EXPECT_NEAR(mean.value, paths.value, 4 * std::hypot(mean.standard_error, paths.standard_error));
  }
}

TEST(PatternLights, InSpaceAreSampledWhereTheyShine) {
  expect_mean_of_paths(lit_by(PatternSpace::kPosition, 3));
}

TEST(PatternLights, ByTextureCoordinatesAreSampledWhereTheyShine) {
  expect_mean_of_paths(lit_by(PatternSpace::kUv, 4));
}

// Its mean is estimated where it is black.
TEST(PatternLights, ThatAreBlackAtPositiveCoordinatesShine) {
  expect_mean_of_paths(lit_by(PatternSpace::kPosition, 0.1f));
}

}  // namespace
}  // namespace tessera::core::integrators
