// SPDX-License-Identifier: Apache-2.0
// Materials and textures of glTF files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core_gltf/material_file.hpp"

namespace tessera::core::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;

TEST(GltfMaterials, AreRoughMetalByDefault) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const Principled& model = model_of(*scene);
  EXPECT_EQ(model.base_color.value, Rgb::gray(1));
  EXPECT_EQ(model.base_metalness.value, 1);
  EXPECT_EQ(model.specular_roughness.value, 1);
}

TEST(GltfMaterials, HaveFactorsAndPackedTextures) {
  const auto scene = scene_of({{"name", "Paint"},
                               {"pbrMetallicRoughness",
                                {{"baseColorFactor", {0.5, 0.25, 1, 0.5}},
                                 {"baseColorTexture", texture()},
                                 {"metallicFactor", 0.5},
                                 {"roughnessFactor", 0.75},
                                 {"metallicRoughnessTexture", texture()}}},
                               {"normalTexture", {{"index", 0}, {"scale", 0.5}}}});
  ASSERT_EQ(scene.materials.size(), 1u);
  const Principled& model = model_of(scene);
  EXPECT_EQ(scene.materials[0].name, "Paint");
  EXPECT_EQ(model.base_color.value, (Rgb{0.5f, 0.25f, 1}));
  EXPECT_NEAR(texture_value(scene, model.base_color.texture).b, 0.75f, 5e-3f);  // sRGB, decoded
  EXPECT_EQ(model.base_metalness.value, 0.5f);
  EXPECT_EQ(model.specular_roughness.value, 0.75f);
  // The bytes themselves: of blue and of green.
  EXPECT_NEAR(texture_value(scene, model.base_metalness.texture).r, 225.0f / 255, 5e-3f);
  EXPECT_NEAR(texture_value(scene, model.specular_roughness.texture).r, 188.0f / 255, 5e-3f);
  EXPECT_NEAR(texture_value(scene, scene.materials[0].normal_map.texture).g, 188.0f / 255, 5e-3f);
  EXPECT_EQ(scene.materials[0].normal_map.strength, 0.5f);
  EXPECT_EQ(scene.materials[0].opacity.value, 1);  // alphaMode is OPAQUE
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(GltfMaterials, HaveOpacityByTheirAlphaMode) {
  const auto opacity = [](const char* mode, float alpha, float cutoff) {
    return scene_of({{"alphaMode", mode},
                     {"alphaCutoff", cutoff},
                     {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, alpha}}}}})
        .materials[0]
        .opacity.value;
  };
  EXPECT_EQ(opacity("OPAQUE", 0.25f, 0.5f), 1);
  EXPECT_EQ(opacity("BLEND", 0.25f, 0.5f), 0.25f);
  EXPECT_EQ(opacity("MASK", 0.25f, 0.5f), 0);
  EXPECT_EQ(opacity("MASK", 0.25f, 0.2f), 1);
}

// Transparent texels at alpha 0.5, masked by 0.5 times alpha of at least the cutoff.
TEST(GltfMaterials, MaskByTextures) {
  for (const auto& [cutoff, expected] : {std::pair(0.2f, 1.0f), std::pair(0.3f, 0.0f)}) {
    GltfFile file = file_with(
        {{"alphaMode", "MASK"},
         {"alphaCutoff", cutoff},
         {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}, {"baseColorTexture", texture()}}}});
    file.json["images"][0] = {{"uri", "image.tga"}};
    // An uncompressed TGA image of one texel with alpha.
    const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\1\0\1\0\x20\x28\xff\xff\xff\x80", 22);
    const auto scene = load_gltf(file.text(), {{"image.tga", tga}});
    ASSERT_TRUE(scene) << scene.error().message;
    const ScalarParameter& opacity = scene->materials[0].opacity;
    EXPECT_EQ(texture_value(*scene, opacity.texture).r * opacity.value, expected) << cutoff;
    EXPECT_TRUE(scene->warnings.empty());
  }
}

// Halfway between the centres of a clear and an opaque texel.
TEST(GltfMaterials, MaskBetweenTexels) {
  GltfFile file =
      file_with({{"alphaMode", "MASK"}, {"pbrMetallicRoughness", {{"baseColorTexture", texture()}}}});
  file.json["images"][0] = {{"uri", "image.tga"}};
  const std::string tga("\0\0\2\0\0\0\0\0\0\0\0\0\2\0\1\0\x20\x28\xff\xff\xff\0\xff\xff\xff\xff", 26);
  const auto scene = load_gltf(file.text(), {{"image.tga", tga}});
  ASSERT_TRUE(scene) << scene.error().message;
  const auto opacity = [&](float u) {
    return scene->materials[0].opacity.evaluate(scene->textures, Vec2{u, 0.5f});
  };
  EXPECT_EQ(opacity(0.48f), 0);
  EXPECT_EQ(opacity(0.52f), 1);
}

TEST(GltfMaterials, Emit) {
  json material = extension("KHR_materials_emissive_strength", {{"emissiveStrength", 10}});
  material["emissiveFactor"] = {1, 0.5, 0};
  const auto scene = scene_of(material);
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{10, 5, 0}));
  EXPECT_FALSE(scene.materials[0].two_sided_emission);
  material["doubleSided"] = true;
  EXPECT_TRUE(scene_of(material).materials[0].two_sided_emission);
}

TEST(GltfMaterials, OfExtensionsBecomeOpenPbr) {
  json material{{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"baseColorFactor", {1, 1, 1, 1}}}}};
  material["extensions"] = {
      {"KHR_materials_ior", {{"ior", 1.75}}},
      {"KHR_materials_specular", {{"specularFactor", 0.5}, {"specularColorFactor", {1, 0.5, 0.25}}}},
      {"KHR_materials_clearcoat", {{"clearcoatFactor", 0.75}, {"clearcoatRoughnessFactor", 0.25}}},
      {"KHR_materials_sheen", {{"sheenColorFactor", {0.5, 0.25, 0}}, {"sheenRoughnessFactor", 0.5}}},
      {"KHR_materials_transmission", {{"transmissionFactor", 0.5}, {"transmissionTexture", texture()}}},
      {"KHR_materials_volume",
       {{"thicknessFactor", 1}, {"attenuationDistance", 2}, {"attenuationColor", {0.5, 0.75, 1}}}},
      {"KHR_materials_dispersion", {{"dispersion", 0.5}}},
      {"KHR_materials_iridescence",
       {{"iridescenceFactor", 1}, {"iridescenceIor", 1.5}, {"iridescenceThicknessMaximum", 500}}}};
  const auto scene = scene_of(material);
  const Principled& model = model_of(scene);
  EXPECT_EQ(model.specular_ior.value, 1.75f);
  EXPECT_EQ(model.specular_weight.value, 0.5f);
  EXPECT_EQ(model.specular_color.value, (Rgb{1, 0.5f, 0.25f}));
  EXPECT_EQ(model.coat_weight.value, 0.75f);
  EXPECT_EQ(model.coat_roughness.value, 0.25f);
  EXPECT_EQ(model.coat_ior.value, 1.5f);
  EXPECT_EQ(model.fuzz_weight.value, 0.5f);
  EXPECT_EQ(model.fuzz_color.value, (Rgb{1, 0.5f, 0}));
  EXPECT_EQ(model.transmission_weight.value, 0.5f);
  EXPECT_NEAR(texture_value(scene, model.transmission_weight.texture).r, 137.0f / 255, 5e-3f);
  EXPECT_FALSE(model.geometry_thin_walled);
  EXPECT_EQ(model.transmission_color.value, Rgb::gray(1));
  const Rgb sigma_a = scene.media.at(static_cast<std::size_t>(scene.materials[0].media.interior)).sigma_a;
  EXPECT_NEAR(sigma_a.r, -std::log(0.5f) / 2, 1e-6f);
  EXPECT_NEAR(sigma_a.g, -std::log(0.75f) / 2, 1e-6f);
  EXPECT_EQ(sigma_a.b, 0);
  EXPECT_EQ(model.transmission_dispersion.inverse_abbe_number(), 0.5f / 20);
  EXPECT_EQ(model.thin_film_weight.value, 1);
  EXPECT_NEAR(model.thin_film_thickness.value, 0.5f, 1e-6f);
}

// With a map of its own; else flat, even over a base that has one.
TEST(GltfMaterials, DraftsThatNameParametersOfOpenPbr) {
  const json material = {
      {"extensions",
       {{"KHR_materials_diffuse_roughness", {{"diffuseRoughnessFactor", 0.25}}},
        {"KHR_materials_coat",
         {{"coatFactor", 0.5},
          {"coatRoughnessFactor", 0.25},
          {"coatIor", 1.75},
          {"coatColorFactor", {1, 0.5, 0.25}},
          {"coatDarkeningFactor", 0.75},
          {"coatNormalTexture", texture()}}},
        {"KHR_materials_fuzz",
         {{"fuzzFactor", 0.5}, {"fuzzColorFactor", {0.25, 0.5, 1}}, {"fuzzRoughnessFactor", 0.125}}}}}};
  const SceneDescription scene = scene_of(material);
  EXPECT_EQ(warnings_of(scene), "");
  const Principled& model = model_of(scene);
  EXPECT_EQ(model.base_diffuse_roughness.value, 0.25f);
  EXPECT_EQ(model.coat_weight.value, 0.5f);
  EXPECT_EQ(model.coat_roughness.value, 0.25f);
  EXPECT_EQ(model.coat_ior.value, 1.75f);
  EXPECT_EQ(model.coat_color.value, (Rgb{1, 0.5f, 0.25f}));
  EXPECT_EQ(model.coat_darkening.value, 0.75f);
  EXPECT_GE(model.geometry_coat_normal.texture, 0);
  EXPECT_EQ(model.fuzz_weight.value, 0.5f);
  EXPECT_EQ(model.fuzz_color.value, (Rgb{0.25f, 0.5f, 1}));
  EXPECT_EQ(model.fuzz_roughness.value, 0.125f);
  const SceneDescription turned =
      scene_of(extension("KHR_materials_coat", {{"coatFactor", 1},
                                                {"coatRoughnessFactor", 0.5},
                                                {"coatAnisotropyStrength", 1},
                                                {"coatAnisotropyRotation", kPi / 2}}));
  const Principled& stretched = model_of(turned);
  EXPECT_NEAR(stretched.coat_roughness_anisotropy.value, 0.75, 1e-6);
  EXPECT_NEAR(stretched.coat_tangent.rotation.value, 0.25, 1e-6);
}

TEST(GltfMaterials, DiffuseRoughnessIsRed) {
  const auto scene =
      scene_of(extension("KHR_materials_diffuse_roughness",
                         {{"diffuseRoughnessFactor", 1}, {"diffuseRoughnessTexture", texture()}}));
  EXPECT_NEAR(texture_value(scene, model_of(scene).base_diffuse_roughness.texture).r, 137.0f / 255, 5e-3f);
}

TEST(GltfMaterials, CoatsHaveTheirOwnNormals) {
  json material = extension("KHR_materials_clearcoat", {{"clearcoatFactor", 1}});
  EXPECT_EQ(model_of(scene_of(material)).geometry_coat_normal.texture, -1);
  material["normalTexture"] = texture();
  const auto flat = scene_of(material);
  EXPECT_GE(model_of(flat).geometry_coat_normal.texture, 0);
  EXPECT_EQ(model_of(flat).geometry_coat_normal.strength, 0);
  EXPECT_EQ(warnings_of(flat), "");
  material["extensions"]["KHR_materials_clearcoat"]["clearcoatNormalTexture"] = {{"index", 0},
                                                                                 {"scale", 0.25}};
  const auto mapped = scene_of(material);
  EXPECT_GE(model_of(mapped).geometry_coat_normal.texture, 0);
  EXPECT_EQ(model_of(mapped).geometry_coat_normal.strength, 0.25f);
  EXPECT_EQ(warnings_of(mapped), "");
}

TEST(GltfMaterials, TransmitAsSheetsWithoutVolume) {
  json material = extension("KHR_materials_transmission", {{"transmissionFactor", 1}});
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 1, 1, 1}}};
  const auto scene = scene_of(material);
  EXPECT_TRUE(model_of(scene).geometry_thin_walled);
  EXPECT_EQ(model_of(scene).transmission_color.value, (Rgb{0.5f, 1, 1}));
}

// The base colour at the boundary, the attenuation inside.
TEST(GltfMaterials, TransmitThroughVolumesByBothColors) {
  json material = extension("KHR_materials_transmission", {{"transmissionFactor", 1}});
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 1, 1, 1}}};
  material["extensions"]["KHR_materials_volume"] = {
      {"thicknessFactor", 1}, {"attenuationDistance", 1}, {"attenuationColor", {1, 0.5, 1}}};
  const auto scene = scene_of(material);
  EXPECT_EQ(model_of(scene).transmission_color.value, (Rgb{0.5f, 1, 1}));
  EXPECT_EQ(model_of(scene).transmission_depth.value, 0);
  EXPECT_EQ(scene.media.at(0).sigma_a.r, 0);
  EXPECT_NEAR(scene.media.at(0).sigma_a.g, std::log(2.0f), 1e-6f);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(GltfMaterials, ThatAreUnlitEmitTheirColor) {
  json material = extension("KHR_materials_unlit", json::object());
  material["pbrMetallicRoughness"] = {{"baseColorFactor", {0.5, 0.25, 1, 1}}};
  const auto scene = scene_of(material);
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{0.5f, 0.25f, 1}));
  EXPECT_EQ(std::get<Lambert>(scene.materials[0].model).albedo.value, Rgb{});
  EXPECT_THAT(warnings_of(scene), HasSubstr("an unlit surface is rendered as one that emits its colour"));
}

// Below the gloss, in place of a part of the diffuse reflection.
TEST(GltfMaterials, TransmitDiffuselyAsSheets) {
  json material =
      extension("KHR_materials_diffuse_transmission",
                {{"diffuseTransmissionFactor", 0.25}, {"diffuseTransmissionColorFactor", {0.5, 1, 0}}});
  material["pbrMetallicRoughness"] = {{"metallicFactor", 0}};
  const auto scene = scene_of(material);
  const Principled& model = model_of(scene);
  EXPECT_EQ(model.subsurface_weight.value, 0.25f);
  EXPECT_EQ(model.subsurface_color.value, (Rgb{0.5f, 1, 0}));
  EXPECT_EQ(model.subsurface_scatter_anisotropy, 1);
  EXPECT_TRUE(model.geometry_thin_walled);
  EXPECT_EQ(warnings_of(scene), "");
  material["extensions"]["KHR_materials_volume"] = {{"thicknessFactor", 1}};
  EXPECT_THAT(warnings_of(scene_of(material)), HasSubstr("becomes a sheet, which does not absorb"));
  material["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 0.5}};
  EXPECT_THAT(warnings_of(scene_of(material)), HasSubstr("has no diffuse transmission"));
  material["extensions"]["KHR_materials_transmission"] = {{"transmissionFactor", 1}};
  EXPECT_EQ(warnings_of(scene_of(material)), "");  // clear transmission comes first
}

TEST(GltfMaterials, SayWhatIsIgnored) {
  const auto warning = [](const json& material) { return warnings_of(scene_of(material)); };
  EXPECT_THAT(warning({{"occlusionTexture", texture()}}), HasSubstr("baked occlusion is ignored"));
  json dispersive = extension("KHR_materials_transmission", {{"transmissionFactor", 1}});
  dispersive["extensions"]["KHR_materials_dispersion"] = {{"dispersion", 1}};
  EXPECT_THAT(warning(dispersive), HasSubstr("only volumes with a thickness have dispersion"));
  json film = extension("KHR_materials_transmission", {{"transmissionFactor", 1}});
  film["extensions"]["KHR_materials_iridescence"] = {{"iridescenceFactor", 1}};
  EXPECT_THAT(warning(film), HasSubstr("iridescence does not change what a transmissive surface reflects"));
  EXPECT_THAT(warning({{"pbrMetallicRoughness", {{"metallicFactor", 2}}}}),
              HasSubstr("materials[0].pbrMetallicRoughness.metallicFactor: must be between 0 and 1"));
  GltfFile missing = file_with({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture()}});
  missing.json["images"][0] = {{"uri", "lost.png"}};
  const auto scene = load_file(missing);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene),
              HasSubstr("images[0]: there is no file 'lost.png'; the texture is ignored"));
}

// EXT_texture_webp names another image, which is read.
TEST(GltfTextures, CanBeWebp) {
  GltfFile file = file_with({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture()}});
  file.json["extensionsRequired"] = {"EXT_texture_webp"};
  file.json["images"].push_back(
      {{"uri", "data:image/webp;base64,UklGRhoAAABXRUJQVlA4\r\nTA0AAAAvAAAAEAcQERGIiP4HAA==\n"}});
  file.json["textures"][0] = {{"extensions", {{"EXT_texture_webp", {{"source", 1}}}}}};
  const auto scene = load_file(file);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(warnings_of(*scene), "");
  EXPECT_EQ(scene->textures.at(0).image->width(), 1);
}

// Scales by (2, 3), rotates by a quarter turn, moves by (0.25, 0.5): (u, v) -> (3 v + 0.25, 0.5 - 2 u), v
// down.
TEST(GltfTextures, AreTransformed) {
  json info = texture();
  info["extensions"]["KHR_texture_transform"] = {
      {"scale", {2, 3}}, {"rotation", 1.57079633}, {"offset", {0.25, 0.5}}};
  const auto scene = scene_of({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", info}});
  const Texture& t = scene.textures[0];
  const float u = 0.125f, v = 0.0625f, up = 1 - v;
  EXPECT_NEAR(t.scale.x * u + t.shear.x * up + t.offset.x, 3 * v + 0.25f, 1e-5f);
  EXPECT_NEAR(t.scale.y * up + t.shear.y * u + t.offset.y, 1 - (0.5f - 2 * u), 1e-5f);
}

TEST(GltfTextures, WrapAsTheirSamplersSay) {
  GltfFile file = file_with({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture()}});
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}, {"magFilter", 9728}}};
  file.json["textures"][0]["sampler"] = 0;
  const auto scene = load_file(file);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->textures[0].wrap, Wrap::kClamp);
  EXPECT_EQ(scene->textures[0].wrap_v, Wrap::kMirror);
  EXPECT_EQ(scene->textures[0].filter, TextureFilter::kNearest);
}

TEST(GltfTextures, UseTheirSetOfCoordinates) {
  json info = texture();
  info["texCoord"] = 1;
  GltfFile file = file_with({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", info}});
  file.json["meshes"][0]["primitives"][0]["attributes"]["TEXCOORD_1"] =
      file.floats("VEC2", {0, 0, 0.5f, 0, 0, 0.5f});
  const auto scene = load_file(file);
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).uvs[1], (Vec2{0.5f, 1}));
}

TEST(GltfTextures, AreReadFromEveryPlace) {
  const std::string image = png(one_color(3, 1, {1, 0, 0}));
  for (const bool in_buffer : {true, false}) {
    GltfFile file = file_with({{"emissiveFactor", {1, 1, 1}}, {"emissiveTexture", texture()}});
    if (in_buffer)
      file.json["images"][0] = {{"bufferView", file.view(image)}, {"mimeType", "image/png"}};
    else
      file.json["images"][0] = {{"uri", "data:image/png;base64," + base64(image)}};
    const auto scene = load_file(file);
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(warnings_of(*scene), "");
    EXPECT_EQ(scene->textures[0].image->width(), 3);
  }
}

}  // namespace
}  // namespace tessera::core::test
