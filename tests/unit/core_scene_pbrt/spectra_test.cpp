// SPDX-License-Identifier: Apache-2.0
// Spectra and colour spaces as colours.
#include <gmock/gmock.h>

#include <vector>

#include "core/spectra/color_space.hpp"
#include "core/spectra/spectrum_color.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

TEST(SpectrumColor, EvenReflectanceIsGray) {
  const std::vector<spectra::SpectralSample> even{{300, 0.4}, {900, 0.4}};
  expect_color(factor_color(even), Rgb::gray(0.4f), 1e-4f);
}

TEST(SpectrumColor, BlackBodiesFollowPlancksLocus) {
  // Illuminant A is a black body of 2856 K.
  expect_color(spectra::blackbody_color(2856), color_of(*spectra::illuminant("A")), 0.01f);
  EXPECT_NEAR(luminance(spectra::blackbody_color(9000)), 1, 0.01);
  EXPECT_GT(spectra::blackbody_color(9000).b, spectra::blackbody_color(9000).r);
}

TEST(SpectrumColor, MeansAreWeightedByTheEye) {
  EXPECT_NEAR(photopic_mean(std::vector<spectra::SpectralSample>{{400, 1.5}, {700, 1.5}}), 1.5, 1e-9);
  EXPECT_NEAR(photopic_mean(std::vector<spectra::SpectralSample>{{360, 1}, {760, 3}}), 2, 0.05);
  EXPECT_EQ(spectra::photopic_mean({}), 0);
}

TEST(ColorSpace, WhiteStaysWhite) {
  for (const char* name : {"srgb", "rec2020", "dci-p3", "aces2065-1"})
    expect_color((*spectra::to_rec709(name))(Rgb::gray(1)), Rgb::gray(1), 0.002f);
  EXPECT_FALSE(spectra::to_rec709("cmyk"));
  expect_color(color_of(*spectra::illuminant("D65")), Rgb::gray(1), 0.002f);
}

TEST(ColorSpace, DaylightOf6504KelvinIsD65) {
  EXPECT_NEAR(spectra::daylight(6504).x, 0.3127, 2e-4);
  EXPECT_NEAR(spectra::daylight(6504).y, 0.3291, 2e-4);
  expect_color(white_balance(spectra::daylight(6504))(Rgb{0.2f, 0.5f, 0.8f}), {0.2f, 0.5f, 0.8f}, 0.002f);
}

TEST(PbrtColors, ReflectancesFromSpectraAndFiles) {
  const auto albedo = [](const std::string& parameter, const MemoryAssets::Files& files = {}) {
    return std::get<Lambert>(pbrt_material("Material \"diffuse\" " + parameter, files).model).albedo.value;
  };
  expect_color(albedo("\"spectrum reflectance\" [300 0.3 900 0.3]"), Rgb::gray(0.3f), 1e-4f);
  expect_color(albedo("\"spectrum reflectance\" \"a.spd\"", {{"a.spd", "# gray\n300 0.25\n900 0.25\n"}}),
               Rgb::gray(0.25f), 1e-4f);
  const Rgb red = albedo("\"spectrum reflectance\" [599 0 600 1 900 1]");
  EXPECT_GT(red.r, 0.5f);
  EXPECT_EQ(red.b, 0);
}

TEST(PbrtColors, ColorSpacesEndWithTheirAttributes) {
  const SceneDescription scene = pbrt_world(
      "AttributeBegin ColorSpace \"rec2020\" Material \"diffuse\" \"rgb reflectance\" [0.2 0.5 0.2]\n" +
      kPbrtTriangle + "AttributeEnd Material \"diffuse\" \"rgb reflectance\" [0.2 0.5 0.2]\n" +
      kPbrtTriangle);
  const auto albedo = [&](std::size_t i) {
    return std::get<Lambert>(scene.materials.at(i).model).albedo.value;
  };
  expect_color(albedo(0), {0.0237f, 0.5399f, 0.1698f}, 0.001f);
  EXPECT_EQ(albedo(1), (Rgb{0.2f, 0.5f, 0.2f}));
}

// Also of what is made later: attributes, parts of mixtures, and lights of shapes.
TEST(PbrtColors, ColorSpacesAreThoseOfTheParameter) {
  const std::string color = " [0.2 0.5 0.2]\n", two = "\nColorSpace \"rec2020\"\n";
  const auto albedo = [](const std::string& directives) {
    const SceneDescription scene = pbrt_world(directives + kPbrtTriangle);
    return std::get<Lambert>(scene.materials.at(0).model).albedo.value;
  };
  const std::string attribute = "Attribute \"material\" \"rgb reflectance\"" + color;
  EXPECT_EQ(albedo(attribute + two + "Material \"diffuse\"\n"), (Rgb{0.2f, 0.5f, 0.2f}));
  expect_color(albedo(two + attribute + "ColorSpace \"srgb\" Material \"diffuse\"\n"),
               {0.0237f, 0.5399f, 0.1698f}, 0.001f);
  const std::string light = "AreaLightSource \"diffuse\" \"rgb L\"" + color;
  const SceneDescription lamp = pbrt_world(light + two + kPbrtTriangle);
  EXPECT_EQ(lamp.materials.at(0).emission.value, (Rgb{0.2f, 0.5f, 0.2f}));
  const SceneDescription mixed = pbrt_world(
      "MakeNamedMaterial \"m\" \"string type\" \"mix\" \"string materials\" [\"a\" \"a\"]\n"
      "MakeNamedMaterial \"a\" \"string type\" \"diffuse\" \"rgb reflectance\"" +
      color + two + "NamedMaterial \"m\"\n" + kPbrtTriangle);
  EXPECT_EQ(std::get<Lambert>(mixed.materials.at(0).model).albedo.value, (Rgb{0.2f, 0.5f, 0.2f}));
}

TEST(PbrtColors, WhatIsNotUnderstoodIsTold) {
  EXPECT_THAT(
      warnings_of(pbrt_world("Material \"diffuse\" \"spectrum reflectance\" \"gone\"\n" + kPbrtTriangle)),
      HasSubstr("scene.pbrt:2: there is no spectrum 'gone'"));
  EXPECT_THAT(warnings_of(pbrt_world("Material \"diffuse\" \"spectrum reflectance\" [500 1 400 1]\n" +
                                     kPbrtTriangle)),
              HasSubstr("scene.pbrt:2: the colour 'reflectance' is not understood"));
  EXPECT_THAT(warnings_of(pbrt_world("ColorSpace \"cmyk\"\n" + kPbrtTriangle)),
              HasSubstr("the colour space 'cmyk' is not known"));
}

}  // namespace
}  // namespace tessera::core::test
