// SPDX-License-Identifier: Apache-2.0
// What the materials of glTF files reflect at their boundary: coats, roughness and its direction, specular
// colours.
#include <gmock/gmock.h>

#include <cmath>

#include "tests/unit/core_gltf/material_file.hpp"

namespace tessera::core::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

// OpenPBR divides the base's index by mix(1, coat_ior, coat_weight); glTF's base reflects as in air.
TEST(GltfReflection, CoatsLeaveTheReflectanceOfTheBase) {
  json material = extension("KHR_materials_clearcoat", {{"clearcoatFactor", 0.5}});
  EXPECT_FLOAT_EQ(model_of(scene_of(material)).specular_ior.value, 1.5f * 1.25f);
  material["extensions"]["KHR_materials_clearcoat"]["clearcoatTexture"] = texture();
  const auto textured = scene_of(material);
  const ScalarParameter& index = model_of(textured).specular_ior;
  const float weight = 0.5f * 137 / 255;
  EXPECT_NEAR(index.value * texture_value(textured, index.texture).r, 1.5f * (1 + 0.5f * weight), 5e-3f);
  const auto draft = scene_of(extension("KHR_materials_coat", {{"coatFactor", 1}, {"coatIor", 1.75}}));
  EXPECT_FLOAT_EQ(model_of(draft).specular_ior.value, 1.5f * 1.75f);
  material["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 0.5}};
  const auto clear = scene_of(material);
  EXPECT_EQ(model_of(clear).specular_ior.value, 1.5f);
  EXPECT_THAT(warnings_of(clear), HasSubstr("reflects less below its coat"));
}

// OpenPBR adds twice the fourth power of the coat's roughness to that of the base.
TEST(GltfReflection, RoughClearcoatsLeaveTheRoughnessOfTheBase) {
  json material =
      extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}, {"clearcoatRoughnessFactor", 0.25}});
  material["pbrMetallicRoughness"] = {{"roughnessFactor", 0.5}};
  const auto even = scene_of(material);
  EXPECT_NEAR(std::pow(model_of(even).specular_roughness.value, 4.0f) + 2 * std::pow(0.25f, 4.0f),
              std::pow(0.5f, 4.0f), 1e-4f);
  EXPECT_EQ(warnings_of(even), "");
  material["extensions"]["KHR_materials_clearcoat"]["clearcoatRoughnessTexture"] = texture();
  const auto textured = scene_of(material);
  const float coat = 0.25f * 188 / 255,
              base = texture_value(textured, model_of(textured).specular_roughness.texture).r;
  EXPECT_NEAR(std::pow(base, 4.0f) + 2 * std::pow(coat, 4.0f), std::pow(0.5f, 4.0f), 1e-3f);
  material["pbrMetallicRoughness"]["roughnessFactor"] = 0.125;
  EXPECT_THAT(warnings_of(scene_of(material)), HasSubstr("also roughens the base"));
}

TEST(GltfReflection, DraftsTakePrecedence) {
  json material = extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}});
  material["extensions"]["KHR_materials_coat"] = {{"coatFactor", 0}};
  material["extensions"]["KHR_materials_sheen"] = {{"sheenColorFactor", {1, 1, 1}}};
  material["extensions"]["KHR_materials_fuzz"] = {{"fuzzFactor", 0}};
  const auto scene = scene_of(material);
  EXPECT_EQ(model_of(scene).coat_weight.value, 0);
  EXPECT_EQ(model_of(scene).fuzz_weight.value, 0);
}

// Along the direction alpha is mix(0.25, 1, strength^2) = 0.4375, across it 0.25.
TEST(GltfReflection, AnisotropyIsARatioOfAlphas) {
  json material = extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}});
  material["pbrMetallicRoughness"] = {{"roughnessFactor", 0.5}};
  const auto even = scene_of(material);
  const auto expected = [](float along) {
    const float ratio = 0.25f / along;
    return std::pair(1 - ratio, std::sqrt(along / std::sqrt(2 / (1 + ratio * ratio))));
  };
  EXPECT_FLOAT_EQ(model_of(even).specular_roughness_anisotropy.value, expected(0.4375f).first);
  EXPECT_FLOAT_EQ(model_of(even).specular_roughness.value, expected(0.4375f).second);
  EXPECT_EQ(warnings_of(even), "");
  // The blue of the image, 225 as stored, is a factor of the strength.
  material["extensions"]["KHR_materials_anisotropy"]["anisotropyTexture"] = texture();
  const auto textured = scene_of(material);
  const float strength = 0.5f * 225 / 255, along = 0.25f + 0.75f * strength * strength;
  const Principled& model = model_of(textured);
  EXPECT_NEAR(texture_value(textured, model.specular_roughness_anisotropy.texture).r, expected(along).first,
              5e-3f);
  EXPECT_NEAR(texture_value(textured, model.specular_roughness.texture).r, expected(along).second, 5e-3f);
  EXPECT_EQ(warnings_of(textured), "");
}

// F0 = 8 * 0.04 of the strongest channel.
TEST(GltfReflection, SpecularColorsAboveOneRaiseTheIndex) {
  json material = extension("KHR_materials_specular", {{"specularColorFactor", {8, 4, 0}}});
  material["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
  const auto scene = scene_of(material);
  const Principled& model = model_of(scene);
  const float root = std::sqrt(0.32f);
  EXPECT_FLOAT_EQ(model.specular_ior.value, (1 + root) / (1 - root));
  EXPECT_NEAR(model.specular_color.value.r, 1, 1e-5f);
  EXPECT_NEAR(model.specular_color.value.g, 0.5f, 1e-5f);
  EXPECT_EQ(model.specular_color.value.b, 0);
  EXPECT_EQ(warnings_of(scene), "");
  material["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  EXPECT_GT(model_of(scene_of(material)).specular_ior.value, 1.5f);  // a sheet does not refract
  material["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1}};
  const auto solid = scene_of(material);
  EXPECT_EQ(model_of(solid).specular_ior.value, 1.5f);
  EXPECT_THAT(warnings_of(solid), HasSubstr("would change the refraction"));
}

// Blender writes 0 for surfaces without highlight; the base keeps its brightness.
TEST(GltfReflection, SpecularColorsBelowOneLowerTheIndex) {
  const auto model_of_color = [](const json& color) {
    json material = extension("KHR_materials_specular", {{"specularColorFactor", color}});
    material["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
    return model_of(scene_of(material));
  };
  const Principled half = model_of_color({0.5, 0.25, 0});
  const float root = std::sqrt(0.02f);
  EXPECT_FLOAT_EQ(half.specular_ior.value, (1 + root) / (1 - root));
  EXPECT_NEAR(half.specular_color.value.r, 1, 1e-5f);
  EXPECT_NEAR(half.specular_color.value.g, 0.5f, 1e-5f);
  EXPECT_EQ(half.specular_color.value.b, 0);
  for (const float faint : {0.0f, 1e-15f, 1e-30f}) {
    const Principled none = model_of_color({faint, 0, 0});
    EXPECT_EQ(none.specular_ior.value, 1);
    EXPECT_EQ(none.specular_color.value, Rgb::gray(1));
  }
}

TEST(GltfReflection, HasPlainShadingNormals) {
  EXPECT_EQ(scene_of(json::object()).materials[0].shading_normals, ShadingNormals::kPlain);
}

TEST(GltfReflection, SpecularGlossinessIsADielectricOfItsReflectance) {
  const auto scene = scene_of(extension(
      "KHR_materials_pbrSpecularGlossiness",
      {{"diffuseFactor", {1, 0.5, 0, 1}}, {"specularFactor", {0.25, 0.125, 0}}, {"glossinessFactor", 0.75}}));
  const Principled& model = model_of(scene);
  EXPECT_FLOAT_EQ(model.specular_ior.value, 3);
  EXPECT_EQ(model.specular_color.value, (Rgb{1, 0.5f, 0}));
  EXPECT_EQ(model.base_color.value, (Rgb{0.75f, 0.375f, 0}));  // diffuse (1 - max F0)
  EXPECT_EQ(model.base_metalness.value, 0);
  EXPECT_EQ(model.specular_roughness.value, 0.25f);
  EXPECT_EQ(warnings_of(scene), "");
}

// Without diffuse colour F0 is that of the metal; else both mix.
TEST(GltfReflection, SpecularGlossinessOfMetals) {
  const json gold{{"diffuseFactor", {0, 0, 0, 1}}, {"specularFactor", {1, 0.75, 0.25}}};
  const auto even = scene_of(extension("KHR_materials_pbrSpecularGlossiness", gold));
  EXPECT_EQ(model_of(even).base_metalness.value, 1);
  EXPECT_EQ(model_of(even).base_color.value, (Rgb{1, 0.75f, 0.25f}));
  const auto textured =
      scene_of(extension("KHR_materials_pbrSpecularGlossiness",
                         {{"diffuseFactor", {0.5, 0.5, 0.5, 1}}, {"specularGlossinessTexture", texture()}}));
  const Principled& model = model_of(textured);
  const Rgb base = texture_value(textured, model.base_color.texture);
  const Rgb tint = texture_value(textured, model.specular_color.texture);
  const float metal = texture_value(textured, model.base_metalness.texture).r;
  EXPECT_NEAR(metal * base.g + (1 - metal) * 0.04f * tint.g, 0.5f, 0.05f);
  EXPECT_NEAR((1 - metal) * base.g, 0.5f * (1 - 0.75f), 0.05f);
  EXPECT_THAT(warnings_of(textured), HasSubstr("a mixture of a dielectric and a metal"));
}

// The same image with the same factors, once as the colour and once as the reflectance.
TEST(GltfReflection, WhatIsMadeOfAnImageDependsOnItsUse) {
  GltfFile file =
      file_with(extension("KHR_materials_pbrSpecularGlossiness", {{"diffuseTexture", texture()}}));
  file.json["materials"].push_back(
      extension("KHR_materials_pbrSpecularGlossiness", {{"specularGlossinessTexture", texture()}}));
  file.node({{"mesh", file.triangle(1)}});
  const auto scene = load_file(file);
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->materials.size(), 2u);
  const auto alone =
      scene_of(extension("KHR_materials_pbrSpecularGlossiness", {{"specularGlossinessTexture", texture()}}));
  const auto metalness = [](const SceneDescription& of, std::size_t material) {
    return texture_value(of, model_of(of, material).base_metalness.texture);
  };
  EXPECT_EQ(metalness(*scene, 1), metalness(alone, 0));
  EXPECT_NE(metalness(*scene, 1), metalness(*scene, 0));
}

// Green of one texture is the roughness, blue of the other a factor of the strength.
TEST(GltfReflection, AnisotropyFollowsTexturesOfRoughness) {
  const float alpha = std::pow(188.0f / 255, 2.0f);
  for (const bool has_strength : {false, true}) {
    json material = extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}});
    material["pbrMetallicRoughness"] = {{"metallicRoughnessTexture", texture()}};
    if (has_strength) material["extensions"]["KHR_materials_anisotropy"]["anisotropyTexture"] = texture();
    const auto scene = scene_of(material);
    const float strength = has_strength ? 0.5f * 225 / 255 : 0.5f;
    const float ratio = alpha / (alpha + (1 - alpha) * strength * strength);
    EXPECT_NEAR(texture_value(scene, model_of(scene).specular_roughness_anisotropy.texture).r, 1 - ratio,
                5e-3f);
    EXPECT_NEAR(texture_value(scene, model_of(scene).specular_roughness.texture).r,
                std::sqrt(alpha / ratio / std::sqrt(2 / (1 + ratio * ratio))), 5e-3f);
    EXPECT_EQ(warnings_of(scene), "");
  }
}

TEST(GltfReflection, CombineTexturesOfOneMapping) {
  json material =
      extension("KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}, {"anisotropyTexture", texture()}});
  material["extensions"]["KHR_materials_anisotropy"]["anisotropyTexture"]["extensions"] = {
      {"KHR_texture_transform", {{"scale", {2, 2}}}}};
  material["pbrMetallicRoughness"] = {{"metallicRoughnessTexture", texture()}};
  EXPECT_THAT(warnings_of(scene_of(material)), HasSubstr("is mapped otherwise than"));
}

// Red and green of the texture are the direction, which the rotation turns.
TEST(GltfReflection, AnisotropyHasADirection) {
  json material = extension(
      "KHR_materials_anisotropy",
      {{"anisotropyStrength", 0.5}, {"anisotropyRotation", 1.57079633}, {"anisotropyTexture", texture()}});
  const auto scene = scene_of(material);
  const TangentDirection& tangent = model_of(scene).tangent;
  EXPECT_NEAR(tangent.rotation.value, 0.25f, 1e-6f);
  const Rgb texel = texture_value(scene, tangent.map.texture);
  EXPECT_NEAR(texel.r, 137.0f / 255, 5e-3f);
  EXPECT_NEAR(texel.g, 188.0f / 255, 5e-3f);
  EXPECT_EQ(warnings_of(scene), "");
}

}  // namespace
}  // namespace tessera::core::test
