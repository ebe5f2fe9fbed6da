// SPDX-License-Identifier: Apache-2.0
// Surfaces shaded with other normals than their own neither go black nor let light through.
#include "core/integrators/shading_normal.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/integrators/vertex.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

constexpr Vec3 kToTheSide{0, 0, 1};

Vec3 in_plane(float degrees) {
  const float angle = degrees / 180 * kPi;
  return {std::sin(angle), 0, std::cos(angle)};
}

// Directions, evenly distributed over the sphere.
std::vector<Vec3> all_around() {
  constexpr int kRings = 200, kSectors = 400;
  std::vector<Vec3> directions;
  for (int ring = 0; ring < kRings; ++ring)
    for (int sector = 0; sector < kSectors; ++sector) {
      const float z = 2 * (static_cast<float>(ring) + 0.5f) / kRings - 1;
      const float phi = 2 * kPi * (static_cast<float>(sector) + 0.5f) / kSectors, r = std::sqrt(1 - z * z);
      directions.push_back({r * std::cos(phi), r * std::sin(phi), z});
    }
  return directions;
}

// The integral over the sphere of what `f` answers for each of them.
template <typename F>
double integral(const std::vector<Vec3>& directions, F f) {
  double sum = 0;
  for (const Vec3 w : directions) sum += static_cast<double>(f(w));
  return sum * 4 * static_cast<double>(kPi) / static_cast<double>(directions.size());
}

TEST(GrooveCos, IsTheCosineWithoutInterpolation) {
  for (const float degrees : {0.0f, 45.0f, 80.0f, 89.9f}) {
    const float cosine = in_plane(degrees).z;
    EXPECT_EQ(groove_cos(cosine, cosine, kToTheSide), cosine);
  }
}

TEST(GrooveCos, FallsToZeroAtBothHorizonsWithoutAStep) {
  const Vec3 side = in_plane(20);  // the geometric normal leans to the right of the shading normal
  float last = 0;
  for (float degrees = -90; degrees <= 90; degrees += 0.25f) {
    const Vec3 w = in_plane(degrees);
    const float now = std::max(0.0f, groove_cos(w.z, dot(w, side), side));
    EXPECT_LT(std::fabs(now - last), 0.01f) << degrees;
    EXPECT_LE(now, w.z + 1e-6f);
    last = now;
  }
  EXPECT_NEAR(last, 0, 1e-6f);
}

TEST(GrooveCos, IsMadeUpForByTheScale) {
  const std::vector<Vec3> directions = all_around();
  for (const float lean : {0.0f, 5.0f, 20.0f, 45.0f, 70.0f, 85.0f}) {
    const Vec3 side = in_plane(lean);
    const auto received = [&](Vec3 w) {
      const float cos_side = dot(w, side);
      return w.z > 0 && cos_side > 0 ? groove_cos(w.z, cos_side, side) : 0.0f;
    };
    EXPECT_NEAR(integral(directions, received) * static_cast<double>(diffuse_scale(side)),
                static_cast<double>(kPi), 0.01)
        << lean;
  }
}

TEST(BendForReflection, KeepsTheMirrorDirectionAbove) {
  for (float lean = -80; lean <= 80; lean += 7)
    for (float view = -89; view <= 89; view += 3) {
      const Vec3 wo = in_plane(view), seen = clamp_toward_viewer(in_plane(lean), wo);
      const Vec3 n = ensure_valid_reflection(seen, kToTheSide, wo);
      ASSERT_NEAR(length(n), 1, 1e-4);
      EXPECT_GT(dot(n, wo), 0);
      EXPECT_GT(dot(n * (2 * dot(n, wo)) - wo, kToTheSide), -1e-4f) << lean << ' ' << view;
    }
  const Vec3 slight = in_plane(5);
  EXPECT_EQ(ensure_valid_reflection(slight, kToTheSide, in_plane(30)), slight);
}

// A triangle with normals that lean far, seen from all around.
Scene leaning_triangle(const MaterialModel& model, ShadingNormals normals = ShadingNormals::kConserving) {
  test::SceneMaker maker({});
  maker.add(MeshDescription{.positions = {{-1, -1, 0}, {3, -1, 0}, {-1, 3, 0}},
                            .normals = {{-0.7f, -0.7f, 1}, {1.5f, 0, 1}, {0, 1.5f, 1}},
                            .uvs = {},
                            .triangles = {{0, 1, 2}},
                            .triangle_materials = {maker.material(model)}});
  maker.description().materials.front().shading_normals = normals;
  return maker.build();
}

class LeaningNormals : public testing::TestWithParam<MaterialModel> {};

TEST_P(LeaningNormals, KeepSamplesValuesAndDensitiesInStep) {
  const Scene scene = leaning_triangle(GetParam());
  int lit = 0, all = 0;
  for (int i = 0; i < 4000; ++i) {
    const auto u = sampling::Sampler(7, i, 0, 0).pad(0), v = sampling::Sampler(7, i, 1, 0).pad(0);
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
    // Reflected light stays on the viewer's side of the geometric surface, and transmitted light leaves it.
    ASSERT_EQ(sample->eta != 1, (sample->wi.z > 0) != (vertex.wo().z > 0));
  }
  EXPECT_GT(lit, 0.9 * all) << "too many samples end below the surface";
}

// Of the light that the BSDF of the shading normal scatters, none is lost at the geometric surface.
TEST_P(LeaningNormals, KeepTheEnergy) {
  const std::vector<Vec3> directions = all_around();
  const Scene scene = leaning_triangle(GetParam());
  const shading::Bsdf flat(scene.materials()[0], scene.textures(), {}, true);
  for (const Vec3 from : {Vec3{0, 0, 1}, {0.8f, 0, 0.6f}, {-0.8f, 0, 0.6f}, {0, 0.95f, 0.3f}}) {
    const Ray ray{Vec3{-0.5f, -0.6f, 0} + from, -from};
    const PathVertex vertex(scene, ray, scene.bvh().closest_hit(scene.primitives(), ray));
    const Vec3 normal = vertex.shading_normal();
    const float cos_o = dot(normal, vertex.wo());
    ASSERT_LT(dot(normal, vertex.side_normal()), 0.995f) << "the normal does not lean";
    const Vec3 wo_local{std::sqrt(1 - cos_o * cos_o), 0, cos_o};
    const auto folded = [&](Vec3 w) { return vertex.evaluate(w).value.g; };
    const auto unfolded = [&](Vec3 w) { return flat.evaluate(wo_local, w).value.g; };
    const double expected = integral(directions, unfolded);
    EXPECT_NEAR(integral(directions, folded), expected, 0.004 * expected + 0.001);
    EXPECT_NEAR(integral(directions, [&](Vec3 w) { return vertex.evaluate(w).pdf; }),
                integral(directions, [&](Vec3 w) { return flat.evaluate(wo_local, w).pdf; }), 0.01);
  }
}

INSTANTIATE_TEST_SUITE_P(Models, LeaningNormals,
                         testing::Values(MaterialModel{Lambert{}}, MaterialModel{Phong{}},
                                         MaterialModel{CookTorrance{.roughness = 0.4f}},
                                         MaterialModel{Glass{.roughness = 0.5f}}));

// Even light from above a surface arrives at a plain normal that is tilted by t with the share (1 + cos t) /
// 2: what comes from below the surface is lost.
TEST(PlainNormals, LoseTheLightFromBelowTheSurface) {
  const std::vector<Vec3> directions = all_around();
  const Scene scene = leaning_triangle(Lambert{{Rgb::gray(1)}}, ShadingNormals::kPlain);
  const Vec3 from{0.1f, 0.2f, 0.97f};
  const Ray ray{Vec3{-0.5f, -0.6f, 0} + from, -from};
  const PathVertex vertex(scene, ray, scene.bvh().closest_hit(scene.primitives(), ray));
  const double expected = (1 + static_cast<double>(dot(vertex.shading_normal(), vertex.side_normal()))) / 2;
  ASSERT_LT(expected, 0.99);
  EXPECT_NEAR(integral(directions, [&](Vec3 w) { return vertex.evaluate(w).value.g; }), expected, 2e-3);
  double sum = 0;
  constexpr int kSamples = 20000;
  for (int i = 0; i < kSamples; ++i) {
    const auto u = sampling::Sampler(7, i, 0, 0).pad(0);
    if (const auto sample = vertex.sample({u[0], u[1]}, u[2])) sum += static_cast<double>(sample->weight.g);
  }
  EXPECT_NEAR(sum / kSamples, expected, 5e-3);
}

}  // namespace
}  // namespace tessera::core::integrators
