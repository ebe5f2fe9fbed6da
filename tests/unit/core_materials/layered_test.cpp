// SPDX-License-Identifier: Apache-2.0
// Layered materials: energy, closed forms of their parts, and delta lobes among others.
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <utility>
#include <vector>

#include "core/materials/directional_albedo.hpp"
#include "core/sampling/sampler.hpp"
#include "core/shading/microfacet_lobes.hpp"
#include "tests/unit/core_materials/bsdf_cases.hpp"

namespace tessera::core {
namespace {

Vec3 seen_at(float cos_o) {
  return {std::sqrt(1 - cos_o * cos_o), 0, cos_o};
}

// The light from everywhere that reaches wo. Refraction's compression of radiance is undone.
Rgb received(const shading::Bsdf& bsdf, Vec3 wo, int samples = 2048) {
  Rgb sum{};
  for (int i = 0; i < samples; ++i) {
    const auto u = sampling::Sampler(3, 0, 0, static_cast<std::uint32_t>(i)).pad(0);
    if (const auto s = bsdf.sample(wo, {u[0], u[1]}, u[2])) sum += s->weight * (s->eta * s->eta);
  }
  return sum / static_cast<float>(samples);
}

shading::Bsdf bsdf_of(const MaterialModel& model, bool outside = true) {
  return shading::Bsdf(test::material_of(model), {}, {}, outside);
}

Principled white(float roughness) {
  Principled model;
  model.base_color.value = Rgb::gray(1);
  model.specular_roughness = roughness;
  return model;
}

struct WhiteCase {
  std::string name;
  Principled model;
  bool outside = true;
};

std::vector<WhiteCase> white_cases(float roughness) {
  const Principled base = white(roughness);
  Principled metal = base, glass = base, coated = base, fuzzy = base, pane = base, rough_base = base,
             leaf = base;
  metal.base_metalness = 1;
  glass.transmission_weight = 1;
  coated.coat_weight = 1;
  coated.coat_roughness = roughness;
  fuzzy.fuzz_weight = 1;
  fuzzy.fuzz_roughness = roughness;
  pane.transmission_weight = 1;
  pane.geometry_thin_walled = true;
  leaf.subsurface_weight = 0.5f;
  leaf.subsurface_color = {Rgb::gray(1)};
  leaf.subsurface_scatter_anisotropy = 0.5f;
  leaf.geometry_thin_walled = true;
  rough_base.base_diffuse_roughness = 1;
  Principled all = coated;
  all.base_metalness = 0.4f;
  all.transmission_weight = 0.3f;
  all.fuzz_weight = 0.5f;
  return {{"glossy-diffuse", base}, {"metal", metal},   {"glass", glass}, {"glass inside", glass, false},
          {"coated", coated},       {"fuzzy", fuzzy},   {"pane", pane},   {"rough base", rough_base},
          {"leaf", leaf},           {"all layers", all}};
}

// Total reflection inside the roughest glass is beyond the tables' quadrature.
float furnace_tolerance(bool outside, float roughness) {
  return !outside && roughness > 0.7f ? 2e-2f : 5e-3f;
}

TEST(WhiteFurnace, PrincipledReflectsAllLight) {
  for (const float roughness : {0.0f, 0.05f, 0.25f, 0.5f, 0.75f, 1.0f})
    for (const auto& [name, model, outside] : white_cases(roughness))
      for (const float cos_o : {1.0f, 0.6f, 0.2f})
        EXPECT_NEAR(received(bsdf_of(model, outside), seen_at(cos_o)).g, 1,
                    furnace_tolerance(outside, roughness))
            << name << ", roughness " << roughness << ", cosine " << cos_o;
}

// What a leaning coat scatters below the plane of the base is mirrored.
TEST(WhiteFurnace, LeaningCoatsReflectAllLight) {
  for (const float roughness : {0.0f, 0.25f, 0.5f, 1.0f})
    for (const Vec3 wo : test::viewers()) {
      Principled model = white(0.4f);
      model.coat_weight = 1;
      model.coat_roughness = roughness;
      shading::Bsdf bsdf = bsdf_of(model);
      bsdf.turn_coat(true, test::leaning_frame(), wo);
      EXPECT_NEAR(received(bsdf, wo).g, 1, 5e-3f) << roughness << ' ' << wo.z;
    }
}

// Over nothing, between directions that are above both planes: as seen in the frame of the coat.
TEST(Coat, ThatLeansIsReciprocalAlone) {
  Principled model = white(0);
  model.base_color.value = {};
  model.specular_weight = 0;
  model.coat_weight = 1;
  model.coat_roughness = 0.3f;
  const Frame coat = test::leaning_frame();
  shading::Bsdf bsdf = bsdf_of(model);
  bsdf.turn_coat(true, coat, {});
  const shading::Bsdf level = bsdf_of(model);
  for (const Vec3 a : {seen_at(0.9f), seen_at(0.7f)})
    for (const Vec3 b : {Vec3{0, 0, 1}, normalize(Vec3{-0.5f, 0.3f, 1})}) {
      const float there = bsdf.evaluate(a, b).value.g / dot(b, coat.normal);
      EXPECT_NEAR(bsdf.evaluate(b, a).value.g / dot(a, coat.normal), there, 5e-3f * there);
      const Vec3 a_coat = coat.to_local(a), b_coat = coat.to_local(b);
      EXPECT_NEAR(level.evaluate(a_coat, b_coat).value.g / b_coat.z, there, 1e-3f * there);
    }
}

TEST(WhiteFurnace, SmoothPlasticReflectsAllLight) {
  for (const float ior : {1.1f, 1.5f, 2.4f})
    for (const float cos_o : {1.0f, 0.6f, 0.2f}) {
      const Plastic plastic{.diffuse = {Rgb::gray(1)}, .ior = ior, .nonlinear = true};
      EXPECT_NEAR(received(bsdf_of(plastic), seen_at(cos_o)).g, 1, 5e-3f) << ior << ' ' << cos_o;
    }
}

// The mean Fresnel reflectance of an index of 1.5 is 0.09178 from outside, and 0.59636 from inside.
// What is never thrown back leaves at once: rho T(wo) T(wi) / (pi eta^2).
TEST(Plastic, TheBoundaryNeedNotReflectInside) {
  Plastic plastic{.diffuse = {Rgb::gray(0.6f)}};
  plastic.internal_reflection = 0;
  const float head_on = 0.96f;
  EXPECT_NEAR(bsdf_of(plastic).evaluate({0, 0, 1}, {0, 0, 1}).value.g,
              0.6f * head_on * head_on / (kPi * 2.25f), 1e-6);
}

TEST(Plastic, HasTheReflectanceOfItsLayers) {
  constexpr float kOut = 1 - 0.09178f, kInside = 0.59636f, kDiffuse = 0.5f;
  Plastic plastic{.diffuse = {Rgb::gray(kDiffuse)}};
  const float linear = 0.04f + 0.96f * kDiffuse * kOut / (2.25f * (1 - kInside));
  EXPECT_NEAR(received(bsdf_of(plastic), seen_at(1)).g, linear, 2e-3f);
  plastic.nonlinear = true;
  const float nonlinear = 0.04f + 0.96f * kDiffuse * kOut / (2.25f * (1 - kDiffuse * kInside));
  EXPECT_NEAR(received(bsdf_of(plastic), seen_at(1)).g, nonlinear, 2e-3f);
}

TEST(ThinDielectric, ReflectsBetweenItsSides) {
  // A lamp's pane: others scatter only what they reflect (interception_at).
  Material lamp = test::material_of(ThinDielectric{});
  lamp.emission.value = Rgb::gray(1);
  const shading::Bsdf pane(lamp, {}, {}, true);
  const auto branches = pane.delta_branches(seen_at(1));
  ASSERT_TRUE(branches[0] && branches[1]);
  EXPECT_NEAR(branches[0]->weight.g, 0.08f / 1.04f, 1e-6f);
  EXPECT_NEAR(branches[1]->weight.g, 1 - 0.08f / 1.04f, 1e-6f);
  const Vec3 aside = seen_at(0.5f);
  const auto through = pane.sample(aside, {}, 0.9f);
  ASSERT_TRUE(through);
  EXPECT_EQ(through->wi_local, -aside);
  EXPECT_TRUE(through->delta && through->transmitted);
  EXPECT_EQ(through->eta, 1);
  EXPECT_EQ(bsdf_of(ThinDielectric{}).sample(aside, {}, 0.9f)->wi_local, (Vec3{-aside.x, -aside.y, aside.z}));
}

TEST(Conductor, WithoutRoughnessIsAMirrorOfItsIndices) {
  ConductorMaterial copper;
  copper.eta.value = complex_index(Conductor::kCopper).eta;
  copper.k.value = complex_index(Conductor::kCopper).k;
  copper.specular.value = {1, 0.5f, 1};
  const shading::Bsdf bsdf = bsdf_of(copper);
  EXPECT_TRUE(bsdf.is_delta());
  const Rgb expected = fresnel_conductor(0.5f, copper.eta.value, copper.k.value) * copper.specular.value;
  EXPECT_EQ(bsdf.sample(seen_at(0.5f), {}, 0.3f)->weight, expected);
  EXPECT_EQ(received(bsdf_of(ConductorMaterial{}), seen_at(0.3f), 1), Rgb::gray(1));
}

// Turning the tangent turns the highlight.
TEST(Conductor, IsBrushedAlongItsTangent) {
  ConductorMaterial brushed;
  brushed.roughness = 0.5f;
  brushed.anisotropy = 0.8f;
  shading::Bsdf along_x = bsdf_of(brushed), along_y = bsdf_of(brushed);
  along_y.orient({0, 2, 1});
  const Vec3 wo{0, 0, 1}, x = normalize(Vec3{0.5f, 0, 1}), y = normalize(Vec3{0, 0.5f, 1});
  EXPECT_GT(along_x.evaluate(wo, x).value.g, 2 * along_x.evaluate(wo, y).value.g);
  EXPECT_NEAR(along_x.evaluate(wo, x).value.g, along_y.evaluate(wo, y).value.g, 1e-5f);
}

float reflected_under_film(float base_ior, float film_ior, float thickness_um, float cos_i = 1,
                           float weight = 1) {
  const shading::DielectricReflectance<float> bare{base_ior};
  return shading::FilmedDielectric<float>{bare, {bare.normal(), weight, film_ior, thickness_um}}(cos_i).g;
}

// Without interference, a film adds the reflections of both its sides.
TEST(ThinFilm, HasClosedForms) {
  const float top = 0.04f, bottom = fresnel_dielectric(1, 2.0f / 1.5f);
  const float thick = top + (1 - top) * (1 - top) * bottom / (1 - top * bottom);
  EXPECT_NEAR(reflected_under_film(2, 1.5f, 50), thick, 1e-4f);
  // A quarter of a wave of green light in a film of 1.5: the coating of a lens.
  EXPECT_LT(reflected_under_film(2, 1.5f, 0.55f / 4 / 1.5f), 0.5f * thick);
}

// Each polarisation by itself, at an angle where Schlick's approximation is far off.
TEST(ThinFilm, ReflectsBothPolarisations) {
  const double cos_i = 0.3, sin2 = 1 - cos_i * cos_i, cos_film = std::sqrt(1 - sin2 / (1.5 * 1.5)),
               cos_base = std::sqrt(1 - sin2 / (2.0 * 2.0));
  const auto both_sides = [](double upper, double lower) {
    upper *= upper, lower *= lower;
    return upper + (1 - upper) * (1 - upper) * lower / (1 - upper * lower);
  };
  const auto amplitude = [](double a, double b) { return (a - b) / (a + b); };
  const double across = both_sides(amplitude(cos_i, 1.5 * cos_film), amplitude(1.5 * cos_film, 2 * cos_base));
  const double along = both_sides(amplitude(1.5 * cos_i, cos_film), amplitude(2 * cos_film, 1.5 * cos_base));
  EXPECT_NEAR(reflected_under_film(2, 1.5f, 50, static_cast<float>(cos_i)), (across + along) / 2, 1e-4);
}

TEST(ThinFilm, ChangesNothingWithoutABoundary) {
  for (const float cos_i : {1.0f, 0.5f, 0.1f, 0.0f}) {
    const float bare = fresnel_dielectric(cos_i, 1.5f);
    EXPECT_NEAR(reflected_under_film(1.5f, 1.5f, 0.3f, cos_i), bare, 1e-5f);
    EXPECT_NEAR(reflected_under_film(1.5f, 1, 0.3f, cos_i), bare, 1e-5f);
    EXPECT_NEAR(reflected_under_film(1.5f, 1.4f, 0, cos_i), bare, 1e-5f);
    EXPECT_NEAR(reflected_under_film(1.5f, 1.4f, 0.3f, cos_i, 0), bare, 1e-5f);
    const shading::EdgeTintReflectance<float> gold({0.9f, 0.5f, 0.3f}, {1, 0.8f, 0.6f});
    const Rgb metal = shading::FilmedMetal<float>{gold, {gold.normal(), 1, 1.4f, 0}}(cos_i);
    EXPECT_NEAR(metal.r, gold(cos_i).r, 1e-5f);
    EXPECT_NEAR(metal.b, gold(cos_i).b, 1e-5f);
  }
}

// A smooth coat over a diffuse base has samples of both kinds, whose mean is their sum.
TEST(Closure, MixesDeltaLobesWithOthers) {
  Principled model = white(0.5f);
  model.base_color.value = Rgb::gray(0.5f);
  model.coat_weight = 1;
  const shading::Bsdf bsdf = bsdf_of(model);
  EXPECT_TRUE(bsdf.has_delta());
  EXPECT_FALSE(bsdf.is_delta());
  int delta = 0, rough = 0;
  for (int i = 0; i < 1000; ++i) {
    const auto [u, u_lobe] = test::random_numbers(i);
    const auto sample = bsdf.sample(seen_at(0.6f), u, u_lobe);
    if (sample) ++(sample->delta ? delta : rough);
  }
  EXPECT_GT(delta, 50);
  EXPECT_GT(rough, 500);
  const auto mirror = bsdf.delta_branches(seen_at(0.6f));
  ASSERT_TRUE(mirror[0]);
  EXPECT_NEAR(mirror[0]->weight.g, fresnel_dielectric(0.6f, 1.6f), 1e-6f);
  EXPECT_FALSE(mirror[1]);
}

// look_from() saves work, and changes nothing.
TEST(Closure, LooksFromTheViewerOnce) {
  for (const auto& [name, model, outside] : white_cases(0.5f)) {
    const Vec3 wo = seen_at(0.6f);
    shading::Bsdf each_time = bsdf_of(model, outside), once = each_time;
    each_time.scale_diffuse(1.5f);
    once.scale_diffuse(1.5f);
    once.look_from(wo.z);
    for (int i = 0; i < 20; ++i) {
      const auto [u, u_lobe] = test::random_numbers(i);
      const auto a = each_time.sample(wo, u, u_lobe), b = once.sample(wo, u, u_lobe);
      ASSERT_EQ(a.has_value(), b.has_value()) << name;
      if (!a) continue;
      EXPECT_EQ(a->weight, b->weight) << name;
      EXPECT_EQ(each_time.evaluate(wo, a->wi_local).value, once.evaluate(wo, a->wi_local).value) << name;
    }
  }
}

TEST(TwoSided, OneSidedSurfacesHaveABlackBack) {
  for (const MaterialModel& model : {MaterialModel(Lambert{}), MaterialModel(Plastic{}),
                                     MaterialModel(Mirror{}), MaterialModel(Principled{})}) {
    Material material = test::material_of(model);
    material.two_sided = false;
    EXPECT_GT(received(shading::Bsdf(material, {}, {}, true), seen_at(0.7f), 64).g, 0);
    EXPECT_EQ(received(shading::Bsdf(material, {}, {}, false), seen_at(0.7f), 64).g, 0);
  }
  Material glass = test::material_of(Glass{});
  glass.two_sided = false;
  EXPECT_GT(received(shading::Bsdf(glass, {}, {}, false), seen_at(0.7f), 64).g, 0);
}

// At normal incidence and alpha = 1, GGX that reflects everything loses ln 2.
TEST(DirectionalAlbedo, HasKnownValues) {
  const auto& tables = DirectionalAlbedo::tables();
  EXPECT_NEAR(tables.reflecting(1, 1), 1 - std::log(2.0f), 2e-3f);
  EXPECT_EQ(tables.reflecting(0.3f, 0), 1);
  EXPECT_NEAR(tables.reflected(1, 0, 1.5f), 0.04f, 1.5e-3f);
  EXPECT_NEAR(tables.scattered(0.7f, 1e-4f, 1 / 1.5f), 1, 1e-3f);
  EXPECT_NEAR(tables.mean_transmitted(0, 1.5f), 1 - 0.09178f, 2e-3f);
}

}  // namespace
}  // namespace tessera::core
