// SPDX-License-Identifier: Apache-2.0
// What materials and textures of good scene files turn into.
#include <gtest/gtest.h>

#include <utility>

#include "core/image/encode.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::load_valid;
using test::MemoryAssets;
using test::scene_with;

TEST(SceneReading, TakesTexturedEmissionAsBrightAsOneLikes) {
  const SceneDescription scene = load_valid(scene_with(
      "\"textures\": {\"t\": {\"file\": \"gray.png\"}}",
      "\"screen\": {\"type\": \"lambert\", \"emission\": {\"texture\": \"t\", \"tint\": [9, 8, 7]}}", ""));
  EXPECT_EQ(scene.materials[0].emission.texture, 0);
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{9, 8, 7}));
}

TEST(SceneReading, TakesMaterials) {
  const SceneDescription scene = load_valid(
      scene_with("\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"}}",
                 "\"a\": {\"type\": \"lambert\", \"albedo\": [0.1, 0.2, 0.3]},"
                 "\"b\": {\"type\": \"mirror\", \"reflectance\": {\"texture\": \"t1\"}},"
                 "\"c\": {\"type\": \"glass\", \"ior\": 1.33, \"reflectance\": 0.9, \"transmittance\": "
                 "{\"texture\": \"t0\", \"tint\": [1, 0.5, 0]}}",
                 ""));
  EXPECT_EQ(std::get<Lambert>(scene.materials[0].model).albedo.value, (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_EQ(std::get<Lambert>(scene.materials[0].model).albedo.texture, -1);
  EXPECT_EQ(std::get<Mirror>(scene.materials[1].model).reflectance.texture, 1);
  EXPECT_EQ(std::get<Mirror>(scene.materials[1].model).reflectance.value, Rgb::gray(1));
  const Glass& glass = std::get<Glass>(scene.materials[2].model);
  EXPECT_EQ(glass.ior.value, 1.33f);
  EXPECT_EQ(glass.reflectance.value, Rgb::gray(0.9f));
  EXPECT_EQ(glass.transmittance.texture, 0);
  EXPECT_EQ(glass.transmittance.value, (Rgb{1, 0.5f, 0}));
}

TEST(SceneReading, TakesGlossyMaterials) {
  const SceneDescription scene = load_valid(scene_with(
      "\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"}}",
      "\"a\": {\"type\": \"glass\", \"fresnel\": \"none\", \"roughness\": {\"texture\": \"t1\", \"scale\": "
      "0.5}},"
      "\"b\": {\"type\": \"phong\", \"diffuse\": 0.2, \"specular\": [0.8, 0.1, 0], \"exponent\": 99, "
      "\"lobe\": \"n+2\", \"sampling\": \"uniform\"},"
      "\"c\": {\"type\": \"cook_torrance\", \"conductor\": \"silver\", \"roughness\": 0.5, "
      "\"masking\": \"schlick\", \"sampling\": \"half_vector\", "
      "\"normal_map\": {\"texture\": \"t1\", \"strength\": 0.5}},"
      "\"d\": {\"type\": \"cook_torrance\"}",
      ""));
  const Glass& glass = std::get<Glass>(scene.materials[0].model);
  EXPECT_EQ(glass.fresnel, DielectricFresnel::kNone);
  EXPECT_EQ(glass.roughness.texture, 1);
  EXPECT_EQ(glass.roughness.value, 0.5f);
  const Phong& phong = std::get<Phong>(scene.materials[1].model);
  EXPECT_EQ(phong.diffuse.value, Rgb::gray(0.2f));
  EXPECT_EQ(phong.specular.value, (Rgb{0.8f, 0.1f, 0}));
  EXPECT_EQ(phong.exponent.value, 99);
  EXPECT_EQ(phong.lobe, PhongLobe::kNPlus2);
  EXPECT_EQ(scene.materials[1].sampling, Sampling::kUniform);
  const CookTorrance& metal = std::get<CookTorrance>(scene.materials[2].model);
  EXPECT_EQ(metal.conductor, Conductor::kSilver);
  EXPECT_EQ(metal.roughness.value, 0.5f);
  EXPECT_EQ(metal.masking, Masking::kSchlick);
  EXPECT_EQ(scene.materials[2].sampling, Sampling::kHalfVector);
  EXPECT_EQ(scene.materials[2].normal_map.texture, 1);
  EXPECT_EQ(scene.materials[2].normal_map.strength, 0.5f);
  const CookTorrance& lacquer = std::get<CookTorrance>(scene.materials[3].model);
  EXPECT_FALSE(lacquer.conductor);
  EXPECT_EQ(lacquer.f0.value, Rgb::gray(0.04f));
  EXPECT_EQ(scene.materials[3].sampling, Sampling::kBsdf);
  EXPECT_EQ(scene.materials[3].normal_map.texture, -1);
}

TEST(SceneReading, TakesLayeredMaterials) {
  const SceneDescription scene = load_valid(scene_with(
      "\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"}}",
      "\"a\": {\"type\": \"principled\", \"base_color\": {\"texture\": \"t0\"}, \"specular_ior\": 1.4, "
      "\"coat_weight\": {\"texture\": \"t1\", \"scale\": 0.5}, \"thin_film_thickness\": 2, "
      "\"geometry_thin_walled\": true, \"subsurface_scatter_anisotropy\": -0.5, \"sides\": \"front\"},"
      "\"b\": {\"type\": \"plastic\", \"diffuse\": 0.2, \"nonlinear\": true, \"compensated\": false},"
      "\"c\": {\"type\": \"conductor\", \"eta\": [0.1, 1, 2], \"k\": 30, \"roughness\": 0.5, "
      "\"distribution\": \"beckmann\", \"masking\": \"separable\"},"
      "\"d\": {\"type\": \"conductor\", \"metal\": \"brass\"},"
      "\"e\": {\"type\": \"diffuse_transmission\", \"transmittance\": 0.75},"
      "\"f\": {\"type\": \"thin_dielectric\", \"ior\": 1.3},"
      "\"g\": {\"type\": \"blend\", \"materials\": [\"b\", \"a\"], \"weight\": 0.25},"
      "\"h\": {\"type\": \"null\"},"
      "\"i\": {\"type\": \"disney\", \"metallic\": 0.25, \"ior\": 2, \"clearcoat\": {\"texture\": \"t1\"}, "
      "\"thin_walled\": true, \"shading_normals\": \"plain\"}",
      ""));
  const Disney& disney = std::get<Disney>(scene.materials[8].model);
  EXPECT_EQ(disney.metallic.value, 0.25f);
  EXPECT_EQ(disney.ior.value, 2);
  EXPECT_EQ(disney.clearcoat.texture, 1);
  EXPECT_TRUE(disney.thin_walled);
  EXPECT_EQ(scene.materials[8].shading_normals, ShadingNormals::kPlain);
  const Principled& principled = std::get<Principled>(scene.materials[0].model);
  EXPECT_EQ(principled.base_color.texture, 0);
  EXPECT_EQ(principled.specular_ior.value, 1.4f);
  EXPECT_EQ(principled.coat_weight.texture, 1);
  EXPECT_EQ(principled.coat_weight.value, 0.5f);
  EXPECT_EQ(principled.thin_film_thickness.value, 2);
  EXPECT_EQ(principled.specular_roughness.value, 0.3f);
  EXPECT_TRUE(principled.geometry_thin_walled);
  EXPECT_EQ(principled.subsurface_scatter_anisotropy, -0.5f);
  EXPECT_FALSE(scene.materials[0].two_sided);
  const Plastic& plastic = std::get<Plastic>(scene.materials[1].model);
  EXPECT_EQ(plastic.diffuse.value, Rgb::gray(0.2f));
  EXPECT_TRUE(plastic.nonlinear);
  EXPECT_FALSE(plastic.compensated);
  EXPECT_TRUE(plastic.microfacets.is_correlated_ggx());
  EXPECT_TRUE(scene.materials[1].two_sided);
  const ConductorMaterial& metal = std::get<ConductorMaterial>(scene.materials[2].model);
  EXPECT_EQ(metal.eta.value, (Rgb{0.1f, 1, 2}));
  EXPECT_EQ(metal.microfacets.distribution, MicrofacetDistribution::kBeckmann);
  EXPECT_EQ(metal.microfacets.masking, SmithMasking::kSeparable);
  EXPECT_EQ(metal.k.value, Rgb::gray(30));
  EXPECT_EQ(metal.roughness.value, 0.5f);
  EXPECT_EQ(std::get<ConductorMaterial>(scene.materials[3].model).eta.value,
            complex_index(Conductor::kBrass).eta);
  EXPECT_EQ(std::get<DiffuseTransmission>(scene.materials[4].model).transmittance.value, Rgb::gray(0.75f));
  EXPECT_EQ(std::get<ThinDielectric>(scene.materials[5].model).ior.value, 1.3f);
  const Blend& blend = std::get<Blend>(scene.materials[6].model);
  EXPECT_EQ(blend.first, 1u);
  EXPECT_EQ(blend.second, 0u);
  EXPECT_EQ(blend.weight.value, 0.25f);
  EXPECT_TRUE(std::holds_alternative<Null>(scene.materials[7].model));
}

TEST(SceneReading, WarnsOfWhatIsApproximated) {
  const SceneDescription scene = load_valid(scene_with(
      "",
      "\"wax\": {\"type\": \"principled\", \"subsurface_weight\": 0.5}, \"clay\": {\"type\": \"principled\"}",
      ""));
  EXPECT_EQ(
      scene.warnings,
      std::vector<std::string>{"materials.wax: subsurface scattering is approximated by diffuse reflection"});
}

TEST(SceneReading, TakesOpacityAndBumps) {
  const SceneDescription scene = load_valid(scene_with(
      "\"textures\": {\"t0\": {\"file\": \"gray.png\"}, "
      "\"t1\": {\"file\": \"gray.png\", \"channel\": \"alpha\"}}",
      "\"a\": {\"type\": \"lambert\", \"opacity\": 0.25, \"bump\": {\"texture\": \"t0\", \"height\": -2}},"
      "\"b\": {\"type\": \"glass\", \"opacity\": {\"texture\": \"t1\", \"scale\": 0.5}},"
      "\"c\": {\"type\": \"mirror\"}",
      ""));
  EXPECT_EQ(scene.materials[0].opacity.value, 0.25f);
  EXPECT_EQ(scene.materials[0].opacity.texture, -1);
  EXPECT_EQ(scene.materials[0].bump.texture, 0);
  EXPECT_EQ(scene.materials[0].bump.height, -2);
  EXPECT_EQ(scene.materials[1].opacity.value, 0.5f);
  EXPECT_EQ(scene.materials[1].opacity.texture, 1);
  EXPECT_TRUE(is_opaque(scene.materials[2], scene.materials));
  EXPECT_EQ(scene.materials[2].bump.texture, -1);
  // Heights are numbers, and gray.png has no alpha.
  EXPECT_EQ(scene.textures[0].image->color_space(), ColorSpace::kLinear);
  EXPECT_EQ(scene.textures[1].image->width(), 1);
  EXPECT_EQ(scene.textures[1].image->texel(0, 0), Rgb::gray(1));
}

// "t0" is a colour and "t1" numbers; "t2" is both, "t3" neither, and "t4" says itself what it is.
TEST(SceneReading, TakesTexturesUsedForNumbersAloneAsLinear) {
  const SceneDescription scene = load_valid(
      scene_with("\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"},"
                 "\"t2\": {\"file\": \"gray.png\"}, \"t3\": {\"file\": \"gray.png\"},"
                 "\"t4\": {\"file\": \"gray.png\", \"color_space\": \"srgb\"}}",
                 "\"a\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"t0\"}, "
                 "\"normal_map\": {\"texture\": \"t1\"}},"
                 "\"b\": {\"type\": \"cook_torrance\", \"f0\": {\"texture\": \"t2\"}, "
                 "\"roughness\": {\"texture\": \"t2\"}},"
                 "\"c\": {\"type\": \"phong\", \"exponent\": {\"texture\": \"t4\", \"scale\": 99}}",
                 ""));
  const auto& t = scene.textures;
  for (const std::size_t i : {0u, 2u, 3u, 4u}) EXPECT_EQ(t[i].image->color_space(), ColorSpace::kSrgb) << i;
  EXPECT_EQ(t[1].image->color_space(), ColorSpace::kLinear);
}

TEST(SceneReading, TakesEnvironmentsInFloatFormats) {
  Image sky = test::one_color(4, 2, Rgb::gray(0.5f));
  sky.at(3, 1) = {1000, 0.25f, 0};
  for (const auto& [name, format] :
       {std::pair("sky.exr", ImageFormat::kExr), std::pair("sky.pfm", ImageFormat::kPfm)}) {
    const std::string keys = "\"textures\": {\"sky\": {\"file\": \"" + std::string(name) +
                             "\"}}, \"environment\": {\"texture\": \"sky\"}";
    const SceneDescription scene = load_valid(scene_with(keys, "", ""), {{name, *encode_image(sky, format)}});
    ASSERT_TRUE(scene.environment) << name;
    ASSERT_EQ(scene.environment->radiance.texture, 0) << name;
    EXPECT_EQ(scene.textures[0].image->texel(3, 1), (Rgb{1000, 0.25f, 0})) << name;
    EXPECT_EQ(scene.textures[0].image->texel(0, 0), Rgb::gray(0.5f)) << name;
    EXPECT_TRUE(scene.warnings.empty()) << name;
  }
}

TEST(SceneReading, TakesTexturesAndDecodesEachImageOnce) {
  MemoryAssets assets(
      {{"gray.png", test::png(test::one_color(4, 2, Rgb::gray(0.5f)))},
       {"scene.json",
        scene_with(
            "\"textures\": {\"a\": {\"file\": \"gray.png\"},"
            "\"b\": {\"file\": \"gray.png\", \"wrap\": \"clamp\", \"scale\": [2, 3], \"offset\": [0.5, 0],"
            "\"wrap_v\": \"mirror\", \"shear\": [0.25, 4], \"uv_set\": \"second\", "
            "\"filter\": \"nearest\"},"
            "\"c\": {\"file\": \"gray.png\", \"color_space\": \"linear\"}}",
            "", "")}});
  const auto scene = load_scene(assets, "scene.json", "scene.json");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  const auto& t = scene->textures;
  ASSERT_EQ(t.size(), 3u);
  EXPECT_EQ(t[0].image, t[1].image);
  EXPECT_NE(t[0].image, t[2].image);
  EXPECT_EQ(t[0].image->width(), 4);
  EXPECT_EQ(t[1].wrap, Wrap::kClamp);
  EXPECT_EQ(t[1].scale, (Vec2{2, 3}));
  EXPECT_EQ(t[1].offset, (Vec2{0.5f, 0}));
  EXPECT_EQ(t[1].wrap_v, Wrap::kMirror);
  EXPECT_EQ(t[1].shear, (Vec2{0.25f, 4}));
  EXPECT_EQ(t[0].uv_set, UvSet::kFirst);
  EXPECT_EQ(t[1].uv_set, UvSet::kSecond);
  EXPECT_EQ(t[1].filter, TextureFilter::kNearest);
  EXPECT_NEAR(t[0].evaluate({0.3f, 0.3f}).r, 0.5f, 5e-3f);
  EXPECT_EQ(t[2].evaluate({0.3f, 0.3f}).r, 188.0f / 255);
  EXPECT_EQ(assets.reads().at("gray.png"), 2);
}

}  // namespace
}  // namespace tessera::core
