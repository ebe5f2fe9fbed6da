// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/caustic_guide.hpp"

#include <gtest/gtest.h>

#include <bit>
#include <utility>
#include <variant>
#include <vector>

#include "core/integrators/render.hpp"
#include "tests/support/test_scenes.hpp"

namespace tessera::core::integrators {
namespace {

const RenderSettings kMis{.integrator = Integrator::kMis};

// The same room without its mirror and glass.
SceneDescription matt_room() {
  SceneDescription room = test::room();
  for (Material& material : room.materials)
    if (!std::holds_alternative<Lambert>(material.model)) material.model = Lambert{};
  return room;
}

float pdf_of(const guiding::LightGuide& guide, const guiding::LightGuide::GuidanceOf<float>& guidance,
             Vec3 wi) {
  return guide.sample_or(guidance, false, {}, wi).pdf;
}

std::vector<guiding::Photon> photons_of(const Scene& scene, int threads) {
  const lights::LightSampler lights(scene.lights(), lights::LightSampler::Among::kAll, threads);
  return trace_caustic_photons(scene, lights, threads);
}

TEST(CausticGuide, IsTheSameForAnyNumberOfThreads) {
  const Scene a = Scene::build(test::room(), 1).value(), b = Scene::build(test::room(), 1).value();
  const RenderPlan plan_a = prepare(a, kMis, 1), plan_b = prepare(b, kMis, 3);
  const guiding::LightGuide *one = plan_a.guide(), *three = plan_b.guide();
  ASSERT_TRUE(one && three);
  ASSERT_EQ(one->cells().size(), three->cells().size());
  for (std::size_t i = 0; i < one->cells().size(); ++i) {
    const guiding::LightGuide::Cell &p = one->cells()[i], &q = three->cells()[i];
    EXPECT_EQ(p.box, q.box);
    EXPECT_EQ(std::bit_cast<std::uint32_t>(p.share), std::bit_cast<std::uint32_t>(q.share));
    const auto at_p = one->at(p.center, {0, 1, 0}), at_q = three->at(q.center, {0, 1, 0});
    ASSERT_EQ(at_p.share, at_q.share);
    if (at_p.share == 0) continue;  // the cell is on a wall
    for (const Vec3 d : {Vec3{0, 1, 0}, normalize({1, 2, 3}), normalize({-3, 1, -2})})
      EXPECT_EQ(pdf_of(*one, at_p, d), pdf_of(*three, at_q, d));
  }
}

TEST(CausticGuide, OffersNothingWhereThereAreNoCausticsOrItIsNotWanted) {
  const Scene matt = Scene::build(matt_room(), 1).value(), room = Scene::build(test::room(), 1).value();
  EXPECT_EQ(prepare(matt, kMis, 1).guide(), nullptr);
  EXPECT_EQ(prepare(room, {.integrator = Integrator::kNaive}, 1).guide(), nullptr);
  EXPECT_EQ(prepare(room, {.integrator = Integrator::kWhitted}, 1).guide(), nullptr);
  EXPECT_NE(prepare(room, kMis, 1).guide(), nullptr);
  EXPECT_NE(prepare(room, {.integrator = Integrator::kNee}, 1).guide(), nullptr);
}

// Beneath the glass sphere, whose middle is at (0.45, 0.35, 0.2), light comes through it.
TEST(CausticGuide, PointsAtTheGlassFromItsCaustic) {
  const Scene room = Scene::build(test::room(), 1).value();
  const RenderPlan plan = prepare(room, kMis, 1);
  const guiding::LightGuide* guide = plan.guide();
  ASSERT_NE(guide, nullptr);
  const Vec3 place{0.545f, 0, 0.243f};
  const auto guidance = guide->at(place, Vec3{0, 1, 0});
  EXPECT_GT(guidance.share, 0.3f);
  EXPECT_GT(pdf_of(*guide, guidance, normalize({-0.2f, 1, -0.1f})),
            5 * pdf_of(*guide, guidance, normalize({1, 0.3f, 1})));
}

TEST(CausticGuide, PhotonsAreFiniteAndOnMattSurfaces) {
  const Scene room = Scene::build(test::room(), 1).value();
  const auto photons = photons_of(room, 2);
  EXPECT_GT(photons.size(), 1000u);
  for (const guiding::Photon& photon : photons) {
    ASSERT_TRUE(is_finite(photon.position) && is_finite(photon.wi));
    ASSERT_GT(photon.flux, 0);
    ASSERT_GT(photon.distance, 0);
    ASSERT_GE(dot(photon.wi, photon.side_normal), 0);
    ASSERT_GT(length(photon.position - Vec3{0.45f, 0.35f, 0.2f}), 0.35f) << "on the glass";
  }
}

double flux_of_photons(const SceneDescription& description) {
  double flux = 0;
  for (const guiding::Photon& photon : photons_of(Scene::build(description, 1).value(), 1))
    flux += static_cast<double>(photon.flux);
  return flux;
}

TEST(CausticGuide, InstancesCastTheCausticsOfWhatTheyShow) {
  const double expected = flux_of_photons(test::room());
  SceneDescription room = test::room();
  room.objects = {{"room", std::move(room.shapes), {}}};
  room.shapes = {
      InstanceDescription{0, compose(translation({5, 1, 0}), rotation({1, 2, 3}, 50)), std::nullopt}};
  EXPECT_NEAR(flux_of_photons(room), expected, 0.03 * expected);
}

// Beside an object of glass only, of which an instance shows mirrors.
TEST(CausticGuide, TheMaterialOfAnInstanceDecides) {
  SceneDescription room = test::room();
  const double expected = flux_of_photons(room);
  ShapeDescription& mirror = room.shapes[6];
  const ShapeDescription ball = std::exchange(mirror, SphereDescription{{-0.5f, 50, -0.4f}, 0.1f, 0});
  room.objects = {{"ball", {ball}, {}}};
  room.shapes.push_back(InstanceDescription{0, {}, 0u});
  EXPECT_LT(flux_of_photons(room), 0.9 * expected) << "a white ball";
  room.shapes.back() = InstanceDescription{0, {}, std::nullopt};
  EXPECT_NEAR(flux_of_photons(room), expected, 0.03 * expected) << "the mirror ball";
}

// Mirrors that lie and that stand, whose areas grow by different factors.
TEST(CausticGuide, UnevenlyScaledInstancesCastAsMuchLight) {
  const Transform stretched = scaling({2, 0.5f, 1});
  const auto mirrors = [](const Transform& place, std::uint32_t material) {
    MeshDescription mesh{.positions = {{0, 0, 0}, {1, 0, 0}, {1, 0, 1}, {0, 0, 1}, {0, 2, 0}, {0, 2, 1}},
                         .normals = {},
                         .uvs = {},
                         .triangles = {{0, 2, 1}, {0, 3, 2}, {0, 4, 5}, {0, 5, 3}},
                         .triangle_materials = {material}};
    for (Vec3& position : mesh.positions) position = place.point(position);
    return mesh;
  };
  test::SceneMaker maker({.position = {3, 2, 3}, .look_at = {}});
  const auto mirror = maker.material(Mirror{});
  maker.add(QuadDescription{{-5, -0.1f, 5}, {10, 0, 0}, {0, 0, -10}, maker.material(test::lambert(0.5f))});
  maker.add(QuadDescription{{-5, 6, 5}, {0, 0, -10}, {10, 0, 0}, maker.material(test::lambert(0.5f))});
  maker.add(SphereDescription{{3, 3, 2}, 0.3f, maker.material(test::lambert(0), {9, 9, 9})});
  SceneDescription plain = maker.description(), instanced = maker.description();
  plain.shapes.push_back(mirrors(stretched, mirror));
  instanced.objects = {{"mirrors", {mirrors({}, mirror)}, {}}};
  instanced.shapes.push_back(InstanceDescription{0, stretched, std::nullopt});
  const double expected = flux_of_photons(plain);
  EXPECT_GT(expected, 0);
  EXPECT_NEAR(flux_of_photons(instanced), expected, 0.02 * expected);
}

}  // namespace
}  // namespace tessera::core::integrators
