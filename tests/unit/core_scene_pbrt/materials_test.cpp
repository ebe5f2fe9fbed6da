// SPDX-License-Identifier: Apache-2.0
// Materials of pbrt files.
#include <gmock/gmock.h>

#include <cmath>

#include "core/materials/bump_map.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

template <typename Model>
Model model_of(const std::string& directives, const MemoryAssets::Files& files = {}) {
  const Material material = pbrt_material(directives, files);
  const auto* model = std::get_if<Model>(&material.model);
  EXPECT_NE(model, nullptr) << directives;
  return model == nullptr ? Model{} : *model;
}

TEST(PbrtMaterials, Diffuse) {
  EXPECT_EQ(model_of<Lambert>("").albedo.value, Rgb::gray(0.5f));
  EXPECT_EQ(model_of<Lambert>("Material \"diffuse\" \"rgb reflectance\" [0.1 0.2 0.3]").albedo.value,
            (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(model_of<Lambert>("Material \"diffuse\" \"rgb reflectance\" [2 -1 0.3]").albedo.value,
            (Rgb{1, 0, 0.3f}));
}

TEST(PbrtMaterials, ShadingNormalsArePlain) {
  EXPECT_EQ(pbrt_material("").shading_normals, ShadingNormals::kPlain);
  EXPECT_EQ(pbrt_material("Material \"dielectric\"").shading_normals, ShadingNormals::kPlain);
}

TEST(PbrtMaterials, RoughnessIsRemappedByItsRoot) {
  // Our roughness is the root of alpha; alpha is the root of pbrt's roughness, or the roughness itself.
  EXPECT_NEAR(model_of<Glass>("Material \"dielectric\" \"float roughness\" 0.0625").roughness.value, 0.5,
              1e-6);
  EXPECT_NEAR(
      model_of<Glass>("Material \"dielectric\" \"float roughness\" 0.25 \"bool remaproughness\" false")
          .roughness.value,
      0.5, 1e-6);
  EXPECT_EQ(model_of<Glass>("Material \"dielectric\"").roughness.value, 0);
}

TEST(PbrtMaterials, AnisotropyOfMetals) {
  const auto metal = model_of<ConductorMaterial>(
      "Material \"conductor\" \"float uroughness\" 0.4 \"float vroughness\" 0.1 \"bool remaproughness\" "
      "false");
  // The two alphas that the model derives (core/materials/layered_materials.cpp).
  const float narrow = 1 - metal.anisotropy.value;
  const float along = metal.roughness.value * metal.roughness.value * std::sqrt(2 / (1 + narrow * narrow));
  EXPECT_NEAR(along, 0.4, 1e-5);
  EXPECT_NEAR(along * narrow, 0.1, 1e-5);
  EXPECT_TRUE(is_along_u(metal.tangent));
  const auto across = model_of<ConductorMaterial>(
      "Material \"conductor\" \"float uroughness\" 0.1 \"float vroughness\" 0.4 \"bool remaproughness\" "
      "false");
  EXPECT_EQ(across.anisotropy.value, metal.anisotropy.value);
  EXPECT_EQ(across.roughness.value, metal.roughness.value);
  EXPECT_EQ(across.tangent.rotation.value, 0.25f);
}

TEST(PbrtMaterials, CoatedDiffuseIsPlastic) {
  const auto plastic =
      model_of<Plastic>("Material \"coateddiffuse\" \"float eta\" 1.4 \"rgb reflectance\" [1 0 0]");
  EXPECT_FLOAT_EQ(plastic.ior.value, 1.4f);
  EXPECT_EQ(plastic.diffuse.value, (Rgb{1, 0, 0}));
  EXPECT_TRUE(plastic.nonlinear);
  EXPECT_FALSE(plastic.compensated);
  const std::string uncoated =
      "Material \"coateddiffuse\" \"float eta\" 1 \"float roughness\" 0.8 \"rgb reflectance\" [1 0 0]";
  EXPECT_EQ(model_of<Lambert>(uncoated).albedo.value, (Rgb{1, 0, 0}));
}

TEST(PbrtMaterials, MetalsByNameIndexOrReflectance) {
  const ComplexIndex gold = complex_index(Conductor::kGold);
  const auto named = model_of<ConductorMaterial>(
      "Material \"conductor\" \"spectrum eta\" \"metal-Au-eta\" \"spectrum k\" \"metal-Au-k\"");
  EXPECT_EQ(named.eta.value, gold.eta);
  EXPECT_EQ(named.k.value, gold.k);
  EXPECT_EQ(model_of<ConductorMaterial>("Material \"conductor\"").eta.value,
            complex_index(Conductor::kCopper).eta);
  const auto given =
      model_of<ConductorMaterial>("Material \"conductor\" \"rgb eta\" [0.2 0.9 1.1] \"rgb k\" [3.9 2.4 2.1]");
  EXPECT_EQ(given.eta.value, (Rgb{0.2f, 0.9f, 1.1f}));
  EXPECT_EQ(given.k.value, (Rgb{3.9f, 2.4f, 2.1f}));
  const auto gray = model_of<ConductorMaterial>("Material \"conductor\" \"rgb reflectance\" [0.5 0.25 0]");
  const Rgb reflected = fresnel_conductor(1.0f, gray.eta.value, gray.k.value);
  EXPECT_NEAR(reflected.r, 0.5, 1e-5);
  EXPECT_NEAR(reflected.g, 0.25, 1e-5);
  EXPECT_NEAR(reflected.b, 0, 1e-5);
}

const std::string kReflectanceImage =
    "Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\"\n";
const std::string kReflectancePattern = "Texture \"t\" \"spectrum\" \"marble\"\n";

// An image of one colour, 0.5 in linear light.
MemoryAssets::Files half_white() {
  return {{"a.png", png(one_color(2, 2, Rgb::gray(0.5f)))}};
}

TEST(PbrtMaterials, MetalsByTexturedReflectance) {
  const std::string metal = "Material \"conductor\" \"texture reflectance\" \"t\" " + kPbrtTriangle;
  const SceneDescription scene = pbrt_world(kReflectanceImage + metal, half_white());
  EXPECT_EQ(warnings_of(scene), "");
  const auto& model = std::get<ConductorMaterial>(scene.materials.at(0).model);
  EXPECT_EQ(model.eta.value, Rgb::gray(1));
  EXPECT_EQ(model.specular.value, Rgb::gray(1));
  const Rgb k = model.k.evaluate(scene.textures, Vec2{0.5f, 0.5f});
  expect_color(fresnel_conductor(1.0f, Rgb::gray(1), k), Rgb::gray(0.5f), 5e-3f);
  EXPECT_THAT(warnings_of(pbrt_world(kReflectancePattern + metal)),
              HasSubstr("a metal whose reflectance is a pattern reflects no more at grazing angles"));
}

TEST(PbrtMaterials, AreClampedToTheRangesOfSceneFiles) {
  const auto metal = model_of<ConductorMaterial>(
      "Material \"conductor\" \"rgb eta\" [0.2 0.9 1.1] \"rgb k\" [3.9 5000 2.1]");
  EXPECT_EQ(metal.k.value, (Rgb{3.9f, 1000, 2.1f}));
  EXPECT_GT(model_of<ConductorMaterial>("Material \"conductor\" \"rgb reflectance\" [1 1 1]").k.value.r, 100);
  const auto scene =
      pbrt_world("Material \"conductor\" \"rgb eta\" [0.2 0.9 1.1] \"rgb k\" [3.9 5000 2.1]" + kPbrtTriangle);
  EXPECT_THAT(warnings_of(scene), HasSubstr("k is out of range; it is clamped"));
}

TEST(PbrtMaterials, GlassesByNameOrIndex) {
  EXPECT_FLOAT_EQ(model_of<Glass>("Material \"dielectric\"").ior.value, 1.5f);
  EXPECT_FLOAT_EQ(model_of<Glass>("Material \"dielectric\" \"float eta\" 1.33").ior.value, 1.33f);
  EXPECT_FLOAT_EQ(model_of<Glass>("Material \"dielectric\" \"spectrum eta\" \"glass-BK7\"").ior.value,
                  1.5168f);
  EXPECT_NEAR(model_of<Glass>("Material \"dielectric\" \"spectrum eta\" [400 1.6 700 1.6]").ior.value, 1.6,
              1e-5);
  EXPECT_FLOAT_EQ(model_of<ThinDielectric>("Material \"thindielectric\" \"float eta\" 1.7").ior.value, 1.7f);
}

TEST(PbrtMaterials, GlassesHaveTheDispersionOfTheirSpectrum) {
  const auto named = model_of<Glass>("Material \"dielectric\" \"spectrum eta\" \"glass-SF11\"");
  EXPECT_FLOAT_EQ(named.dispersion.scale, 1);
  EXPECT_FLOAT_EQ(named.dispersion.abbe_number, 25.76f);
  // Linear from 1.7 at 400 nm to 1.6 at 800 nm.
  const auto sampled = model_of<Glass>("Material \"dielectric\" \"spectrum eta\" [400 1.7 800 1.6]");
  EXPECT_NEAR(sampled.ior.value, 1.7 - 0.1 * 187.56 / 400, 1e-5);
  EXPECT_NEAR(sampled.dispersion.abbe_number, 0.65311 / (0.1 * 170.14 / 400), 1e-2);
  for (const char* without :
       {"\"spectrum eta\" [400 1.6 700 1.6]", "\"spectrum eta\" [500 1.7 600 1.6]", "\"float eta\" 1.33", ""})
    EXPECT_EQ(model_of<Glass>("Material \"dielectric\" " + std::string(without)).dispersion.scale, 0);
  const std::string eta = " \"spectrum eta\" \"glass-BK7\"" + kPbrtTriangle;
  EXPECT_THAT(warnings_of(pbrt_world("Material \"dielectric\"" + eta)), HasSubstr("Cauchy's formula"));
  EXPECT_THAT(warnings_of(pbrt_world("Material \"coateddiffuse\"" + eta)),
              HasSubstr("is supported for dielectrics only"));
}

// 1 / 0.8 on the other side.
TEST(PbrtMaterials, DielectricsOfLessThanOneAreTurnedInsideOut) {
  const std::string air =
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" MediumInterface \"fog\" \"\" "
      "Material \"dielectric\" \"float eta\" 0.8 ";
  const SceneDescription scene = pbrt_world(air + kPbrtTriangle);
  EXPECT_EQ(warnings_of(scene), "");
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const Material& material = scene.materials.at(mesh.triangle_materials.at(0));
  EXPECT_FLOAT_EQ(std::get<Glass>(material.model).ior.value, 1.25f);
  EXPECT_EQ(material.media.interior, kNoMedium);
  EXPECT_EQ(material.media.exterior, 0);
  EXPECT_EQ(mesh.triangles.at(0), (std::array<std::uint32_t, 3>{0, 2, 1}));
  const SceneDescription light = pbrt_world(air + "AreaLightSource \"diffuse\" " + kPbrtTriangle);
  EXPECT_THAT(warnings_of(light), HasSubstr("a dielectric of an index below 1 emits to its inside"));
  const SceneDescription mixed = pbrt_world(
      "MakeNamedMaterial \"a\" \"string type\" \"dielectric\" \"float eta\" 0.8 Material \"mix\" \"string "
      "materials\" [\"a\" \"a\"] " +
      kPbrtTriangle);
  EXPECT_THAT(warnings_of(mixed), HasSubstr("the inside and outside of a dielectric are exchanged"));
}

TEST(PbrtMaterials, DisneyOfVersion3) {
  const auto solid = model_of<Disney>(
      "Material \"disney\" \"rgb color\" [0.2 0.4 0.6] \"float metallic\" 0.25 \"float clearcoat\" 0.75 "
      "\"float "
      "difftrans\" 2");
  EXPECT_EQ(solid.base_color.value, (Rgb{0.2f, 0.4f, 0.6f}));
  EXPECT_EQ(solid.metallic.value, 0.25f);
  EXPECT_EQ(solid.roughness.value, 0.5f);
  EXPECT_EQ(solid.sheen_tint.value, 0.5f);
  EXPECT_EQ(solid.clearcoat.value, 0.75f);
  EXPECT_EQ(solid.clearcoat_gloss.value, 1);
  EXPECT_EQ(solid.diffuse_transmission.value, 0);
  const auto sheet = model_of<Disney>("Material \"disney\" \"bool thin\" true \"float flatness\" 0.5");
  EXPECT_TRUE(sheet.thin_walled);
  EXPECT_EQ(sheet.flatness.value, 0.5f);
  EXPECT_EQ(sheet.diffuse_transmission.value, 0.5f);
  const SceneDescription scattering =
      pbrt_world("Material \"disney\" \"rgb scatterdistance\" [1 1 1] " + kPbrtTriangle);
  EXPECT_THAT(warnings_of(scattering), HasSubstr("the subsurface scattering of 'disney' is not supported"));
}

TEST(PbrtMaterials, DiffuseTransmissionIsScaled) {
  const auto leaf = model_of<DiffuseTransmission>(
      "Material \"diffusetransmission\" \"rgb reflectance\" [0.2 0.4 0.6] \"float scale\" 0.5");
  EXPECT_EQ(leaf.reflectance.value, (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(leaf.transmittance.value, Rgb::gray(0.125f));
}

TEST(PbrtMaterials, DiffuseTransmissionOfMoreThanAllLightIsTold) {
  const auto told = [](const std::string& transmittance) {
    return warnings_of(
        pbrt_world("Material \"diffusetransmission\" \"rgb reflectance\" [0.5 0.5 0.75] \"rgb "
                   "transmittance\" " +
                   transmittance + kPbrtTriangle));
  };
  EXPECT_EQ(told("[0.5 0.5 0.25]"), "");
  EXPECT_THAT(told("[0.5 0.5 0.5]"), HasSubstr("adds up to more than 1 with the reflectance"));
}

TEST(PbrtMaterials, MixturesNameTheirParts) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" MakeNamedMaterial \"b\" \"string type\" "
      "\"conductor\"\n"
      "Material \"mix\" \"string materials\" [\"a\" \"b\"] \"float amount\" 0.25\n" +
      kPbrtTriangle);
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const auto& blend = std::get<Blend>(scene.materials.at(mesh.triangle_materials.at(0)).model);
  EXPECT_TRUE(std::holds_alternative<Lambert>(scene.materials.at(blend.first).model));
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials.at(blend.second).model));
  EXPECT_FLOAT_EQ(blend.weight.value, 0.25f);
}

// As in pbrt, all names are known in the whole file.
TEST(PbrtMaterials, NamesMayBeUsedBeforeTheyAreDefined) {
  const SceneDescription scene =
      pbrt_world("NamedMaterial \"both\"\n" + kPbrtTriangle +
                 "MakeNamedMaterial \"both\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"]\n"
                 "Shape \"sphere\" MakeNamedMaterial \"b\" \"string type\" \"conductor\"\n"
                 "MakeNamedMaterial \"a\" \"string type\" \"dielectric\"");
  EXPECT_EQ(warnings_of(scene), "");
  ASSERT_EQ(scene.shapes.size(), 2u);
  std::uint32_t of_sphere = 0, of_mesh = 0;
  for (const auto& shape : scene.shapes) {
    if (const auto* mesh = std::get_if<MeshDescription>(&shape)) of_mesh = mesh->triangle_materials.at(0);
    if (const auto* sphere = std::get_if<SphereDescription>(&shape)) of_sphere = sphere->material;
  }
  EXPECT_EQ(of_mesh, of_sphere);
  const auto& blend = std::get<Blend>(scene.materials.at(of_mesh).model);
  EXPECT_TRUE(std::holds_alternative<Glass>(scene.materials.at(blend.first).model));
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials.at(blend.second).model));
  EXPECT_EQ(scene.materials.at(of_mesh).name, "both");
}

TEST(PbrtMaterials, MixturesKeepTheirPartsWhenNamesAreDefinedAgain) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMaterial \"a\" \"string type\" \"dielectric\"\n"
      "MakeNamedMaterial \"both\" \"string type\" \"mix\" \"string materials\" [\"a\" \"b\"]\n"
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\n"
      "MakeNamedMaterial \"b\" \"string type\" \"conductor\" NamedMaterial \"both\"\n" +
      kPbrtTriangle);
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const auto& blend = std::get<Blend>(scene.materials.at(mesh.triangle_materials.at(0)).model);
  EXPECT_TRUE(std::holds_alternative<Glass>(scene.materials.at(blend.first).model));
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials.at(blend.second).model));
}

TEST(PbrtMaterials, ShapesOfObjectsWaitForTheirMaterials) {
  const SceneDescription scene = pbrt_world(
      "ObjectBegin \"o\" NamedMaterial \"late\" Shape \"sphere\" ObjectEnd ObjectInstance \"o\"\n"
      "MakeNamedMaterial \"late\" \"string type\" \"conductor\"");
  EXPECT_EQ(warnings_of(scene), "");
  ASSERT_EQ(scene.materials.size(), 1u);
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(scene.materials[0].model));
}

TEST(PbrtMaterials, MixturesThatArePartsOfThemselvesAreTold) {
  const SceneDescription scene = pbrt_world(
      "MakeNamedMaterial \"a\" \"string type\" \"mix\" \"string materials\" [\"b\" \"c\"]\n"
      "MakeNamedMaterial \"b\" \"string type\" \"mix\" \"string materials\" [\"a\" \"c\"]\n"
      "MakeNamedMaterial \"c\" \"string type\" \"conductor\" NamedMaterial \"a\"\n" +
      kPbrtTriangle);
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:3: a mixture of materials is a part of itself"));
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  EXPECT_TRUE(std::holds_alternative<Blend>(scene.materials.at(mesh.triangle_materials.at(0)).model));
}

TEST(PbrtMaterials, CoatedMetalIsPrincipled) {
  const auto coated = model_of<Principled>(
      "Material \"coatedconductor\" \"rgb conductor.eta\" [1 1 1] \"rgb conductor.k\" [3 3 3] "
      "\"float conductor.roughness\" 0.0625 \"float interface.eta\" 1.5");
  EXPECT_EQ(coated.base_metalness.value, 1);
  EXPECT_EQ(coated.coat_weight.value, 1);
  EXPECT_NEAR(coated.specular_roughness.value, 0.5, 1e-6);
  // Seen from inside of the coat.
  EXPECT_NEAR(coated.base_color.value.r, fresnel_conductor(1.0f, Rgb::gray(1 / 1.5f), Rgb::gray(2)).r, 1e-5);
  // The reflectance has no prefix. As a metal of index 1, r is k² / (4 + k²).
  const auto tinted = model_of<Principled>("Material \"coatedconductor\" \"rgb reflectance\" [0.5 0.5 0.5]");
  EXPECT_NEAR(tinted.base_color.value.g, fresnel_conductor(1.0f, Rgb::gray(1 / 1.5f), Rgb::gray(2 / 1.5f)).g,
              1e-4);
  const auto brushed = model_of<Principled>(
      "Material \"coatedconductor\" \"float conductor.uroughness\" 0.1 \"float conductor.vroughness\" 0.2 "
      "\"float interface.uroughness\" 0.2 \"float interface.vroughness\" 0.1 \"bool remaproughness\" false");
  EXPECT_NEAR(brushed.specular_roughness_anisotropy.value, 0.5, 1e-6);
  EXPECT_EQ(brushed.tangent.rotation.value, 0.25f);
  EXPECT_NEAR(brushed.coat_roughness_anisotropy.value, 0.5, 1e-6);
  EXPECT_EQ(brushed.coat_tangent.rotation.value, 0);
}

TEST(PbrtMaterials, CoatedMetalByTexturedReflectance) {
  const std::string metal =
      "Material \"coatedconductor\" \"texture reflectance\" \"t\" \"float interface.eta\" 1.5 " +
      kPbrtTriangle;
  const SceneDescription scene = pbrt_world(kReflectanceImage + metal, half_white());
  const auto& coated = std::get<Principled>(scene.materials.at(0).model);
  // As a metal of index 1, 0.5 is k = 2.
  expect_color(coated.base_color.evaluate(scene.textures, Vec2{0.5f, 0.5f}),
               fresnel_conductor(1.0f, Rgb::gray(1 / 1.5f), Rgb::gray(2 / 1.5f)), 5e-3f);
  EXPECT_THAT(warnings_of(pbrt_world(kReflectancePattern + metal)),
              HasSubstr("a metal under a coat whose reflectance is a pattern"));
}

TEST(PbrtMaterials, MaterialsOfVersion3) {
  EXPECT_EQ(model_of<Lambert>("Material \"matte\" \"color Kd\" [0.1 0.2 0.3]").albedo.value,
            (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(model_of<Mirror>("Material \"mirror\"").reflectance.value, Rgb::gray(0.9f));
  EXPECT_FLOAT_EQ(model_of<Glass>("Material \"glass\" \"float index\" 1.2").ior.value, 1.2f);
  EXPECT_EQ(model_of<Plastic>("Material \"plastic\" \"color Kd\" [0.1 0.2 0.3]").diffuse.value,
            (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_THAT(warnings_of(pbrt_world("Material \"matte\"" + kPbrtTriangle)),
              HasSubstr("scene.pbrt:2: the material 'matte' is one of pbrt-v3"));
}

TEST(PbrtMaterials, Hair) {
  EXPECT_EQ(model_of<Hair>("Material \"hair\"").eumelanin.value, 1.3f);
  const auto red =
      model_of<Hair>("Material \"hair\" \"float pheomelanin\" 2 \"float beta_m\" 0.2 \"float alpha\" 3");
  EXPECT_EQ(red.pigment, HairPigment::kMelanin);
  EXPECT_EQ(red.eumelanin.value, 0);
  EXPECT_EQ(red.pheomelanin.value, 2);
  EXPECT_EQ(red.beta_m.value, 0.2f);
  EXPECT_EQ(red.tilt_degrees, 3);
  EXPECT_EQ(model_of<Hair>("Material \"hair\" \"rgb sigma_a\" [1 1 1]").pigment, HairPigment::kAbsorption);
  EXPECT_EQ(model_of<Hair>("Material \"hair\" \"rgb reflectance\" [.5 .4 .3]").pigment,
            HairPigment::kReflectance);
}

TEST(PbrtMaterials, PigmentsOfHairThatDoNotCountAreTold) {
  const auto warnings_with = [](const std::string& pigments) {
    return warnings_of(pbrt_world("Material \"hair\" " + pigments + "\n" + kPbrtTriangle));
  };
  EXPECT_THAT(warnings_with("\"float pheomelanin\" 1 \"rgb color\" [.6 .3 .1]"),
              HasSubstr("the parameter 'pheomelanin' of the material 'hair' is ignored, because 'color' is"));
  EXPECT_THAT(warnings_with("\"rgb sigma_a\" [1 2 3] \"float eumelanin\" 1"),
              HasSubstr("the parameter 'eumelanin' of the material 'hair' is ignored, because 'sigma_a' is"));
  EXPECT_EQ(warnings_with("\"float pheomelanin\" 1 \"float eumelanin\" 1"), "");
}

TEST(PbrtMaterials, SubsurfaceHasTheColourOfItsMedium) {
  const auto diffuse = [](const std::string& parameters) {
    return model_of<Plastic>("Material \"subsurface\" " + parameters).diffuse.value;
  };
  const Rgb ketchup = diffuse("\"string name\" \"Ketchup\"");
  EXPECT_GT(ketchup.r, 3 * ketchup.b);
  EXPECT_EQ(ketchup, diffuse("\"rgb sigma_s\" [0.18 0.07 0.03] \"rgb sigma_a\" [0.061 0.97 1.45]"));
  EXPECT_EQ(diffuse(""), diffuse("\"string name\" \"Wholemilk\""));
  // Only reduced scattering counts.
  expect_color(diffuse("\"rgb sigma_s\" [1 2 3] \"rgb sigma_a\" [1 1 1] \"float g\" 0.5"),
               diffuse("\"rgb sigma_s\" [0.5 1 1.5] \"rgb sigma_a\" [1 1 1]"), 1e-6f);
  expect_color(diffuse("\"rgb reflectance\" [0.3 0.5 0.7] \"rgb mfp\" [1 2 3]"), {0.3f, 0.5f, 0.7f});
  EXPECT_THAT(warnings_of(pbrt_world("Material \"subsurface\" \"string name\" \"tar\" Shape \"sphere\"")),
              HasSubstr("the medium 'tar' is not known; that of whole milk"));
}

TEST(PbrtMaterials, WhatIsNotSupportedIsGray) {
  const SceneDescription scene =
      pbrt_world("Material \"measured\" \"string filename\" \"paint.bsdf\"\nShape \"sphere\"");
  EXPECT_EQ(
      warnings_of(scene),
      "scene.pbrt:2: the material 'measured' is refused: the measured reflectance of 'paint.bsdf' cannot "
      "be read; a gray diffuse material replaces it\n");
  EXPECT_THAT(warnings_of(pbrt_world("Material \"subsurface\" Shape \"sphere\"")),
              HasSubstr("subsurface scattering"));
  EXPECT_THAT(warnings_of(pbrt_world("NamedMaterial \"gone\" Shape \"sphere\"")),
              HasSubstr("there is no material 'gone'; gray is used"));
}

TEST(PbrtMaterials, BumpsNormalMapsAndAlpha) {
  const MemoryAssets::Files files{{"a.png", png(one_color(2, 2, Rgb::gray(1)))}};
  const Material material = pbrt_material(
      "Texture \"height\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" 0.5\n"
      "Attribute \"shape\" \"float alpha\" 0.25\n"
      "Material \"diffuse\" \"texture displacement\" \"height\" \"string normalmap\" \"a.png\"",
      files);
  EXPECT_GE(material.bump.texture, 0);
  EXPECT_FLOAT_EQ(material.bump.height, 0.5f);
  EXPECT_GE(material.normal_map.texture, 0);
  EXPECT_FLOAT_EQ(material.opacity.value, 0.25f);
}

// The slope of the bump map along u in the middle of an image that is black on the left and white on the
// right.
float slope_of(const std::string& textures) {
  Image ramp(2, 1);
  ramp.pixels = {Rgb{}, Rgb::gray(1)};
  const SceneDescription scene =
      pbrt_world("Texture \"i\" \"float\" \"imagemap\" \"string filename\" \"ramp.png\"\n" + textures +
                     " Material \"diffuse\" \"texture displacement\" \"t\" " + kPbrtTriangle,
                 {{"ramp.png", png(ramp)}});
  EXPECT_EQ(warnings_of(scene), "");
  const BumpMap& bump = scene.materials.at(0).bump;
  if (bump.texture < 0) return 0;
  return height_slope(scene.textures.at(static_cast<std::size_t>(bump.texture)), bump.height, {0.5f, 0.5f})
      .along_u;
}

TEST(PbrtMaterials, BumpsMayBeDents) {
  const float up = slope_of("Texture \"t\" \"float\" \"scale\" \"texture tex\" \"i\" \"float scale\" 1");
  EXPECT_GT(up, 1);
  for (const char* negative : {"\"imagemap\" \"string filename\" \"ramp.png\" \"float scale\" -1",
                               "\"scale\" \"texture tex\" \"i\" \"float scale\" -1",
                               "\"mix\" \"float tex1\" 0 \"float tex2\" -1 \"texture amount\" \"i\"",
                               "\"imagemap\" \"string filename\" \"ramp.png\" \"bool invert\" true"})
    EXPECT_NEAR(slope_of("Texture \"t\" \"float\" " + std::string(negative)), -up, 1e-5f) << negative;
}

TEST(PbrtMaterials, BumpsOfPatternsMayBeDents) {
  const SceneDescription scene = pbrt_world(
      "Texture \"i\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" -2\n"
      "Texture \"f\" \"float\" \"wrinkled\"\n"
      "Texture \"t\" \"float\" \"scale\" \"texture tex\" \"f\" \"texture scale\" \"i\"\n"
      "Material \"diffuse\" \"texture displacement\" \"t\" " +
          kPbrtTriangle,
      {{"a.png", png(one_color(2, 2, Rgb::gray(1)))}});
  const auto bump = static_cast<std::size_t>(scene.materials.at(0).bump.texture);
  const Texture& product = scene.textures.at(bump);
  const TexturePoint at(Vec2{0.5f, 0.5f}, {0.3f, 0.4f, 0.5f}, {0, 0, 1});
  const ColorParameter& wrinkled = std::get<ProductPattern>(product.procedural->pattern).first;
  const float factor = wrinkled.evaluate(scene.textures, at).r;
  EXPECT_GT(factor, 0.1f);
  EXPECT_NEAR(product.evaluate_unclamped(scene.textures, at).r, -2 * factor, 1e-5f);
}

// Lights and reflectances are not negative.
TEST(PbrtMaterials, OnlyBumpsAreNegative) {
  const MemoryAssets::Files files{{"a.png", png(one_color(2, 2, Rgb::gray(1)))}};
  const SceneDescription scene = pbrt_world(
      "Texture \"t\" \"float\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" -1\n"
      "Texture \"c\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" \"float scale\" -1\n"
      "Texture \"m\" \"spectrum\" \"mix\" \"texture tex1\" \"c\" \"rgb tex2\" [1 1 1]\n"
      "Material \"coateddiffuse\" \"texture reflectance\" \"m\" \"texture roughness\" \"t\" " +
          kPbrtTriangle,
      files);
  EXPECT_EQ(warnings_of(scene), "");
  const auto& plastic = std::get<Plastic>(scene.materials.at(0).model);
  EXPECT_EQ(plastic.roughness.evaluate(scene.textures, Vec2{0.5f, 0.5f}), 0);
  expect_color(plastic.diffuse.evaluate(scene.textures, Vec2{0.5f, 0.5f}), Rgb::gray(0.5f));
}

}  // namespace
}  // namespace tessera::core::test
