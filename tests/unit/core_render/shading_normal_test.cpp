// Surfaces shaded with other normals than their own neither go black nor let light through.
#include "core/integrators/shading_normal.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "core/integrators/vertex.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core {
namespace {

constexpr Vec3 kSide{0, 0, 1};

Vec3 in_plane(float degrees) {
  const float angle = degrees / 180 * kPi;
  return {std::sin(angle), 0, std::cos(angle)};
}

TEST(SmoothTerminator, IsOneWithoutInterpolation) {
  for (const float degrees : {0.0f, 45.0f, 80.0f, 89.9f})
    EXPECT_EQ(smooth_terminator(kSide, kSide, in_plane(degrees)), 1);
}

TEST(SmoothTerminator, FallsSmoothlyToZeroAtTheTrueHorizon) {
  const Vec3 leaning = in_plane(20);
  EXPECT_EQ(smooth_terminator(leaning, kSide, in_plane(-30)), 1);
  EXPECT_EQ(smooth_terminator(leaning, kSide, in_plane(90.1f)), 0);
  float last = 1;
  for (float degrees = 0; degrees < 91; degrees += 0.25f) {
    const float factor = smooth_terminator(leaning, kSide, in_plane(degrees));
    EXPECT_LE(factor, last + 1e-6f);
    EXPECT_LT(last - factor, 0.03f) << degrees;
    last = factor;
  }
  // Chiang, Li and Burley 2019, worked out by hand: g = cos 60 / (cos 40 cos 20) = 0.6946.
  EXPECT_NEAR(smooth_terminator(leaning, kSide, in_plane(60)), 0.8420f, 1e-3f);
}

TEST(BendForReflection, KeepsTheMirrorDirectionAbove) {
  for (float lean = -80; lean <= 80; lean += 7)
    for (float view = -89; view <= 89; view += 3) {
      const Vec3 wo = in_plane(view), seen = bend_toward_viewer(in_plane(lean), wo);
      const Vec3 n = bend_for_reflection(seen, kSide, wo);
      ASSERT_NEAR(length(n), 1, 1e-4);
      EXPECT_GT(dot(n, wo), 0);
      EXPECT_GT(dot(n * (2 * dot(n, wo)) - wo, kSide), -1e-4f) << lean << ' ' << view;
    }
  const Vec3 slight = in_plane(5);
  EXPECT_EQ(bend_for_reflection(slight, kSide, in_plane(30)), slight);
}

// A triangle with normals that lean far, seen from all around.
Scene leaning_triangle(const MaterialModel& model) {
  test::SceneMaker maker({});
  maker.add(MeshDescription{.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
                            .normals = {{-0.7f, -0.7f, 1}, {1.5f, 0, 1}, {0, 1.5f, 1}},
                            .uvs = {},
                            .triangles = {{0, 1, 2}},
                            .triangle_materials = {maker.material(model)}});
  return maker.build();
}

class LeaningNormals : public testing::TestWithParam<MaterialModel> {};

TEST_P(LeaningNormals, KeepSamplesValuesAndDensitiesInStep) {
  const Scene scene = leaning_triangle(GetParam());
  int lit = 0, all = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto u = Sampler(7, i, 0, 0).pad(0), v = Sampler(7, i, 1, 0).pad(0);
    const Vec3 p{-0.9f + 1.5f * v[0], -0.9f + 1.5f * v[1], 0};
    const float phi = 2 * kPi * v[2], z = 2 * v[3] - 1;
    const Vec3 from = Vec3{std::sqrt(1 - z * z) * std::cos(phi), std::sqrt(1 - z * z) * std::sin(phi), z} * 3;
    const Ray ray{p + from, -from};
    const Hit hit = scene.bvh().closest_hit(scene.primitives(), ray);
    if (!hit.found()) continue;
    const PathVertex vertex(scene, ray, hit);
    const auto sample = vertex.sample({u[0], u[1]}, u[2]);
    ++all;
    if (!sample) continue;
    ++lit;
    ASSERT_TRUE(is_finite(sample->wi) && is_finite(sample->weight));
    const auto [value, pdf] = vertex.evaluate(sample->wi);
    ASSERT_NEAR(sample->pdf / pdf, 1, 0.01);
    ASSERT_NEAR(sample->weight.g * sample->pdf, value.g, 0.01f * value.g + 1e-5f);
    // Reflected light stays on the viewer's side of the true surface, and transmitted light leaves it.
    ASSERT_EQ(sample->eta != 1, (sample->wi.z > 0) != (vertex.wo().z > 0));
  }
  EXPECT_GT(lit, 0.7 * all) << "too many samples end below the surface";
}

INSTANTIATE_TEST_SUITE_P(Models, LeaningNormals,
                         testing::Values(MaterialModel{Lambert{}}, MaterialModel{Phong{}},
                                         MaterialModel{CookTorrance{.roughness = 0.4f}},
                                         MaterialModel{Glass{.roughness = 0.5f}}));

}  // namespace
}  // namespace tessera::core
