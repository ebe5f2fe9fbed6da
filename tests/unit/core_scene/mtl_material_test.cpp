// SPDX-License-Identifier: Apache-2.0
// Materials of MTL files become what the programs that write them show.
#include "core/scene/loader/mtl_material.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <utility>

#include "core/materials/fresnel.hpp"

namespace tessera::core::mtl_material_test {
namespace {

constexpr MtlTextures kNone{};
constexpr MtlTextures kDiffuse{.diffuse = 0};

Material made(const std::string& statements, const MtlTextures& textures = kNone) {
  return make_material(read_mtl("newmtl m\n" + statements).materials.at(0), textures);
}

template <typename Model>
Model model(const std::string& statements, const MtlTextures& textures = kNone) {
  const Material material = made(statements, textures);
  const auto* found = std::get_if<Model>(&material.model);
  EXPECT_NE(found, nullptr) << statements;
  return found == nullptr ? Model{} : *found;
}

void expect_near(Rgb a, Rgb b) {
  EXPECT_NEAR(a.r, b.r, 1e-6f);
  EXPECT_NEAR(a.g, b.g, 1e-6f);
  EXPECT_NEAR(a.b, b.b, 1e-6f);
}

TEST(MtlMaterials, AreMattWithoutHighlights) {
  EXPECT_EQ(model<Lambert>("Kd 0.8 0.4 0.2\nKs 0.5 0.5 0.5\nNs 250\nillum 1\n").albedo.value,
            (Rgb{0.8f, 0.4f, 0.2f}));
  EXPECT_EQ(model<Lambert>("Kd 0.5 0.5 0.5\nNs 250\nKs 0 0 0\nillum 2\n").albedo.value, Rgb::gray(0.5f));
  EXPECT_EQ(model<Lambert>("Kd 1 0 0\nNs -1.960784\nKs 1 1 1\nillum 2\n").albedo.value, (Rgb{1, 0, 0}));
  EXPECT_EQ(model<Lambert>("Kd 1 0 0\nKs 0 0 0\nillum 3\n").albedo.value,
            (Rgb{1, 0, 0}));  // nothing to mirror with
  EXPECT_EQ(model<Lambert>("").albedo.value, Rgb::gray(0.5f));
}

TEST(MtlMaterials, AreTextured) {
  EXPECT_EQ(model<Lambert>("Kd 0.5 0.5 0.5\nmap_Kd a.png\n", kDiffuse).albedo.texture, 0);
  EXPECT_EQ(model<Lambert>("Kd 0 0 0\nmap_Kd a.png\n", kDiffuse).albedo.value, Rgb::gray(1));
  EXPECT_EQ(model<Lambert>("Kd 0 0 0\nmap_Kd missing.png\n").albedo.value, Rgb::gray(0.5f));
}

// The default Principled BSDF: specular 0.5, roughness 0.5.
TEST(MtlMaterials, OfBlendersDefaultReflectFourPercent) {
  const auto m =
      model<CookTorrance>("Ns 250\nKa 1 1 1\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 2\n");
  expect_near(m.diffuse.value, Rgb::gray(0.8f));
  expect_near(m.f0.value, Rgb::gray(0.04f));
  EXPECT_NEAR(m.roughness.value, 0.5f, 1e-6f);
  EXPECT_NEAR(m.specular.value.r, 0.2f, 1e-6f);
  EXPECT_EQ(
      model<CookTorrance>("Kd 1 1 1\nKs 1 1 1\nNs 2000\nillum 2\nmap_Kd a.png\n", kDiffuse).roughness.value,
      0);
}

TEST(MtlMaterials, WithoutDiffusePartAreMetalsOfTheirHighlight) {
  const auto m = model<CookTorrance>("Kd 0 0 0\nKs 0.9 0.6 2\nNs 250\nillum 2\n");
  EXPECT_TRUE(is_black(m.diffuse.value));
  EXPECT_EQ(m.f0.value, (Rgb{0.9f, 0.6f, 1}));
}

// What Blender writes for plastic with a black base colour.
TEST(MtlMaterials, OfBlenderWithoutDiffusePartArePlastic) {
  const auto m = model<CookTorrance>("Ns 250\nKa 1 1 1\nKd 0 0 0\nKs 0.5 0.5 0.5\nNi 1.45\nd 1\nillum 2\n");
  EXPECT_TRUE(is_black(m.diffuse.value));
  expect_near(m.f0.value, Rgb::gray(0.04f));
}

// What Blender writes for gold, and for plastic that is a quarter metal.
TEST(MtlMaterials, OfThePhysicallyBasedExtensionArePrincipled) {
  const auto gold = model<Principled>(
      "Ns 0\nKa 1 1 1\nKd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nNi 1.5\nd 1\nillum 3\nPr 0.6\nPm 1\n");
  EXPECT_EQ(gold.base_color.value, (Rgb{0.9f, 0.6f, 0.2f}));
  EXPECT_EQ(gold.base_metalness.value, 1);
  EXPECT_EQ(gold.specular_roughness.value, 0.6f);
  EXPECT_EQ(gold.specular_weight.value, 1);
  const auto plastic =
      model<Principled>("Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nillum 3\nPr 0.8\nPm 0.25\nmap_Kd a.png\n", kDiffuse);
  EXPECT_EQ(plastic.base_color.value, (Rgb{0.8f, 0.1f, 0.1f}));
  EXPECT_EQ(plastic.base_color.texture, 0);
  EXPECT_EQ(plastic.base_metalness.value, 0.25f);
  EXPECT_NEAR(plastic.specular_ior.value, 1.5f, 1e-6f);
  EXPECT_EQ(plastic.coat_weight.value, 0);
  EXPECT_EQ(plastic.fuzz_weight.value, 0);
  EXPECT_EQ(plastic.transmission_weight.value, 0);
}

TEST(MtlMaterials, HaveMapsOfThePhysicallyBasedExtensionForEachTexel) {
  const MtlTextures textures{.roughness = 3, .metallic = 4, .coat = 5, .coat_roughness = 6, .sheen = 7};
  const auto m = model<Principled>(
      "Kd 0.5\nPr 0.1\nPm 0\nmap_Pr r.png\nmap_Pm m.png\nmap_Pc c.png\nmap_Pcr d.png\nmap_Ps s.png\n",
      textures);
  const std::pair<ScalarParameter, int> expected[] = {{m.specular_roughness, 3},
                                                      {m.base_metalness, 4},
                                                      {m.coat_weight, 5},
                                                      {m.coat_roughness, 6},
                                                      {m.fuzz_weight, 7}};
  for (const auto& [parameter, texture] : expected) {
    EXPECT_EQ(parameter.texture, texture);
    EXPECT_EQ(parameter.value, 1);  // a map replaces its number
  }
  // Where the image is missing, the number counts.
  EXPECT_EQ(model<Principled>("Kd 0.5\nPm 0.5\nmap_Pm gone.png\n").base_metalness.value, 0.5f);
}

TEST(MtlMaterials, HaveTheirCoatAndSheen) {
  const auto coated = model<Principled>("Kd 0.5\nPc 3\nPcr 0.25\n");
  EXPECT_EQ(coated.coat_weight.value, 0.75f);
  EXPECT_EQ(coated.coat_roughness.value, 0.25f);
  EXPECT_EQ(coated.coat_ior.value, 1.5f);
  EXPECT_EQ(coated.coat_darkening.value, 0);
  const auto velvet = model<Principled>("Kd 0.5\nPs 0.5 0.25 0\n");
  EXPECT_EQ(velvet.fuzz_weight.value, 0.5f);
  EXPECT_EQ(velvet.fuzz_color.value, (Rgb{1, 0.5f, 0}));
}

// Ks scales the reflectance of the index: 0.5 is that of the index, as in Blender.
TEST(MtlMaterials, OfThePhysicallyBasedExtensionReflectByIndexAndKs) {
  const auto reflectance = [](const std::string& statements) {
    return normal_reflectance(model<Principled>("Kd 0.5\nPr 0.5\n" + statements).specular_ior.value);
  };
  EXPECT_NEAR(reflectance(""), 0.04f, 1e-6f);
  EXPECT_NEAR(reflectance("Ks 1 1 1\n"), 0.08f, 1e-6f);
  EXPECT_NEAR(reflectance("Ks 0 0 0\n"), 0, 1e-6f);
  EXPECT_NEAR(reflectance("Ks 0.5 0.5 0.5\nNi 2\n"), 1.0f / 9, 1e-6f);
  EXPECT_NEAR(reflectance("Ni 1\n"), 0.04f, 1e-6f);  // Maya's default, which means nothing
  const auto tinted = model<Principled>("Kd 0.5\nPr 0.5\nKs 0.5 0.25 0\nmap_Ks s.png\n", {.specular = 2});
  EXPECT_EQ(tinted.specular_color.value, (Rgb{1, 0.5f, 0}));
  EXPECT_EQ(tinted.specular_color.texture, 2);
}

// Opaque materials of 3ds Max and Maya, with a roughness map.
TEST(MtlMaterials, WithOtherProgramsTfAreOpaque) {
  for (const char* const keys : {"Ns 10\nNi 1.5\nd 1\nTr 0\nTf 1 1 1\nillum 2\nKa 0.6\nKd 0.6\nPr 0.4\n",
                                 "illum 4\nKd 0.6\nd 1\nTf 1 1 1\nNi 1\nPr 0.4\n"}) {
    EXPECT_EQ(model<Principled>(keys).transmission_weight.value, 0) << keys;
    EXPECT_TRUE(is_opaque(made(keys), {})) << keys;
  }
  EXPECT_EQ(made("Kd 0.6\nKs 0.5\nd 0\nillum 9\nPr 0.4\n").opacity.value, 0);  // alpha of 0 in Blender
}

TEST(MtlMaterials, OfThePhysicallyBasedExtensionTransmitByTfOrIllum) {
  // What Blender writes for transmission.
  const auto half =
      model<Principled>("Kd 0.8 0.4 0.2\nKs 0.5\nNi 1.33\nd 1\nillum 2\nTf 0.5\nPr 0.1\nPm 0\n");
  EXPECT_EQ(half.transmission_weight.value, 0.5f);
  EXPECT_EQ(half.transmission_color.value, (Rgb{0.8f, 0.4f, 0.2f}));
  EXPECT_EQ(half.specular_ior.value, 1.33f);
  const Material glass = made("Ni 1.33\nTf 0.9 1 0.9\nd 0.1\nillum 6\nPr 0.3\n");
  const auto& clear = std::get<Principled>(glass.model);
  EXPECT_EQ(clear.transmission_weight.value, 1);
  EXPECT_EQ(clear.transmission_color.value, (Rgb{0.9f, 1, 0.9f}));
  EXPECT_EQ(clear.specular_ior.value, 1.33f);
  EXPECT_EQ(clear.specular_roughness.value, 0.3f);
  EXPECT_EQ(glass.opacity.value, 1);
  // What Blender writes for metal of alpha 0.25.
  const Material metal = made("Kd 0.8\nKs 0.5\nNi 1.5\nd 0.25\nillum 6\nPr 0.3\nPm 1\n");
  EXPECT_EQ(std::get<Principled>(metal.model).transmission_weight.value, 0);
  EXPECT_EQ(metal.opacity.value, 0.25f);
}

// Both roughnesses keep Burley's ratio and geometric mean.
TEST(MtlMaterials, AreAnisotropicAsDisneys) {
  const auto m = model<Principled>("Kd 0.5\nPr 0.4\naniso 0.5\n");
  EXPECT_NEAR(m.specular_roughness_anisotropy.value, 0.45f, 1e-6f);
  const float alpha = m.specular_roughness.value * m.specular_roughness.value;
  const float narrow = 1 - m.specular_roughness_anisotropy.value;
  const float along = alpha * std::sqrt(2 / (1 + narrow * narrow));
  EXPECT_NEAR(along, 0.16f / std::sqrt(0.55f), 1e-5f);
  EXPECT_NEAR(along * narrow, 0.16f * std::sqrt(0.55f), 1e-5f);
}

// Files of Ks and Ns that also have layers of 0.
TEST(MtlMaterials, AreNotPhysicallyBasedByLayersOfNothing) {
  EXPECT_EQ(
      model<CookTorrance>("Kd 0.5\nKs 0.5\nNs 250\nPc 0\nPcr 0.03\nPs 0 0 0\naniso 0\n").roughness.value,
      0.5f);
}

TEST(MtlMaterials, ThatReflectAreMetalsOfTheirColor) {
  for (const auto illum : {"3", "5", "8"}) {
    const auto m = model<CookTorrance>("Kd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nNs 90\nillum " + std::string(illum));
    expect_near(m.f0.value, {0.9f, 0.6f, 0.2f});
    EXPECT_NEAR(m.roughness.value, 0.7f, 1e-6f);
  }
  // Blender writes metallic as Ka.
  expect_near(
      model<CookTorrance>("Ka 0.5 0.5 0.5\nKd 0.8 0.8 0.8\nKs 0.5 0.5 0.5\nNs 90\nillum 3\n").diffuse.value,
      Rgb::gray(0.4f));
  EXPECT_EQ(model<CookTorrance>("Kd 0.5\nKs 0.5\nNs 90\nillum 3\nmap_Kd a.png\n", kDiffuse).f0.texture, 0);
}

TEST(MtlMaterials, ThatReflectSharplyAreMirrors) {
  EXPECT_EQ(model<Mirror>("Kd 0 0 0\nKs 0.9 0.8 2\nillum 3\n").reflectance.value, (Rgb{0.9f, 0.8f, 1}));
  EXPECT_EQ(model<Mirror>("Kd 0.1 0.1 0.1\nKs 0.9 0.9 0.9\nillum 5\n").reflectance.value, Rgb::gray(0.9f));
  EXPECT_EQ(model<Mirror>("Kd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nNs 1000\nillum 3\n").reflectance.value,
            (Rgb{0.9f, 0.6f, 0.2f}));
}

TEST(MtlMaterials, AreGlassWhereTheyRefract) {
  for (const auto illum : {"4", "6", "7", "9"}) {
    const Material material = made("Ni 1.33\nTf 0.9 1 0.9\nd 1\nillum " + std::string(illum));
    const auto* glass = std::get_if<Glass>(&material.model);
    ASSERT_NE(glass, nullptr) << illum;
    EXPECT_EQ(glass->ior.value, 1.33f);
    EXPECT_EQ(glass->transmittance.value, (Rgb{0.9f, 1, 0.9f}));
    EXPECT_TRUE(is_opaque(material, {}));
  }
  EXPECT_EQ(model<Glass>("illum 7\n").ior.value, 1.5f);
  EXPECT_EQ(model<Glass>("d 0.1\nillum 7\n").transmittance.value, Rgb::gray(1));
  EXPECT_EQ(model<Glass>("illum 6\nmap_Ns r.png\n", {.roughness = 2}).roughness.texture, 2);
}

TEST(MtlMaterials, AreCutOutRatherThanGlass) {
  EXPECT_EQ(made("d 0.25\nNi 1.45\nillum 2\n").opacity.value, 0.25f);
  EXPECT_EQ(made("Tr 0.25\nKd 1 0 0\n").opacity.value, 0.75f);
  EXPECT_EQ(made("d 0.25\nTr 0.25\n").opacity.value, 0.25f);
  EXPECT_EQ(made("d 0.5\nNi 1.45\nillum 9\n").opacity.value, 0.5f);  // what Blender writes for its alpha
  const MtlTextures textures{.diffuse = 0, .opacity = 1};
  const Material leaf = made("Kd 1\nNi 1.5\nillum 4\nd 1\nmap_Kd a.png\nmap_d m.png\n", textures);
  EXPECT_EQ(leaf.opacity.texture, 1);
  EXPECT_EQ(std::get<Lambert>(leaf.model).albedo.texture, 0);
  EXPECT_EQ(made("d 0\nmap_d m.png\n", textures).opacity.value, 1);
}

TEST(MtlMaterials, OfMayaAreOpaqueAtIllum4) {
  const std::string maya = "illum 4\nKd 0.5 0.5 0.5\nKa 0 0 0\nNi 1.00\n";
  EXPECT_EQ(std::get<Lambert>(made(maya + "Tf 1.00 1.00 1.00\n").model).albedo.value, Rgb::gray(0.5f));
  EXPECT_TRUE(is_opaque(made(maya + "Tf 1.00 1.00 1.00\n"), {}));
  EXPECT_NEAR(made(maya + "Tf 0.25 0.25 0.25\n").opacity.value, 0.25f, 1e-6f);
}

TEST(MtlMaterials, EmitTheirColorTimesTheirMap) {
  EXPECT_EQ(made("Ke 17 12 4\n").emission.value, (Rgb{17, 12, 4}));
  const Material lamp = made("Ke 2 2 2\nmap_Ke a.png\n", {.emission = 5});
  EXPECT_EQ(lamp.emission.value, Rgb::gray(2));
  EXPECT_EQ(lamp.emission.texture, 5);
  EXPECT_EQ(made("map_Ke a.png\n", {.emission = 5}).emission.value, Rgb::gray(1));
}

TEST(MtlMaterials, HaveTheirNormalAndBumpMaps) {
  const Material normal = made("norm -bm 0.5 n.png\n", {.normal = 1});
  EXPECT_EQ(normal.normal_map.texture, 1);
  EXPECT_EQ(normal.normal_map.strength, 0.5f);
  EXPECT_EQ(made("map_Bump -bm 2 n.png\n", {.normal = 1}).normal_map.strength, 2);
  const Material bump = made("bump -bm 0.5 n.png\n", {.bump = 1});
  EXPECT_EQ(bump.bump.texture, 1);
  EXPECT_EQ(bump.bump.height, 0.5f);
}

TEST(MtlMaterials, ReflectTheirSpecularMap) {
  const auto m = model<CookTorrance>("Kd 0.2\nKs 1 1 1\nNs 100\nillum 2\nmap_Ks s.png\n", {.specular = 4});
  expect_near(m.f0.value, Rgb::gray(0.08f));
  EXPECT_EQ(m.f0.texture, 4);
}

}  // namespace
}  // namespace tessera::core::mtl_material_test
