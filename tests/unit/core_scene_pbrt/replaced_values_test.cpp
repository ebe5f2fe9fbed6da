// SPDX-License-Identifier: Apache-2.0
// Values of pbrt files that are replaced are told, with their place and what is done instead.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <vector>

#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core {
namespace {

using test::kPbrtTriangle;
using testing::HasSubstr;

struct Replaced {
  const char* directives;  // from line 1 or 2 on
  const char* warning;     // "LINE: WHAT", of scene.pbrt
};

void expect_told(const Replaced& one, const SceneDescription& scene) {
  EXPECT_THAT(test::warnings_of(scene), HasSubstr(std::string("scene.pbrt:") + one.warning + "\n"))
      << one.directives;
}

TEST(PbrtReplacedValues, OfTheView) {
  const std::vector<Replaced> table{
      {R"(Film "rgb" "integer xresolution" 0)",
       "1: the parameter 'xresolution' of the film must be from 1 to 65536, got 0; 1 is used"},
      {R"(Film "rgb" "string xresolution" "wide")",
       "1: the parameter 'xresolution' of the film is no whole number; its default is used"},
      {R"(Film "rgb" "float xresolution" 64.5)",
       "1: the parameter 'xresolution' of the film must be a whole number, got 64.5; 64 is used"},
      {R"(Film "rgb" "integer yresolution" [64 32])",
       "1: the parameter 'yresolution' of the film has several values; the first one is used"},
      {R"(Film "rgb" "float cropwindow" [0 1 nan 1])",
       "1: the parameter 'cropwindow' of the film is not four numbers; it is ignored"},
      {R"(Film "rgb" "integer pixelbounds" [0 10])",
       "1: the parameter 'pixelbounds' of the film is not four numbers; it is ignored"},
      {R"(Film "rgb" "float iso" -100)",
       "1: the parameter 'iso' of the film must be above 0, got -100; it is ignored"},
      {R"(Film "rgb" "float exposuretime" 0)",
       "1: the parameter 'exposuretime' of the film must be above 0, got 0; it is ignored"},
      {R"(Film "rgb" "float whitebalance" -5)",
       "1: the parameter 'whitebalance' of the film must be from 0 to 1e+06, got -5; 0 is used"},
      {R"(Film "rgb" "float gamma" 2)",
       "1: the parameter 'gamma' of the film is not supported; it is ignored"},
      {R"(PixelFilter "box" "float xradius" -1)",
       "1: the parameter 'xradius' of the pixel filter must be above 0, got -1; it is ignored"},
      {R"(PixelFilter "gaussian" "float sigma" 0)",
       "1: the parameter 'sigma' of the pixel filter must be above 0, got 0; it is ignored"},
      {R"(PixelFilter "gaussian" "float alpha" 2)",
       "1: the parameter 'alpha' of the pixel filter is that of pbrt-v3; \"sigma\" is used instead"},
      {R"(Sampler "dice")", "1: the sampler 'dice' is not known; Sobol' points are used"},
      {R"(Sampler "halton" "integer pixelsamples" 0)",
       "1: the parameter 'pixelsamples' of the sampler must be from 1 to 16777216, got 0; 1 is used"},
      {R"(Integrator "path" "float maxdepth" 3.5)",
       "1: the parameter 'maxdepth' of the integrator must be a whole number, got 3.5; 3 is used"},
      {R"(Option "integer seed" -3)",
       "1: the parameter 'seed' of the options must be from 0 to 2147483647, got -3; 0 is used"},
      {R"(Camera "perspective" "float fov" 200)",
       "1: the parameter 'fov' of the camera must be from 0.01 to 179.9, got 200; 179.9 is used"},
      {R"(Camera "perspective" "float fov" nan)",
       "1: the parameter 'fov' of the camera is no number; its default is used"},
      {R"(Camera "perspective" "float lensradius" -1)",
       "1: the parameter 'lensradius' of the camera must be from 0 to 1e+15, got -1; 0 is used"},
      {R"(Camera "perspective" "float frameaspectratio" 0)",
       "1: the parameter 'frameaspectratio' of the camera must be above 0, got 0; it is ignored"},
      {R"(Camera "perspective" "float screenwindow" [0 1])",
       "1: the parameter 'screenwindow' of the camera is not four numbers; it is ignored"},
      {R"(Camera "perspective" "float shutteropen" 2)",
       "1: the parameter 'shutterclose' of the camera must be after \"shutteropen\"; the exposure is that of "
       "one second"},
      {R"(Camera "spherical" "string mapping" "cube")",
       "1: the parameter 'mapping' of the camera is 'cube', which is not known; 'equalarea' is used"},
      {R"(TransformTimes nan 1)", "1: a time is nan; 0 seconds are used"},
      {R"(Rotate 30 0 0 0)", "1: a rotation without an axis or an angle is left out"},
  };
  for (const Replaced& one : table) {
    expect_told(one, test::pbrt_scene(std::string(one.directives) + "\nWorldBegin\n" + kPbrtTriangle));
  }
}

TEST(PbrtReplacedValues, OfLights) {
  const std::vector<Replaced> table{
      {R"(LightSource "point" "float power" -3)",
       "2: the parameter 'power' of the light source 'point' must be above 0, got -3; it is ignored"},
      {R"(LightSource "point" "float scale" -1)",
       "2: the parameter 'scale' of the light source 'point' must be from 0 to 1e+30, got -1; 0 is used"},
      {R"(LightSource "point" "float scale" -1)", "2: a light without power is left out"},
      {R"(LightSource "point" "rgb I" [0 0 0])", "2: a light without power is left out"},
      {R"(LightSource "point" "blackbody I" [6500 2])",
       "2: the parameter 'I' of the light source 'point' has several values; the first one is the "
       "temperature, the "
       "others are ignored"},
      {R"(LightSource "point" "rgb I" [1 nan 1])", "2: the colour 'I' is not understood; 1 is used"},
      {R"(LightSource "point" "rgb I" [1 -1 1])",
       "2: the parameter 'I' of the light source 'point' has negative red, green or blue, which become 0"},
      {R"(LightSource "point" "point3 from" [nan 0 0])",
       "2: a light is left out: position must be a number between -1e15 and 1e15, got [nan, nan, nan]"},
      {R"(LightSource "point" "point3 from" [1 2])",
       "2: the parameter 'from' of the light source 'point' does not have 3 values each; the last ones are "
       "ignored"},
      {R"(LightSource "spot" "float coneangle" 120)",
       "2: the parameter 'coneangle' of the light source 'spot' must be from 0.01 to 90, got 120; 90 is "
       "used"},
      {R"(LightSource "spot" "float conedeltaangle" 40)",
       "2: the parameter 'conedeltaangle' of the light source 'spot' must be from 0 to 30, got 40; 30 is "
       "used"},
      {R"(LightSource "distant" "float illuminance" 0)",
       "2: the parameter 'illuminance' of the light source 'distant' must be above 0, got 0; it is ignored"},
      {R"(LightSource "infinite" "rgb L" [0 0 0])", "2: an infinite light without power does not emit"},
      {R"(AreaLightSource "diffuse" "rgb L" [0 0 0])", "2: an area light without power does not emit"},
      {R"(AreaLightSource "diffuse" "string twosided" "true")",
       "2: the parameter 'twosided' of the area light 'diffuse' is neither true nor false; its default is "
       "used"},
  };
  for (const Replaced& one : table)
    expect_told(one, test::pbrt_world(std::string(one.directives) + "\n" + kPbrtTriangle));
}

TEST(PbrtReplacedValues, OfMaterialsAndTextures) {
  const std::vector<Replaced> table{
      {R"(Material "diffuse" "rgb reflectance" [2 0.5 0.5])",
       "2: the parameter 'reflectance' of the material 'diffuse' is outside of the colours from 0 to 1; it "
       "is "
       "clamped"},
      {R"(Material "diffuse" "rgb albedo" [1 1 1])",
       "2: the parameter 'albedo' of the material 'diffuse' is not supported; it is ignored"},
      {R"(Material "dielectric" "float eta" -2)",
       "2: the parameter 'eta' of the material 'dielectric' must be from 0 to 10, got -2; 1 is used"},
      {R"(Material "dielectric" "spectrum eta" "glass-none")",
       "2: the parameter 'eta' of the material 'dielectric' is no spectrum that can be read; 1.5 is used"},
      {R"(Material "conductor" "float roughness" 3)",
       "2: the parameter 'roughness' of the material 'conductor' must be from 0 to 1, got 3; 1 is used"},
      {R"(Material "conductor" "rgb roughness" [0.1 0.2 0.3])",
       "2: the parameter 'roughness' of the material 'conductor' is a colour, and a number is expected; its "
       "mean "
       "is used"},
      {R"(Material "coateddiffuse" "float thickness" 1)",
       "2: the parameter 'thickness' of the material 'coateddiffuse' has no effect, because nothing scatters "
       "between the layers"},
      {R"(Material "diffusetransmission" "float scale" 9)",
       "2: the parameter 'scale' of the material 'diffusetransmission' makes the surface brighter than "
       "white; "
       "its colour is clamped"},
      {R"(Material "hair" "float beta_m" 2)",
       "2: the parameter 'beta_m' of the material 'hair' must be from 0 to 1, got 2; 1 is used"},
      {R"(Material "measured" "string filename" "cloth.bsdf")",
       "2: the material 'measured' is refused: the measured reflectance of 'cloth.bsdf' cannot be read; a "
       "gray "
       "diffuse material replaces it"},
      {R"(Texture "t" "spectrum" "checkerboard" "float uscale" 1e9)",
       "2: the parameter 'uscale' of the texture 'checkerboard' must be from -1e+06 to 1e+06, got 1e+09; "
       "1e+06 is "
       "used"},
      {R"(Texture "t" "spectrum" "checkerboard" "integer uscale" 3)",
       "2: the parameter 'uscale' of the texture 'checkerboard' is an integer, and a float is expected; it "
       "is "
       "used as one"},
      {R"(Texture "t" "spectrum" "checkerboard" "integer dimension" 4)",
       "2: the parameter 'dimension' of the texture 'checkerboard' must be 2 or 3, got 4; 2 is used"},
      {R"(Material "diffuse" "float reflectance" 0.1)",
       "2: the parameter 'reflectance' of the material 'diffuse' is a number, and a colour is expected; the "
       "gray of this value is used"},
      {R"(Texture "t" "float" "constant" "string value" "one")",
       "2: the parameter 'value' of the texture 'constant' is no number; its default is used"},
      {R"(Attribute "shape" "float radios" 3)",
       "2: the attribute 'radios' of every shape is used by none; it is ignored"},
  };
  for (const Replaced& one : table) {
    expect_told(one, test::pbrt_world(std::string(one.directives) + "\n" + kPbrtTriangle));
  }
}

TEST(PbrtReplacedValues, OfImages) {
  const test::MemoryAssets::Files files{{"a.png", test::png(test::one_color(2, 2, Rgb{0.5f, 0.25f, 1}))}};
  const auto warnings = [&](const std::string& parameters) {
    return test::warnings_of(
        test::pbrt_world("Texture \"t\" \"spectrum\" \"imagemap\" \"string filename\" \"a.png\" " +
                             parameters + "\n" + kPbrtTriangle,
                         files));
  };
  EXPECT_EQ(warnings("\"string wrap\" \"twist\""),
            "scene.pbrt:2: the parameter 'wrap' of the texture 'imagemap' is 'twist', which is not known; "
            "'repeat' is "
            "used\n");
  EXPECT_EQ(warnings("\"string filter\" \"foo\""),
            "scene.pbrt:2: the parameter 'filter' of the texture 'imagemap' is 'foo', which is not known; "
            "'bilinear' is used\n");
  EXPECT_EQ(warnings("\"string encoding\" \"log\""),
            "scene.pbrt:2: the parameter 'encoding' of the texture 'imagemap' is 'log', which is not known; "
            "'sRGB' is "
            "used\n");
  EXPECT_EQ(
      warnings("\"string encoding\" \"gamma 0\""),
      "scene.pbrt:2: the parameter 'encoding' of the texture 'imagemap' has no gamma from 0.1 to 10; 2.2 is "
      "used\n");
}

TEST(PbrtReplacedValues, OfShapesAndMedia) {
  const std::vector<Replaced> table{
      {R"(Shape "sphere" "float radius" -2)",
       "2: the parameter 'radius' of the shape 'sphere' is negative; it is taken without its sign"},
      {R"(Shape "sphere" "float phimax" 400)",
       "2: the parameter 'phimax' of the shape 'sphere' must be from 0 to 360, got 400; 360 is used"},
      {R"(Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 2 0])",
       "2: the parameter 'indices' of the shape 'trianglemesh' does not have 3 values each; the last ones "
       "are "
       "ignored"},
      {R"(Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "vector3 S" [1 0 0])",
       "2: tangents are ignored: there is not one for each vertex"},
      {R"(Shape "bilinearmesh" "point3 P" [0 0 0 1 0 0 0 1 0 1 1 0] "normal N" [0 0 1])",
       "2: the parameter 'N' of the shape 'bilinearmesh' has not one value for each vertex; it is ignored"},
      {R"(Shape "curve" "point3 P" [0 0 0 1 0 0 2 0 0 3 0 0] "string basis" "hermite")",
       "2: the parameter 'basis' of the shape 'curve' is 'hermite', which is not known; 'bezier' is used"},
      {R"(Shape "loopsubdiv" "point3 P" [0 0 0 1 0 0 0 1 0] "integer levels" -1)",
       "2: the parameter 'levels' of the shape 'loopsubdiv' must be from 0 to 8, got -1; 0 is used"},
      {R"(MakeNamedMedium "m" "string type" "homogeneous" "float g" 2)",
       "2: the parameter 'g' of the medium 'homogeneous' must be from -0.999 to 0.999, got 2; 0.999 is used"},
      {R"(MakeNamedMedium "m" "string type" "homogeneous" "string preset" "Skimmilk" "rgb sigma_a" [1 1 1])",
       "2: the parameter 'sigma_a' of the medium 'homogeneous' is ignored, because there is a \"preset\""},
      {"MakeNamedMaterial \"a\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"a\" \"string type\" "
       "\"diffuse\"",
       "3: the material 'a' exists already; this one replaces it from here on"},
      {"Texture \"a\" \"float\" \"constant\"\nTexture \"a\" \"float\" \"constant\"",
       "3: the texture 'a' exists already; this one replaces it from here on"},
      {"ObjectBegin \"a\" ObjectEnd\nObjectBegin \"a\" ObjectEnd",
       "3: the object 'a' exists already; this one replaces it from here on"},
  };
  for (const Replaced& one : table)
    expect_told(one, test::pbrt_world(std::string(one.directives) + "\n" + kPbrtTriangle));
}

// Equal ones are counted, whatever their values.
TEST(PbrtReplacedValues, AreCounted) {
  const std::string sphere = R"(Shape "sphere" "float phimax" )";
  EXPECT_THAT(
      test::warnings_of(test::pbrt_world(sphere + "400\n" + sphere + "500\n")),
      HasSubstr("scene.pbrt:2: the parameter 'phimax' of the shape 'sphere' must be from 0 to 360, got 400; "
                "360 is used (2 times)\n"));
}

// What cannot be rendered is left out, and the triangle remains.
TEST(PbrtLeftOut, ShapesThatCannotBeRendered) {
  const std::vector<Replaced> table{
      {R"(Shape "sphere" "float radius" 0)", "2: a sphere without a surface is left out"},
      {R"(Shape "sphere" "float radius" 1e30)",
       "2: a shape is left out: the centre must be numbers of at most 1e+15 and the radius above 0"},
      {R"(Shape "disk" "float radius" 0)", "2: a disk without a surface is left out"},
      {R"(Shape "disk" "float height" 1e30)",
       "2: a shape is left out: coordinates must be numbers of at most 1e+15"},
      {R"(Shape "cylinder" "float radius" 1e-30)",
       "2: a shape is left out: the cylinder is flat, or too small or too large to be computed"},
      {R"(Scale 0 0 0 Shape "disk")", "2: a shape is left out: the disk has no area that can be computed"},
      {R"(Scale 0 1 1 Shape "sphere" Identity)",
       "2: a shape is left out: the transform flattens the object, or scales or moves it too far to be "
       "computed"},
      {R"(Translate nan 0 0 Shape "sphere" Identity)",
       "2: a shape is left out: the transform flattens the object, or scales or moves it too far to be "
       "computed"},
      {R"(Shape "trianglemesh" "point3 P" [nan 0 0 1 0 0 0 1 0])",
       "2: triangles whose corners are no vertices, or no usable ones, are left out"},
      {R"(Shape "trianglemesh" "point3 P" [-nan(ind) 0 0 1 0 0 0 1 0])",
       "2: a mesh without a triangle that has an area is left out"},
      {R"(Shape "trianglemesh" "point3 P" [0 0 0 1 0 0 0 1 0] "integer indices" [0 1 7])",
       "2: triangles with a corner that is no vertex are left out"},
      {R"(Shape "trianglemesh")", "2: the shape 'trianglemesh' has no indices; it is left out"},
      {R"(Shape "curve" "point3 P" [nan 0 0 1 0 0 2 0 0 3 0 0])",
       "2: a shape is left out: control point 1: coordinates must be numbers of at most 1e+15"},
      {"ObjectBegin \"o\" Shape \"sphere\" ObjectEnd Scale 1 0 1\nObjectInstance \"o\" Identity",
       "3: a shape is left out: the transform flattens the object, or scales or moves it too far to be "
       "computed"},
  };
  for (const Replaced& one : table) {
    const SceneDescription scene =
        test::pbrt_world(std::string(one.directives) + "\nIdentity\n" + kPbrtTriangle);
    expect_told(one, scene);
    EXPECT_EQ(scene.shapes.size(), 1u) << one.directives;
  }
}

// Of nested instances whose product cannot be computed.
TEST(PbrtLeftOut, InstancesThatReachTooFar) {
  const SceneDescription scene = test::pbrt_world(
      "ObjectBegin \"o\" Shape \"sphere\" \"float radius\" 1e10 ObjectEnd\nScale 1e10 1e10 1e10 "
      "ObjectInstance "
      "\"o\" Identity\n" +
      kPbrtTriangle);
  EXPECT_THAT(
      test::warnings_of(scene),
      HasSubstr("scene.pbrt: instance in line 3 is left out: the object reaches farther than 1e+15 there\n"));
  EXPECT_EQ(scene.shapes.size(), 1u);
}

TEST(PbrtNames, OfMaterialsAreThoseOfTheFile) {
  const Material wood =
      test::pbrt_material("MakeNamedMaterial \"wood\" \"string type\" \"diffuse\"\nNamedMaterial \"wood\"");
  EXPECT_EQ(wood.name, "wood");
}

}  // namespace
}  // namespace tessera::core
