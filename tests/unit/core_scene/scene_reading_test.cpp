// SPDX-License-Identifier: Apache-2.0
// What good scene files turn into.
#include <gtest/gtest.h>

#include <utility>

#include "core/image/encode.hpp"
#include "tests/support/near.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::MemoryAssets;
using test::scene_with;

SceneDescription load(const std::string& scene, const MemoryAssets::Files& files = {}) {
  auto loaded = test::load(scene, files);
  EXPECT_TRUE(loaded.has_value()) << loaded.error().message;
  return loaded ? std::move(*loaded) : SceneDescription{};
}

TEST(SceneReading, HasSensibleDefaults) {
  const SceneDescription scene = load(scene_with("", "\"m\": {\"type\": \"lambert\"}", ""));
  EXPECT_EQ(scene.settings, RenderSettings{});
  EXPECT_EQ(scene.camera.position, (Vec3{0, 0, 5}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 1, 0}));
  EXPECT_EQ(scene.camera.vertical_fov_degrees, 40);
  EXPECT_EQ(scene.camera.aperture_radius, 0);
  EXPECT_EQ(scene.camera.focus_distance, 0);
  EXPECT_EQ(scene.camera.aperture_blades, 0);
  EXPECT_EQ(scene.camera.aperture_rotation_degrees, 0);
  EXPECT_EQ(scene.display, DisplaySettings{});
  ASSERT_EQ(scene.materials.size(), 2u);
  EXPECT_EQ(std::get<Lambert>(scene.materials[0].model).albedo.value, Rgb::gray(0.5f));
  EXPECT_TRUE(is_black(scene.materials[0].emission.value));
  EXPECT_TRUE(scene.materials[1].two_sided_emission);
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).center, (Vec3{0, 0, 0}));
}

TEST(SceneReading, ShapesHaveTheirNamesOrTheirPlaces) {
  const SceneDescription scene = load(
      R"({"camera": {"position": [0, 0, 5], "look_at": [0, 0, 0]}, "materials": {"m": {"type": "lambert"}},
"objects": {"o": {"shapes": [{"type": "sphere", "name": "part", "radius": 1, "material": "m"}]}},
"shapes": [{"type": "mesh", "file": "t.obj", "material": "m"}, {"type": "mesh", "file": "t.obj", "name": "sheet"},
{"type": "sphere", "name": "ball", "radius": 1, "material": "m", "transform": [{"translate": {"keyframes": [{"frame": 0, "value": [0, 0, 0]}, {"frame": 9, "value": [1, 0, 0]}]}}]},
{"type": "instance", "object": "o", "name": "one"}]})",
      {{"t.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\n"}});
  EXPECT_EQ(scene.shape_names, (std::vector<std::string>{"shapes[0] (t.obj)", "sheet", "ball", "one"}));
  ASSERT_FALSE(scene.objects.empty());
  EXPECT_EQ(scene.objects[0].shape_names, std::vector<std::string>{"part"});
}

TEST(SceneReading, FiltersHaveRadiiThatSuitThem) {
  const auto filter_of = [](const std::string& render) {
    return load(scene_with("\"render\": {" + render + "}", "", "")).settings.filter;
  };
  EXPECT_EQ(filter_of(""), (PixelFilter{FilterKind::kBox, 0.5f}));
  EXPECT_EQ(filter_of("\"filter\": \"tent\""), (PixelFilter{FilterKind::kTent, 1}));
  EXPECT_EQ(filter_of("\"filter\": \"gaussian\""), (PixelFilter{FilterKind::kGaussian, 1.5f}));
  EXPECT_EQ(filter_of("\"filter_radius\": 1"), (PixelFilter{FilterKind::kBox, 1}));
}

TEST(SceneReading, TakesEverySetting) {
  const SceneDescription scene = load(
      "// A comment\n{\"$schema\": \"../scene.schema.json\", /* another */\n"
      "\"render\": {\"width\": 640, \"height\": 480, \"spp\": 16777216, \"seed\": 18446744073709551615,"
      "\"integrator\": \"nee\", \"heuristic\": \"power\", \"max_depth\": 7, \"filter\": \"gaussian\","
      "\"filter_radius\": 2.25, \"crop\": [0, 8, 640, 479], \"clamp_indirect\": 12.5},"
      "\"camera\": {\"position\": [1, 2, 3], \"look_at\": [4.5, 5, -6e1], \"up\": [0, 0, 1],"
      "\"vertical_fov_degrees\": 33.5, \"aperture_radius\": 0.25, \"focus_distance\": 9,"
      "\"aperture_blades\": 7, \"aperture_rotation_degrees\": -12.5},"
      "\"output\": {\"exposure\": -1.5, \"tone_curve\": \"agx\"},"
      "\"materials\": {\"l\": {\"type\": \"mirror\", \"emission\": [1, 2, 3], \"emission_sides\": "
      "\"front\"}},"
      "\"shapes\": [{\"type\": \"sphere\", \"center\": [1, 2, 3], \"radius\": 0.5, \"material\": \"l\"}]}");
  EXPECT_EQ(scene.settings, (RenderSettings{.width_px = 640,
                                            .height_px = 480,
                                            .spp = 1u << 24,
                                            .seed = ~std::uint64_t{0},
                                            .integrator = Integrator::kNee,
                                            .heuristic = Heuristic::kPower,
                                            .max_depth = 7,
                                            .clamp_indirect = 12.5f,
                                            .filter = {FilterKind::kGaussian, 2.25f},
                                            .crop = PixelRect{0, 8, 640, 479}}));
  EXPECT_EQ(scene.camera.look_at, (Vec3{4.5f, 5, -60}));
  EXPECT_EQ(scene.camera.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(scene.camera.vertical_fov_degrees, 33.5f);
  EXPECT_EQ(scene.camera.aperture_radius, 0.25f);
  EXPECT_EQ(scene.camera.focus_distance, 9);
  EXPECT_EQ(scene.camera.aperture_blades, 7);
  EXPECT_EQ(scene.camera.aperture_rotation_degrees, -12.5f);
  EXPECT_EQ(scene.display, (DisplaySettings{-1.5f, ToneCurve::kAgx}));
  EXPECT_EQ(scene.materials[0].name, "l");
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{1, 2, 3}));
  EXPECT_FALSE(scene.materials[0].two_sided_emission);
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).radius, 0.5f);
  EXPECT_EQ(scene.shape_names, (std::vector<std::string>{"shapes[0]"}));
}

TEST(SceneReading, TakesTheWordsOfEveryIntegrator) {
  for (const auto& [name, integrator] : {std::pair{"naive", Integrator::kNaive},
                                         {"nee", Integrator::kNee},
                                         {"mis", Integrator::kMis},
                                         {"whitted", Integrator::kWhitted}})
    EXPECT_EQ(load(scene_with("\"render\": {\"integrator\": \"" + std::string(name) + "\"}", "", ""))
                  .settings.integrator,
              integrator);
}

TEST(SceneReading, TakesLightsAndSurroundings) {
  const SceneDescription scene = load(scene_with(
      "\"textures\": {\"sky\": {\"file\": \"gray.png\"}},"
      "\"lights\": [{\"type\": \"point\", \"position\": [1, 2, 3], \"intensity\": 5},"
      "{\"type\": \"spot\", \"position\": [0, 4, 0], \"look_at\": [0, 0, 1], \"intensity\": [1, 2, 3],"
      "\"angle_degrees\": 60, \"softness\": 0.5},"
      "{\"type\": \"directional\", \"direction\": [0, -2, 0], \"irradiance\": 1e3}],"
      "\"environment\": {\"radiance\": [3, 2, 1], \"texture\": \"sky\", \"rotation_degrees\": -90}",
      "", ""));
  ASSERT_EQ(scene.lights.size(), 3u);
  const auto& point = std::get<PointLightDescription>(scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(point.intensity, Rgb::gray(5));
  const auto& spot = std::get<SpotLightDescription>(scene.lights[1]);
  EXPECT_EQ(spot.position, (Vec3{0, 4, 0}));
  EXPECT_EQ(spot.look_at, (Vec3{0, 0, 1}));
  EXPECT_EQ(spot.intensity, (Rgb{1, 2, 3}));
  EXPECT_EQ(spot.angle_degrees, 60);
  EXPECT_EQ(spot.softness, 0.5f);
  const auto& directional = std::get<DirectionalLightDescription>(scene.lights[2]);
  EXPECT_EQ(directional.direction, (Vec3{0, -2, 0}));
  EXPECT_EQ(directional.irradiance, Rgb::gray(1e3f));
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance.value, (Rgb{3, 2, 1}));
  EXPECT_EQ(scene.environment->radiance.texture, 0);
  EXPECT_EQ(scene.environment->rotation_degrees, -90);
}

TEST(SceneReading, TakesTexturedEmissionAsBrightAsOneLikes) {
  const SceneDescription scene = load(scene_with(
      "\"textures\": {\"t\": {\"file\": \"gray.png\"}}",
      "\"screen\": {\"type\": \"lambert\", \"emission\": {\"texture\": \"t\", \"tint\": [9, 8, 7]}}", ""));
  EXPECT_EQ(scene.materials[0].emission.texture, 0);
  EXPECT_EQ(scene.materials[0].emission.value, (Rgb{9, 8, 7}));
}

TEST(SceneReading, TakesMaterials) {
  const SceneDescription scene =
      load(scene_with("\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"}}",
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
  const SceneDescription scene = load(scene_with(
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
  const SceneDescription scene = load(scene_with(
      "\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"}}",
      "\"a\": {\"type\": \"principled\", \"base_color\": {\"texture\": \"t0\"}, \"specular_ior\": 1.4, "
      "\"coat_weight\": {\"texture\": \"t1\", \"scale\": 0.5}, \"thin_film_thickness\": 2, "
      "\"geometry_thin_walled\": true, \"sides\": \"front\"},"
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
  const SceneDescription scene = load(scene_with(
      "",
      "\"wax\": {\"type\": \"principled\", \"subsurface_weight\": 0.5}, \"clay\": {\"type\": \"principled\"}",
      ""));
  EXPECT_EQ(
      scene.warnings,
      std::vector<std::string>{"materials.wax: subsurface scattering is approximated by diffuse reflection"});
}

TEST(SceneReading, TakesOpacityAndBumps) {
  const SceneDescription scene = load(scene_with(
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
  const SceneDescription scene =
      load(scene_with("\"textures\": {\"t0\": {\"file\": \"gray.png\"}, \"t1\": {\"file\": \"gray.png\"},"
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
    const SceneDescription scene = load(scene_with(keys, "", ""), {{name, *encode_image(sky, format)}});
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

TEST(SceneReading, AppliesTransformsInTheOrderWritten) {
  const SceneDescription scene = load(scene_with(
      "", "",
      "{\"type\": \"sphere\", \"center\": [1, 0, 0], \"radius\": 1, \"material\": \"light\", \"transform\":"
      "[{\"scale\": 2}, {\"rotate\": {\"axis\": [0, 0, 5], \"degrees\": 90}}, {\"translate\": [10, 20, "
      "30]}]}"));
  const auto& sphere = std::get<SphereDescription>(scene.shapes[0]);
  expect_near(sphere.center, {10, 22, 30}, 1e-5f);
  EXPECT_NEAR(sphere.radius, 2, 1e-5f);
}

TEST(SceneReading, KeepsObjectsOnceAndPlacesTheirInstances) {
  const SceneDescription scene = load(scene_with(
      "\"objects\": {\"ball\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 2, \"material\": "
      "\"light\"}]}, \"tile\": {\"shapes\": [{\"type\": \"mesh\", \"file\": \"triangle.obj\", "
      "\"material\": \"light\", \"transform\": [{\"scale\": 3}]}]}}",
      "\"red\": {\"type\": \"lambert\"}",
      "{\"type\": \"instance\", \"object\": \"tile\", \"material\": \"red\", \"transform\": [{\"scale\": 2}, "
      "{\"matrix\": [[0, -1, 0, 10], [1, 0, 0, 20], [0, 0, 1, 30]]}]},"
      "{\"type\": \"instance\", \"object\": \"ball\"}"));
  ASSERT_EQ(scene.objects.size(), 2u);
  EXPECT_EQ(scene.objects[0].name, "ball");
  EXPECT_EQ(std::get<SphereDescription>(scene.objects[0].shapes[0]).radius, 2);
  EXPECT_EQ(std::get<MeshDescription>(scene.objects[1].shapes[0]).positions[1], (Vec3{3, 0, 0}));
  EXPECT_EQ(scene.objects[1].shape_names[0], "shapes[0] (triangle.obj)");
  const auto& tile = std::get<InstanceDescription>(scene.shapes[0]);
  EXPECT_EQ(tile.object, 1u);
  EXPECT_EQ(tile.material, 0u);
  EXPECT_EQ(tile.to_world.point({1, 0, 0}), (Vec3{10, 22, 30}));
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[1]).material, std::nullopt);
}

// An object may be written before those that it holds.
TEST(SceneReading, ReplacesInstancesInObjects) {
  const SceneDescription scene = load(scene_with(
      "\"objects\": {\"tree\": {\"shapes\": [{\"type\": \"instance\", \"object\": \"leaf\", \"transform\": "
      "[{\"translate\": [1, 0, 0]}]}, {\"type\": \"instance\", \"object\": \"leaf\"}]},"
      "\"leaf\": {\"shapes\": [{\"type\": \"sphere\", \"radius\": 2, \"material\": \"light\"}]}}",
      "", "{\"type\": \"instance\", \"object\": \"tree\", \"transform\": [{\"scale\": 3}]}"));
  ASSERT_EQ(scene.objects.size(), 1u);
  EXPECT_EQ(scene.objects[0].name, "leaf");
  ASSERT_EQ(scene.shapes.size(), 3u) << "with the lamp of every test";
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[0]).to_world.point({}), (Vec3{3, 0, 0}));
  EXPECT_EQ(std::get<InstanceDescription>(scene.shapes[1]).to_world.point({}), (Vec3{}));
}

TEST(SceneReading, MirrorsSpheresAndQuads) {
  const SceneDescription scene =
      load(scene_with("", "",
                      "{\"type\": \"sphere\", \"center\": [1, 2, 3], \"radius\": 1, \"material\": \"light\", "
                      "\"transform\": [{\"scale\": [-1, 1, 1]}]},"
                      "{\"type\": \"quad\", \"corner\": [0, 0, 1], \"edge_u\": [2, 0, 0], \"edge_v\": [0, 1, "
                      "0], \"material\": \"light\"},"
                      "{\"type\": \"quad\", \"corner\": [0, 0, 1], \"edge_u\": [2, 0, 0], \"edge_v\": [0, 1, "
                      "0], \"material\": \"light\","
                      " \"transform\": [{\"scale\": [-1, 1, 1]}]}"));
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes[0]).center, (Vec3{-1, 2, 3}));
  EXPECT_EQ(std::get<QuadDescription>(scene.shapes[1]).edge_u, (Vec3{2, 0, 0}));
  // Mirrored in x, the normal still points to z, and each corner keeps its texture coordinate.
  const auto& mesh = std::get<MeshDescription>(scene.shapes[2]);
  for (const auto& [a, b, c] : mesh.triangles)
    EXPECT_GT(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]).z, 0);
  for (std::size_t i = 0; i < 4; ++i) {
    EXPECT_EQ(mesh.positions[i].x, -2 * mesh.uvs[i].x);
    EXPECT_EQ(mesh.positions[i].y, mesh.uvs[i].y);
  }
}

TEST(SceneReading, PlacesDisksAndCylinders) {
  const SceneDescription scene = load(scene_with(
      "", "",
      "{\"type\": \"disk\", \"center\": [1, 0, 0], \"radius\": 2, \"inner_radius\": 0.5, \"material\": "
      "\"light\", \"transform\": [{\"scale\": [-3, 1, 1]}]},"
      "{\"type\": \"cylinder\", \"start\": [0, 0, 1], \"end\": [0, 0, 3], \"radius\": 0.5, \"material\": "
      "\"light\", \"flip_normal\": true, \"transform\": [{\"translate\": [5, 0, 0]}]},"
      "{\"type\": \"disk\", \"normal\": [0, 9, 0], \"radius\": 1, \"material\": \"light\"}"));
  const auto& disk = std::get<DiskDescription>(scene.shapes[0]);
  EXPECT_EQ(disk.center, (Vec3{-3, 0, 0}));
  EXPECT_EQ(disk.radius_u, (Vec3{-6, 0, 0}));
  EXPECT_EQ(disk.radius_v, (Vec3{0, 2, 0}));
  EXPECT_EQ(disk.inner, 0.25f);
  EXPECT_TRUE(disk.flipped) << "the front stays at +z";
  const auto& cylinder = std::get<CylinderDescription>(scene.shapes[1]);
  EXPECT_EQ(cylinder.start, (Vec3{5, 0, 1}));
  EXPECT_EQ(cylinder.axis, (Vec3{0, 0, 2}));
  EXPECT_EQ(cylinder.radius_u, (Vec3{0.5f, 0, 0}));
  EXPECT_EQ(cylinder.radius_v, (Vec3{0, 0.5f, 0}));
  EXPECT_TRUE(cylinder.flipped);
  const auto& facing_up = std::get<DiskDescription>(scene.shapes[2]);
  expect_near(cross(facing_up.radius_u, facing_up.radius_v), {0, 1, 0}, 1e-6f);
}

TEST(SceneReading, TakesTheTypesOfCameras) {
  const auto camera = [](const std::string& keys) {
    return load("{\"camera\": {\"position\": [0, 0, 5], \"look_at\": [0, 0, 0], " + keys +
                "}, \"materials\": {\"l\": {\"type\": \"lambert\", \"emission\": 1}}, "
                "\"shapes\": [{\"type\": \"sphere\", \"radius\": 1, \"material\": \"l\"}]}")
        .camera;
  };
  EXPECT_EQ(camera("\"type\": \"panoramic\"").type, CameraType::kPanoramic);
  EXPECT_TRUE(camera("\"mirror\": true").mirrored);
  EXPECT_EQ(camera("\"lens_shift\": [0.5, -1]").lens_shift, (Vec2{0.5f, -1}));
  const CameraDescription flat = camera("\"type\": \"orthographic\", \"view_height\": 7");
  EXPECT_EQ(flat.type, CameraType::kOrthographic);
  EXPECT_EQ(flat.view_height, 7);
}

TEST(SceneReading, TurnsAndHidesTheEnvironment) {
  const SceneDescription scene =
      load(scene_with("\"environment\": {\"visible_to_camera\": false, \"orientation\": [{\"matrix\": "
                      "[[0, 0, 1, 0], [1, 0, 0, 0], [0, 1, 0, 0]]}]}",
                      "", ""));
  EXPECT_FALSE(scene.environment->visible_to_camera);
  EXPECT_EQ(scene.environment->orientation.x_axis, (Vec3{0, 1, 0}));
  EXPECT_EQ(test::mistakes_in(scene_with("\"environment\": {\"orientation\": [{\"scale\": 2}]}", "", "")),
            "scene.json:2: environment.orientation: the steps together must be a rotation or a reflection, "
            "which keep all lengths");
}

TEST(SceneReading, ReadsAMeshOnceForAllItsShapes) {
  const std::string shape = "{\"type\": \"mesh\", \"file\": \"triangle.obj\", \"material\": \"light\"";
  MemoryAssets assets(
      {{"triangle.obj", test::kTriangleObj},
       {"scene.json",
        scene_with("", "", shape + "}, " + shape + ", \"transform\": [{\"translate\": [0, 0, 7]}]}")}});
  const auto scene = load_scene(assets, "scene.json", "scene.json");
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(assets.reads().at("triangle.obj"), 1);
  EXPECT_EQ(scene->shape_names[1], "shapes[1] (triangle.obj)");
  const auto& mesh = std::get<MeshDescription>(scene->shapes[1]);
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 7}, {1, 0, 7}, {0, 1, 7}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2>{{0, 0}, {1, 0}, {0, 1}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}}));
}

}  // namespace
}  // namespace tessera::core
