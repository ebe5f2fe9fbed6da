// SPDX-License-Identifier: Apache-2.0
// Surfaces coloured by procedural textures that depend on the normal, by every integrator.
#include <gtest/gtest.h>

#include <numbers>

#include "core/integrators/render.hpp"
#include "tests/support/mean_radiance.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

// A matt ball under even light of radiance 1, seen along z and filling its image from side to side. Its
// albedo is |n.z|, and so is its radiance, whose mean over the image is pi / 6.
Scene ball_of_its_normals() {
  test::SceneMaker maker(
      {.position = {0, 0, 4}, .look_at = {0, 0, 0}, .type = CameraType::kOrthographic, .view_height = 2});
  const auto matt = maker.material(test::lambert(1));
  maker.description().textures.push_back(
      {.image = nullptr,
       .procedural = ProceduralTexture{.pattern = FacingPattern{}, .space = PatternSpace::kNormal}});
  std::get<Lambert>(maker.description().materials[matt].model).albedo.texture = 0;
  maker.add(SphereDescription{{0, 0, 0}, 1, matt});
  maker.description().environment = {{Rgb::gray(1)}};
  maker.description().environment->visible_to_camera = false;
  return maker.build();
}

TEST(PatternSurfaces, HaveTheColoursOfTheirNormals) {
  const Scene scene = ball_of_its_normals();
  for (const Integrator integrator :
       {Integrator::kNaive, Integrator::kNee, Integrator::kMis, Integrator::kWhitted}) {
    const test::Mean mean = test::mean_radiance(scene, {.integrator = integrator}, 64, 32);
    EXPECT_NEAR(mean.value, std::numbers::pi / 6, 0.01) << static_cast<int>(integrator);
  }
}

}  // namespace
}  // namespace tessera::core::integrators
