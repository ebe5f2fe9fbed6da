// SPDX-License-Identifier: Apache-2.0
// Materials of MTL files become what the programs that write them show.
#include "core/scene/loader/mtl_material.hpp"

#include <gtest/gtest.h>

namespace tessera::core {
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

TEST(MtlMaterials, OfPhysicallyBasedExtensionsAreMicrofacets) {
  const auto gold =
      model<CookTorrance>("Ns 0\nKa 1 1 1\nKd 0.9 0.6 0.2\nKs 0.5 0.5 0.5\nillum 3\nPr 0.6\nPm 1\n");
  EXPECT_TRUE(is_black(gold.diffuse.value));
  expect_near(gold.f0.value, {0.9f, 0.6f, 0.2f});
  EXPECT_EQ(gold.roughness.value, 0.6f);
  EXPECT_EQ(gold.specular.value, Rgb::gray(1));
  const auto plastic = model<CookTorrance>(
      "Kd 0.8 0.1 0.1\nKs 0.5 0.5 0.5\nillum 3\nPr 0.8\nPm 0.25\nmap_Kd a.png\n", kDiffuse);
  expect_near(plastic.diffuse.value, {0.6f, 0.075f, 0.075f});
  EXPECT_EQ(plastic.diffuse.texture, 0);
  expect_near(plastic.f0.value, {0.23f, 0.055f, 0.055f});
  EXPECT_EQ(plastic.f0.texture, 0);
  MtlTextures textures{.roughness = 3};
  textures.metallic = 1.0f;
  const auto mapped = model<CookTorrance>("Kd 0.5\nPr 0.1\nmap_Pr r.png\nmap_Pm m.png\n", textures);
  EXPECT_EQ(mapped.roughness.texture, 3);
  EXPECT_EQ(mapped.roughness.value, 1);
  expect_near(mapped.f0.value, Rgb::gray(0.5f));
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
  EXPECT_EQ(model<Glass>("illum 6\nPr 0.3\n").roughness.value, 0.3f);
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
}  // namespace tessera::core
