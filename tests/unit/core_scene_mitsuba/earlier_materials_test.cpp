// SPDX-License-Identifier: Apache-2.0
// BSDFs of Mitsuba 0.x become the nearest that there are, and keep their colours.
#include <gmock/gmock.h>

#include <variant>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

// The scene of a sphere with this BSDF.
SceneDescription with_bsdf(const std::string& type, const std::string& inside) {
  const auto scene = load_xml(
      xml_scene("<shape type='sphere'><bsdf type='" + type + "'>" + inside + "</bsdf></shape>", false));
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return {};
  EXPECT_THAT(warnings_of(*scene), HasSubstr("<bsdf type=\"" + type + "\">: is one of Mitsuba 0.x; "));
  return *scene;
}

template <typename Model>
Model last_model(const SceneDescription& scene) {
  const auto* model = std::get_if<Model>(&scene.materials.back().model);
  EXPECT_NE(model, nullptr);
  return model == nullptr ? Model{} : *model;
}

const std::string kRed = "<bsdf type='diffuse'><rgb name='reflectance' value='0.5, 0, 0'/></bsdf>";
const std::string kBlue = "<bsdf type='diffuse'><rgb name='reflectance' value='0, 0, 0.5'/></bsdf>";

TEST(MitsubaEarlierBsdf, RoughDiffuse) {
  const auto model = last_model<Principled>(with_bsdf(
      "roughdiffuse", "<rgb name='reflectance' value='0.1 0.2 0.7'/><float name='alpha' value='0.5'/>"));
  EXPECT_EQ(model.base_color.value, (Rgb{0.1f, 0.2f, 0.7f}));
  EXPECT_FLOAT_EQ(model.base_diffuse_roughness.value, 0.35355338f);
  EXPECT_EQ(model.specular_weight.value, 0);
}

TEST(MitsubaEarlierBsdf, PhongAndWard) {
  const std::string red = "<rgb name='diffuse_reflectance' value='0.6 0.1 0.1'/>";
  const auto phong = last_model<Phong>(with_bsdf("phong", red + "<float name='exponent' value='50'/>"));
  EXPECT_EQ(phong.diffuse.value, (Rgb{0.6f, 0.1f, 0.1f}));
  EXPECT_EQ(phong.specular.value, Rgb::gray(0.2f));
  EXPECT_EQ(phong.exponent.value, 50);
  const SceneDescription scene = with_bsdf("ward", red + "<float name='alpha_u' value='0.2'/>");
  EXPECT_FALSE(scene.materials.at(0).two_sided);
  EXPECT_EQ(last_model<Phong>(scene).diffuse.value, (Rgb{0.6f, 0.1f, 0.1f}));
  EXPECT_FLOAT_EQ(last_model<Phong>(scene).exponent.value, 25);
  EXPECT_THAT(warnings_of(scene), HasSubstr("which is not anisotropic"));
}

TEST(MitsubaEarlierBsdf, DiffuseTransmission) {
  const SceneDescription scene = with_bsdf("difftrans", "<rgb name='transmittance' value='0.7 0.1 0.6'/>");
  EXPECT_EQ(last_model<DiffuseTransmission>(scene).transmittance.value, (Rgb{0.7f, 0.1f, 0.6f}));
  EXPECT_EQ(last_model<DiffuseTransmission>(scene).reflectance.value, Rgb{});
  EXPECT_TRUE(scene.materials.at(0).two_sided);
}

TEST(MitsubaEarlierBsdf, CoatsAreOverWhatIsInside) {
  const auto plastic =
      last_model<Plastic>(with_bsdf("roughcoating", kRed + "<float name='int_ior' value='1.7'/>"));
  EXPECT_EQ(plastic.diffuse.value, (Rgb{0.5f, 0, 0}));
  EXPECT_NEAR(plastic.ior.value, 1.7f, 1e-3f);
  EXPECT_GT(plastic.roughness.value, 0);
  const auto metal = last_model<Principled>(
      with_bsdf("coating", "<bsdf type='roughconductor'><string name='material' value='Cu'/></bsdf>"));
  EXPECT_EQ(metal.base_metalness.value, 1);
  EXPECT_EQ(metal.coat_weight.value, 1);
  EXPECT_GT(metal.base_color.value.r, 1.5f * metal.base_color.value.b);
  EXPECT_GT(metal.specular_roughness.value, 0);
  const SceneDescription glass = with_bsdf("coating", "<bsdf type='dielectric'/>");
  EXPECT_TRUE(std::holds_alternative<Glass>(glass.materials.back().model));
}

TEST(MitsubaEarlierBsdf, MixturesAreBlends) {
  const auto weights = [](const std::string& text) {
    return "<string name='weights' value='" + text + "'/>";
  };
  const auto albedo = [](const SceneDescription& scene, std::uint32_t index) {
    return std::get<Lambert>(scene.materials.at(index).model).albedo.value;
  };
  const SceneDescription two = with_bsdf("mixturebsdf", weights("0.7, 0.3") + kRed + kBlue);
  const auto blend = last_model<Blend>(two);
  EXPECT_FLOAT_EQ(blend.weight.value, 0.3f);
  EXPECT_EQ(albedo(two, blend.first), (Rgb{0.5f, 0, 0}));
  EXPECT_EQ(albedo(two, blend.second), (Rgb{0, 0, 0.5f}));
  const SceneDescription dark = with_bsdf("mixturebsdf", weights("0.25 0.25") + kRed + kBlue);
  const auto outer = last_model<Blend>(dark);
  EXPECT_FLOAT_EQ(outer.weight.value, 0.75f);
  const auto inner = std::get<Blend>(dark.materials.at(outer.second).model);
  EXPECT_FLOAT_EQ(inner.weight.value, 2 / 3.0f);
  EXPECT_EQ(albedo(dark, inner.second), Rgb{});
  const SceneDescription equal = with_bsdf("mixturebsdf", weights("1") + kRed + kBlue);
  EXPECT_FLOAT_EQ(last_model<Blend>(equal).weight.value, 0.5f);
  EXPECT_THAT(warnings_of(equal), HasSubstr("'weights' has not as many finite numbers as there are BSDFs"));
}

TEST(MitsubaEarlierBsdf, OldNamesAreUpgraded) {
  const auto scene = load_xml(
      "<scene version='0.6.0'><shape type='sphere'><bsdf type='phong'><srgb name='diffuseReflectance' "
      "value='#ff0000'/></bsdf></shape></scene>");
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(last_model<Phong>(*scene).diffuse.value, (Rgb{1, 0, 0}));
}

}  // namespace
}  // namespace tessera::core::test
