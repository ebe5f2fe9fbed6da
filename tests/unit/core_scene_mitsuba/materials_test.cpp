// SPDX-License-Identifier: Apache-2.0
// The BSDFs, textures and media of Mitsuba scenes.
#include <gmock/gmock.h>

#include <cmath>

#include "core/materials/fresnel.hpp"
#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

template <typename Model>
Model model_of(const std::string& bsdf, const MemoryAssets::Files& files = {}) {
  const Material material = material_of(bsdf, files);
  const auto* model = std::get_if<Model>(&material.model);
  EXPECT_NE(model, nullptr) << bsdf;
  return model == nullptr ? Model{} : *model;
}

TEST(MitsubaBsdf, DiffuseIsOneSided) {
  const Material material =
      material_of("<bsdf type=\"diffuse\"><rgb name=\"reflectance\" value=\"0.1 0.2 0.3\"/></bsdf>");
  EXPECT_EQ(std::get<Lambert>(material.model).albedo.value, (Rgb{0.1f, 0.2f, 0.3f}));
  EXPECT_FALSE(material.two_sided);
  EXPECT_TRUE(material_of("<bsdf type=\"twosided\"><bsdf type=\"diffuse\"/></bsdf>").two_sided);
}

TEST(MitsubaBsdf, ShapesWithoutOneAreGrayAndLampsBlack) {
  EXPECT_EQ(std::get<Lambert>(material_of("").model).albedo.value, Rgb::gray(0.5f));
  const Material lamp = material_of("<emitter type=\"area\"><rgb name=\"radiance\" value=\"3\"/></emitter>");
  EXPECT_EQ(std::get<Lambert>(lamp.model).albedo.value, Rgb::gray(0));
  EXPECT_EQ(lamp.emission.value, Rgb::gray(3));
  EXPECT_FALSE(lamp.two_sided_emission);
}

TEST(MitsubaBsdf, ShadingNormalsArePlain) {
  EXPECT_EQ(material_of("").shading_normals, ShadingNormals::kPlain);
  EXPECT_EQ(material_of("<bsdf type=\"twosided\"><bsdf type=\"plastic\"/></bsdf>").shading_normals,
            ShadingNormals::kPlain);
}

TEST(MitsubaBsdf, DielectricsHaveTheRatioOfTheirIndices) {
  EXPECT_NEAR(model_of<Glass>("<bsdf type=\"dielectric\"/>").ior.value, 1.5046f / 1.000277f, 1e-6);
  const std::string water =
      "<bsdf type=\"dielectric\"><string name=\"int_ior\" value=\"water\"/><float name=\"ext_ior\" "
      "value=\"1\"/></bsdf>";
  EXPECT_NEAR(model_of<Glass>(water).ior.value, 1.333f, 1e-6);
  EXPECT_NEAR(model_of<ThinDielectric>("<bsdf type=\"thindielectric\"><float name=\"int_ior\" value=\"2\"/>"
                                       "<float name=\"ext_ior\" value=\"1\"/></bsdf>")
                  .ior.value,
              2, 1e-6);
}

TEST(MitsubaBsdf, ADenserOutsideTurnsTheShapeInsideOut) {
  const auto scene =
      load_xml(xml_scene("<shape type=\"rectangle\"><bsdf type=\"dielectric\">"
                         "<float name=\"int_ior\" value=\"1\"/><float name=\"ext_ior\" value=\"1.5\"/>"
                         "</bsdf></shape>",
                         false));
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_NEAR(std::get<Glass>(scene->materials.at(0).model).ior.value, 1.5, 1e-6);
  EXPECT_LT(std::get<MeshDescription>(scene->shapes.at(0)).normals.at(0).z, 0);
}

TEST(MitsubaBsdf, AlphaIsTheSquareOfRoughness) {
  const auto rough = [](const std::string& type, const std::string& parameters) {
    return "<bsdf type=\"" + type + "\"><string name=\"distribution\" value=\"ggx\"/>" + parameters +
           "</bsdf>";
  };
  const std::string alpha = "<float name=\"alpha\" value=\"0.25\"/>";
  EXPECT_FLOAT_EQ(model_of<Glass>(rough("roughdielectric", alpha)).roughness.value, 0.5f);
  EXPECT_FLOAT_EQ(model_of<Plastic>(rough("roughplastic", alpha)).roughness.value, 0.5f);
  EXPECT_FLOAT_EQ(model_of<ConductorMaterial>(rough("roughconductor", alpha)).roughness.value, 0.5f);
  const auto metal = model_of<ConductorMaterial>(rough(
      "roughconductor", "<float name=\"alpha_u\" value=\"0.2\"/><float name=\"alpha_v\" value=\"0.1\"/>"));
  EXPECT_FLOAT_EQ(metal.anisotropy.value, 0.5f);
  EXPECT_NEAR(metal.roughness.value, std::sqrt(std::sqrt(0.025)), 1e-6);
  EXPECT_TRUE(is_along_u(metal.tangent));
  const auto across = model_of<ConductorMaterial>(rough(
      "roughconductor", "<float name=\"alpha_u\" value=\"0.1\"/><float name=\"alpha_v\" value=\"0.2\"/>"));
  EXPECT_FLOAT_EQ(across.anisotropy.value, 0.5f);
  EXPECT_EQ(across.tangent.rotation.value, 0.25f);
}

TEST(MitsubaBsdf, MicrofacetsAreBeckmannsUnlessNamed) {
  using enum MicrofacetDistribution;
  const auto kind = [](const std::string& distribution) {
    return model_of<ConductorMaterial>("<bsdf type=\"roughconductor\">" + distribution + "</bsdf>")
        .microfacets;
  };
  EXPECT_EQ(kind("").distribution, kBeckmann);
  EXPECT_EQ(kind("").masking, SmithMasking::kSeparable);
  EXPECT_EQ(kind("<string name=\"distribution\" value=\"ggx\"/>").distribution, kGgx);
  EXPECT_EQ(model_of<Glass>("<bsdf type=\"roughdielectric\"/>").microfacets.distribution, kBeckmann);
  const auto plastic = model_of<Plastic>("<bsdf type=\"roughplastic\"/>");
  EXPECT_EQ(plastic.microfacets.distribution, kBeckmann);
  EXPECT_FALSE(plastic.compensated);
  EXPECT_EQ(plastic.diffuse.value, Rgb::gray(0.5f));
}

TEST(MitsubaBsdf, ConductorsHaveAnIndexOrReflectEverything) {
  const auto mirror = model_of<ConductorMaterial>("<bsdf type=\"conductor\"/>");
  EXPECT_EQ(mirror.eta.value, Rgb::gray(0));
  EXPECT_EQ(mirror.k.value, Rgb::gray(1));
  const auto metal = model_of<ConductorMaterial>(
      "<bsdf type=\"conductor\"><spectrum name=\"eta\" value=\"0.8\"/><rgb name=\"k\" value=\"6 5 "
      "4\"/></bsdf>");
  EXPECT_EQ(metal.eta.value, Rgb::gray(0.8f));
  EXPECT_EQ(metal.k.value, (Rgb{6, 5, 4}));
  const auto gold =
      model_of<ConductorMaterial>("<bsdf type=\"conductor\"><string name=\"material\" value=\"Au\"/></bsdf>");
  EXPECT_LT(gold.eta.value.r, gold.eta.value.b);
}

TEST(MitsubaScene, AMaximumDepthOf1ShowsEmissionOnly) {
  const SceneDescription scene = scene_of(
      "<integrator type=\"path\"><integer name=\"max_depth\" value=\"1\"/></integrator>"
      "<shape type=\"rectangle\"><bsdf type=\"conductor\"/><emitter type=\"area\"/></shape>");
  EXPECT_EQ(warnings_of(scene), "");
  ASSERT_EQ(scene.materials.size(), 2u);  // with the sphere's
  for (const Material& material : scene.materials)
    EXPECT_EQ(std::get<Lambert>(material.model).albedo.value, Rgb{});
  EXPECT_NE(scene.materials[0].emission.value, scene.materials[1].emission.value);
}

TEST(MitsubaScene, FiltersWithNegativeLobesAreTold) {
  const SceneDescription scene = scene_of(
      "<sensor type=\"perspective\"><film type=\"hdrfilm\"><rfilter type=\"mitchell\"/></film></sensor>");
  EXPECT_THAT(warnings_of(scene), HasSubstr("negative lobes"));
}

TEST(MitsubaBsdf, TheSidesOfTwosidedMayDiffer) {
  const SceneDescription scene = scene_of(
      "<shape type=\"rectangle\"><bsdf type=\"twosided\"><bsdf type=\"diffuse\"/>"
      "<bsdf type=\"conductor\"/></bsdf></shape>");
  EXPECT_EQ(warnings_of(scene), "");
  const Material& both = scene.materials.at(2);
  const auto& blend = std::get<Blend>(both.model);
  EXPECT_TRUE(blend.by_side);
  EXPECT_TRUE(std::holds_alternative<Lambert>(scene.materials.at(blend.first).model));
  const Material& back = scene.materials.at(blend.second);
  EXPECT_TRUE(std::holds_alternative<ConductorMaterial>(back.model));
  EXPECT_TRUE(back.two_sided);
}

TEST(MitsubaBsdf, CrystalsHaveTheirIndices) {
  const auto reflectance = [](const std::string& name) {
    const auto metal = model_of<ConductorMaterial>(
        "<bsdf type=\"conductor\"><string name=\"material\" value=\"" + name + "\"/></bsdf>");
    return fresnel_conductor(1.0f, metal.eta.value, metal.k.value).g;
  };
  EXPECT_NEAR(reflectance("MgO"), 0.073f, 0.001f);
  EXPECT_NEAR(reflectance("d-C"), 0.173f, 0.001f);
  EXPECT_NEAR(reflectance("TiO2"), 0.205f, 0.001f);
  EXPECT_NEAR(reflectance("TiO2-e"), 0.245f, 0.001f);
  EXPECT_NEAR(reflectance("SiC"), 0.206f, 0.001f);
  EXPECT_NEAR(reflectance("CsI"), 0.081f, 0.001f);
  EXPECT_NEAR(reflectance("Be"), 0.535f, 0.001f);
  for (const char* const name : {"Be", "Cr", "Cu", "d-C", "Hg", "MgO", "Ni", "SiC", "TiN", "TiO2", "V"})
    EXPECT_EQ(reflectance(std::string(name) + "_palik"), reflectance(name)) << name;
}

TEST(MitsubaBsdf, MetalsWithoutIndicesAreReplacedByNearOnes) {
  const SceneDescription scene = scene_of(
      "<shape type=\"sphere\"><bsdf type=\"conductor\"><string name=\"material\" "
      "value=\"Rh\"/></bsdf></shape>");
  const auto& metal = std::get<ConductorMaterial>(scene.materials.at(0).model);
  EXPECT_EQ(metal.eta.value, complex_index(Conductor::kMercury).eta);
  EXPECT_THAT(warnings_of(scene), HasSubstr("the indices of 'Rh' are not known; those of mercury"));
}

TEST(MitsubaBsdf, ColorsOfMetalsThatDifferFromMitsubasAreTold) {
  const SceneDescription scene = scene_of(
      "<shape type='sphere'><bsdf type='conductor'><string name='material' value='Ag'/></bsdf></shape>");
  EXPECT_THAT(warnings_of(scene), HasSubstr("the colour of 'Ag' is that under D65"));
}

TEST(MitsubaBsdf, PlasticKeepsItsParameters) {
  const auto plastic = model_of<Plastic>(
      "<bsdf type=\"plastic\"><boolean name=\"nonlinear\" value=\"true\"/><float name=\"int_ior\" "
      "value=\"1.9\"/>"
      "<float name=\"ext_ior\" value=\"1\"/><rgb name=\"diffuse_reflectance\" value=\"0.2\"/></bsdf>");
  EXPECT_TRUE(plastic.nonlinear);
  EXPECT_FLOAT_EQ(plastic.ior.value, 1.9f);
  EXPECT_EQ(plastic.diffuse.value, Rgb::gray(0.2f));
}

TEST(MitsubaBsdf, BlendsMasksAndNull) {
  const auto scene = load_xml(
      xml_scene("<shape type=\"sphere\"><bsdf type=\"mask\"><float name=\"opacity\" value=\"0.25\"/>"
                "<bsdf type=\"blendbsdf\"><float name=\"weight\" value=\"0.75\"/><bsdf type=\"diffuse\"/>"
                "<bsdf type=\"null\"/></bsdf></bsdf></shape>",
                false));
  ASSERT_TRUE(scene) << scene.error().message;
  const Material& material = scene->materials.at(std::get<SphereDescription>(scene->shapes.at(0)).material);
  EXPECT_EQ(material.opacity.value, 0.25f);
  const auto& blend = std::get<Blend>(material.model);
  EXPECT_EQ(blend.weight.value, 0.75f);
  EXPECT_TRUE(std::holds_alternative<Lambert>(scene->materials.at(blend.first).model));
  EXPECT_TRUE(std::holds_alternative<Null>(scene->materials.at(blend.second).model));
}

TEST(MitsubaBsdf, PrincipledIsDisneys) {
  const SceneDescription scene = scene_of(
      "<shape type=\"sphere\"><bsdf type=\"principled\">"
      "<float name=\"metallic\" value=\"0.7\"/><float name=\"roughness\" value=\"0.2\"/>"
      "<float name=\"clearcoat\" value=\"0.8\"/></bsdf></shape>");
  const auto& model = std::get<Disney>(scene.materials.at(0).model);
  EXPECT_EQ(model.metallic.value, 0.7f);
  EXPECT_EQ(model.roughness.value, 0.2f);
  EXPECT_EQ(model.clearcoat.value, 0.8f);
  EXPECT_NEAR(model.ior.value, 1.5, 1e-6);
  EXPECT_FALSE(model.thin_walled);
  EXPECT_FALSE(scene.materials.at(0).two_sided);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(MitsubaBsdf, ThinPrincipledIsASheet) {
  const auto model = model_of<Disney>(
      "<bsdf type=\"principledthin\"><float name=\"eta\" value=\"1.7\"/>"
      "<float name=\"diff_trans\" value=\"0.6\"/><float name=\"spec_trans\" value=\"0.2\"/></bsdf>");
  EXPECT_TRUE(model.thin_walled);
  EXPECT_EQ(model.ior.value, 1.7f);
  EXPECT_FLOAT_EQ(model.diffuse_transmission.value, 0.3f);
  EXPECT_EQ(model.specular_transmission.value, 0.2f);
}

TEST(MitsubaBsdf, PrincipledLessDenseThanItsOutsideIsTold) {
  const SceneDescription scene = scene_of(
      "<shape type=\"sphere\"><bsdf type=\"principled\"><float name=\"eta\" value=\"0.8\"/></bsdf></shape>");
  EXPECT_EQ(std::get<Disney>(scene.materials.at(0).model).ior.value, 1);
  EXPECT_THAT(warnings_of(scene), HasSubstr("'eta' must be from 1 to 10, got 0.8; 1 is used"));
}

// Of a boundary that is almost smooth, 64 cosines with both ends give 0.579 and the integral 0.590.
TEST(MitsubaBsdf, RoughPlasticReflectsInsideAsMitsubasQuadrature) {
  const auto rough = model_of<Plastic>(
      "<bsdf type=\"roughplastic\"><float name=\"alpha\" value=\"0.001\"/>"
      "<float name=\"int_ior\" value=\"1.49\"/><float name=\"ext_ior\" value=\"1\"/></bsdf>");
  EXPECT_NEAR(rough.internal_reflection.value, 0.579 / 0.590, 3e-3);
  EXPECT_EQ(model_of<Plastic>("<bsdf type=\"plastic\"/>").internal_reflection.value, 1);
}

TEST(MitsubaBsdf, Hair) {
  const auto brown = model_of<Hair>("<bsdf type=\"hair\"/>");
  EXPECT_EQ(brown.pigment, HairPigment::kMelanin);
  EXPECT_EQ(brown.eumelanin.value, 1.3f);
  EXPECT_EQ(brown.pheomelanin.value, 0.2f);
  const auto dyed = model_of<Hair>(
      "<bsdf type=\"hair\"><rgb name=\"sigma_a\" value=\"0.2, 0.25, 0.7\"/><float name=\"scale\" "
      "value=\"2\"/>"
      "<float name=\"longitudinal_roughness\" value=\"0.1\"/><float name=\"scale_tilt\" "
      "value=\"3\"/></bsdf>");
  EXPECT_EQ(dyed.pigment, HairPigment::kAbsorption);
  EXPECT_FLOAT_EQ(dyed.sigma_a.value.b, 1.4f);
  EXPECT_EQ(dyed.beta_m.value, 0.1f);
  EXPECT_EQ(dyed.tilt_degrees, 3);
  const SceneDescription both = scene_of(
      "<shape type='sphere'><bsdf type='hair'><rgb name='sigma_a' value='1'/><float name='eumelanin' "
      "value='2'/></bsdf></shape>");
  EXPECT_THAT(warnings_of(both), HasSubstr("<bsdf type=\"hair\">: the parameter 'eumelanin' is ignored"));
}

TEST(MitsubaBsdf, PolarizersLetHalfOfTheLightThrough) {
  const auto pane = std::get<ThinDielectric>(
      material_of("<bsdf type='polarizer'><float name='theta' value='30'/><rgb name='transmittance' "
                  "value='0.8'/></bsdf>")
          .model);
  EXPECT_EQ(pane.ior.value, 1);
  EXPECT_EQ(pane.transmittance.value, Rgb::gray(0.4f));
}

TEST(MitsubaBsdf, UnknownOnesBecomeGray) {
  const SceneDescription scene = scene_of("<shape type=\"sphere\"><bsdf type=\"velvet\"/></shape>");
  EXPECT_TRUE(std::holds_alternative<Lambert>(scene.materials.at(0).model));
  EXPECT_THAT(warnings_of(scene), HasSubstr("<bsdf type=\"velvet\">: is not supported"));
}

// A square with a texture as its reflectance.
SceneDescription textured(const std::string& shape, const std::string& texture,
                          const MemoryAssets::Files& files) {
  return scene_of("<shape " + shape + "<bsdf type=\"diffuse\">" + texture + "</bsdf></shape>", files);
}

// Black above, white below.
std::string half_white() {
  Image image = one_color(4, 4, Rgb::gray(0));
  for (int x = 0; x < 4; ++x)
    for (int y = 2; y < 4; ++y) image.at(x, y) = Rgb::gray(1);
  return png(image);
}

Rgb looked_up(const SceneDescription& scene, Vec2 uv) {
  const auto& albedo = std::get<Lambert>(scene.materials.at(0).model).albedo;
  return albedo.evaluate(scene.textures, uv);
}

TEST(MitsubaTexture, TheFirstRowIsAtVZeroButForObjFiles) {
  const std::string bitmap =
      "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"t.png\"/></texture>";
  const SceneDescription square = textured("type=\"rectangle\">", bitmap, {{"t.png", half_white()}});
  EXPECT_EQ(looked_up(square, {0.5f, 0.25f}), Rgb::gray(0));
  EXPECT_EQ(looked_up(square, {0.5f, 0.75f}), Rgb::gray(1));
  const SceneDescription obj = textured("type=\"obj\"><string name=\"filename\" value=\"triangle.obj\"/>",
                                        bitmap, {{"t.png", half_white()}, {"triangle.obj", kTriangleObj}});
  EXPECT_EQ(looked_up(obj, {0.5f, 0.25f}), Rgb::gray(1));
}

TEST(MitsubaTexture, MayHaveTheFilterNearest) {
  const SceneDescription scene =
      textured("type=\"rectangle\">",
               "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" "
               "value=\"t.png\"/><string name=\"filter_type\" value=\"nearest\"/></texture>",
               {{"t.png", half_white()}});
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(scene.textures.at(0).filter, TextureFilter::kNearest);
}

TEST(MitsubaTexture, TransformsApplyToMitsubasCoordinates) {
  const std::string bitmap =
      "<texture type=\"bitmap\" name=\"reflectance\"><string name=\"filename\" value=\"t.png\"/>"
      "<transform name=\"to_uv\"><scale x=\"1\" y=\"2\"/><translate y=\"0.5\"/></transform></texture>";
  const SceneDescription square = textured("type=\"rectangle\">", bitmap, {{"t.png", half_white()}});
  EXPECT_EQ(looked_up(square, {0.5f, 0.125f}), Rgb::gray(1));  // v = 0.75
  EXPECT_EQ(looked_up(square, {0.5f, 0.375f}), Rgb::gray(0));  // v = 1.25
}

TEST(MitsubaTexture, CheckerboardsAlternate) {
  const SceneDescription square =
      textured("type=\"rectangle\">",
               "<texture type=\"checkerboard\" name=\"reflectance\"><rgb name=\"color0\" value=\"0.1\"/>"
               "<transform name=\"to_uv\"><scale x=\"2\" y=\"2\"/></transform></texture>",
               {});
  EXPECT_EQ(looked_up(square, {0.125f, 0.125f}), Rgb::gray(0.1f));
  EXPECT_EQ(looked_up(square, {0.375f, 0.125f}), Rgb::gray(0.2f));
  EXPECT_EQ(looked_up(square, {0.375f, 0.375f}), Rgb::gray(0.1f));
  EXPECT_EQ(looked_up(square, {0.625f, 0.125f}), Rgb::gray(0.1f));
}

TEST(MitsubaTexture, VolumesOfAConstantAreThat) {
  const auto reflectance = [](const std::string& volume) {
    const SceneDescription scene = scene_of(
        "<shape type=\"rectangle\"><bsdf type=\"diffuse\"><texture type=\"volume\" name=\"reflectance\">" +
        volume + "</texture></bsdf></shape>");
    return std::get<Lambert>(scene.materials.at(0).model).albedo.value;
  };
  EXPECT_EQ(reflectance("<rgb name=\"volume\" value=\"0.25 0.5 0.75\"/>"), (Rgb{0.25f, 0.5f, 0.75f}));
  EXPECT_EQ(reflectance("<volume type=\"constvolume\" name=\"volume\"><float name=\"value\" "
                        "value=\"0.25\"/></volume>"),
            Rgb::gray(0.25f));
}

TEST(MitsubaTexture, ColorsMayBeHexadecimalOrRaw) {
  const auto reflectance = [](const std::string& inside) {
    return std::get<Lambert>(material_of("<bsdf type=\"diffuse\">" + inside + "</bsdf>").model).albedo;
  };
  EXPECT_EQ(reflectance("<rgb name=\"reflectance\" value=\"#ff3300\"/>").value, (Rgb{1, 0.2f, 0}));
  EXPECT_EQ(reflectance("<srgb name=\"reflectance\" value=\"#ff0000\"/>").value, (Rgb{1, 0, 0}));
  EXPECT_NEAR(reflectance("<srgb name=\"reflectance\" value=\"0.5 0 1\"/>").value.r, 0.21404f, 1e-5f);
  EXPECT_EQ(reflectance("<texture name=\"reflectance\" type=\"rawconstant\">"
                        "<rgb name=\"value\" value=\"0.2 0.3 0.4\"/></texture>")
                .value,
            (Rgb{0.2f, 0.3f, 0.4f}));
}

void expect_gray(Rgb c, float value) {
  for (const float channel : {c.r, c.g, c.b}) EXPECT_NEAR(channel, value, 1e-4f);
}

TEST(MitsubaTexture, SpectraOfReflectancesAreSeenUnderD65) {
  const auto reflectance = [](const std::string& spectrum) {
    return std::get<Lambert>(
               material_of("<bsdf type='diffuse'><spectrum name='reflectance' " + spectrum + "</bsdf>").model)
        .albedo.value;
  };
  expect_gray(reflectance("value='0.5'/>"), 0.5f);
  expect_gray(reflectance("value='360:0.5, 830:0.5'/>"), 0.5f);
  expect_gray(reflectance("type='irregular'><string name='wavelengths' value='360, 830'/>"
                          "<string name='values' value='0.5, 0.5'/></spectrum>"),
              0.5f);
}

TEST(MitsubaMedium, CoefficientsMayBeWholeNumbers) {
  const SceneDescription scene = scene_of(
      "<shape type='sphere'><medium name='interior' type='homogeneous'><integer name='sigma_t' value='2'/>"
      "<float name='albedo' value='0.5'/></medium></shape>");
  EXPECT_EQ(scene.media.at(0).sigma_s, Rgb::gray(1));
  EXPECT_EQ(scene.media.at(0).sigma_a, Rgb::gray(1));
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(MitsubaMedium, SpectraOfAlbedosAreSeenUnderD65) {
  const SceneDescription scene = scene_of(
      "<shape type='sphere'><medium name='interior' type='homogeneous'>"
      "<volume name='albedo' type='constvolume'><spectrum name='value' value='360:0.5, 830:0.5'/></volume>"
      "</medium></shape>");
  expect_gray(scene.media.at(0).sigma_s, 0.5f);
}

TEST(MitsubaEmitter, DirectionalAreasEmitTheirPowerInAllDirections) {
  const Material lamp =
      material_of("<emitter type=\"directionalarea\"><rgb name=\"radiance\" value=\"6.2831853\"/></emitter>");
  EXPECT_NEAR(lamp.emission.value.g, 2, 1e-6f);
}

// Mitsuba's checkerboard returns the other colour where a number is looked up.
TEST(MitsubaTexture, CheckerboardsOfNumbersBeginWithTheSecond) {
  const SceneDescription scene = scene_of(
      "<shape type=\"rectangle\"><bsdf type=\"principled\"><texture type=\"checkerboard\" name=\"metallic\">"
      "<float name=\"color0\" value=\"0.75\"/><float name=\"color1\" "
      "value=\"0.25\"/></texture></bsdf></shape>");
  const auto& metallic = std::get<Disney>(scene.materials.at(0).model).metallic;
  EXPECT_EQ(metallic.evaluate(scene.textures, Vec2{0.25f, 0.25f}), 0.25f);
  EXPECT_EQ(metallic.evaluate(scene.textures, Vec2{0.75f, 0.25f}), 0.75f);
}

TEST(MitsubaTexture, OfReflectancesIsClampedTo1) {
  const MemoryAssets::Files files{{"bright.hdr", test::hdr(one_color(4, 4, Rgb{0.5f, 3, 20}))}};
  const std::string bitmap = "type='bitmap'><string name='filename' value='bright.hdr'/></texture>";
  const SceneDescription wall = textured("type='rectangle'>", "<texture name='reflectance' " + bitmap, files);
  EXPECT_EQ(wall.textures.at(0).largest(), (Rgb{0.5f, 1, 1}));
  EXPECT_THAT(warnings_of(wall), HasSubstr("the texture of 'reflectance' is clamped to at most 1"));
  const SceneDescription lamp =
      scene_of("<shape type='rectangle'><emitter type='area'><texture name='radiance' " + bitmap +
                   "</emitter></shape>",
               files);
  EXPECT_EQ(lamp.textures.at(0).largest().b, 20);
  EXPECT_EQ(warnings_of(lamp), "");
}

TEST(MitsubaTexture, ScaleMultipliesTheOneInsideOfIt) {
  const std::string image =
      "<texture type='bitmap'><string name='filename' value='half.png'/></texture></texture>";
  const MemoryAssets::Files files{{"half.png", half_white()}};
  const SceneDescription colored = textured("type='rectangle'>",
                                            "<texture name='reflectance' type='scale'><rgb name='scale' "
                                            "value='0.5, 0.25, 1'/>" +
                                                image,
                                            files);
  EXPECT_EQ(looked_up(colored, {0.5f, 0.75f}), (Rgb{0.5f, 0.25f, 1}));
  EXPECT_EQ(warnings_of(colored), "");
  const SceneDescription bumpy = scene_of(
      "<shape type='rectangle'><bsdf type='bumpmap'><float name='scale' value='0.5'/><boolean "
      "name='use_shadowing_function' value='false'/><texture type='scale'><float name='scale' value='4'/>" +
          image + "<bsdf type='diffuse'/></bsdf></shape>",
      files);
  EXPECT_EQ(bumpy.materials.at(0).bump.height, 2);
  EXPECT_EQ(warnings_of(bumpy), "");
  const SceneDescription rough = scene_of(
      "<shape type='rectangle'><bsdf type='roughconductor'><texture name='alpha' type='scale'><float "
      "name='scale' value='0.25'/>" +
          image + "</bsdf></shape>",
      files);
  EXPECT_EQ(std::get<ConductorMaterial>(rough.materials.at(0).model).roughness.value, 0.5f);
}

TEST(MitsubaTexture, InsideOfAnUnknownOneReplacesIt) {
  const SceneDescription scene = textured(
      "type='rectangle'>",
      "<texture name='reflectance' type='blur'><float name='width' value='2'/><texture type='bitmap'>"
      "<string name='filename' value='half.png'/></texture></texture>",
      {{"half.png", half_white()}});
  EXPECT_EQ(scene.textures.size(), 1u);
  EXPECT_THAT(warnings_of(scene), HasSubstr("the one inside of it replaces it"));
}

TEST(MitsubaTexture, MissingFilesCostTheTextureOnly) {
  const SceneDescription scene = textured("type=\"sphere\">",
                                          "<texture type=\"bitmap\" name=\"reflectance\"><string "
                                          "name=\"filename\" value=\"gone.png\"/></texture>",
                                          {});
  EXPECT_THAT(warnings_of(scene), HasSubstr("'gone.png' does not exist"));
}

TEST(MitsubaMedium, HomogeneousMediaHaveTheirAlbedo) {
  const SceneDescription scene = scene_of(
      "<medium type=\"homogeneous\" id=\"m\"><float name=\"scale\" value=\"2\"/><rgb name=\"sigma_t\" "
      "value=\"1 2 4\"/>"
      "<rgb name=\"albedo\" value=\"0.5\"/><phase type=\"hg\"><float name=\"g\" "
      "value=\"0.3\"/></phase></medium>"
      "<shape type=\"sphere\"><bsdf type=\"null\"/><ref name=\"interior\" id=\"m\"/></shape>");
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].sigma_s, (Rgb{0.5f, 1, 2}));
  EXPECT_EQ(scene.media[0].sigma_a, (Rgb{0.5f, 1, 2}));
  EXPECT_EQ(scene.media[0].scale, 2);
  EXPECT_FLOAT_EQ(scene.media[0].g, 0.3f);
  EXPECT_EQ(scene.materials.at(0).media, (MediumInterface{0, kNoMedium}));
}

}  // namespace
}  // namespace tessera::core::test
