// SPDX-License-Identifier: Apache-2.0
// Cameras, films, filters, samplers and integrators of pbrt files.
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <numbers>

#include "core/camera/camera.hpp"
#include "core/scene/pbrt/lens_system.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

SceneDescription seen_by(const std::string& before_world) {
  return pbrt_scene(before_world + "\nWorldBegin Shape \"sphere\"\n");
}

TEST(PbrtView, DefaultsAreThoseOfTheFormat) {
  const SceneDescription scene = seen_by("");
  EXPECT_EQ(scene.settings.width_px, 1280);
  EXPECT_EQ(scene.settings.height_px, 720);
  EXPECT_EQ(scene.settings.spp, 16u);
  EXPECT_EQ(scene.settings.max_depth, 5);
  EXPECT_EQ(scene.settings.filter, (PixelFilter{FilterKind::kGaussian, 1.5f}));
  EXPECT_NEAR(scene.camera.vertical_fov_degrees, 90, 1e-3);
}

TEST(PbrtView, OptionsHaveANameAndAValue) {
  const SceneDescription scene =
      seen_by("Option \"disablepixeljitter\" true Option \"render-coord_sys\" \"world\" Option \"Seed\" 5\n");
  EXPECT_EQ(scene.settings.seed, 5u);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(PbrtView, SettingsAreRead) {
  const SceneDescription scene = seen_by(
      "Film \"rgb\" \"integer xresolution\" 80 \"integer yresolution\" 60 \"string filename\" \"a.exr\"\n"
      "Sampler \"zsobol\" \"integer pixelsamples\" 7 Integrator \"volpath\" \"integer maxdepth\" 3\n"
      "PixelFilter \"triangle\" \"float xradius\" 1 \"float yradius\" 1\n"
      "Option \"integer seed\" 4 Accelerator \"bvh\"\n");
  EXPECT_EQ(scene.settings.width_px, 80);
  EXPECT_EQ(scene.settings.height_px, 60);
  EXPECT_EQ(scene.settings.spp, 7u);
  EXPECT_EQ(scene.settings.max_depth, 3);
  EXPECT_EQ(scene.settings.seed, 4u);
  EXPECT_EQ(scene.settings.filter, (PixelFilter{FilterKind::kTent, 1}));
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(PbrtView, TheFieldOfViewIsThatOfTheShorterAxis) {
  const std::string camera = "Camera \"perspective\" \"float fov\" 60\n";
  const auto fov = [&](int width, int height) {
    return seen_by(camera + "Film \"rgb\" \"integer xresolution\" " + std::to_string(width) +
                   " \"integer yresolution\" " + std::to_string(height))
        .camera.vertical_fov_degrees;
  };
  EXPECT_NEAR(fov(200, 100), 60, 1e-3);
  // tan 30 degrees times 2.
  EXPECT_NEAR(fov(100, 200), 2 * 49.10661, 1e-3);
}

TEST(PbrtView, CropWindowsAreRoundedUp) {
  const std::string film = "Film \"rgb\" \"integer xresolution\" 100 \"integer yresolution\" 50 ";
  EXPECT_EQ(seen_by(film + "\"float cropwindow\" [0.101 0.5 0 0.5]").settings.crop,
            (PixelRect{11, 0, 50, 25}));
  EXPECT_EQ(seen_by(film + "\"integer pixelbounds\" [10 20 5 50]").settings.crop, (PixelRect{10, 5, 20, 50}));
  EXPECT_FALSE(seen_by(film).settings.crop);
}

TEST(PbrtView, ScreenWindowsShiftTheLens) {
  const SceneDescription scene = seen_by(
      "Camera \"perspective\" \"float fov\" 90 \"float screenwindow\" [0 1 -0.5 0.5]\n"
      "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64");
  EXPECT_NEAR(scene.camera.lens_shift.x, 0.5, 1e-6);
  EXPECT_NEAR(scene.camera.lens_shift.y, 0, 1e-6);
  EXPECT_NEAR(scene.camera.vertical_fov_degrees, 2 * 26.56505, 1e-3);
}

// The direction of the ray through the point of an image of 64 x 64 pixels.
Vec3 view_direction(const SceneDescription& scene, Vec2 raster) {
  return Camera(scene.camera).ray(raster, 64, 64, {0.5f, 0.5f}).direction;
}

TEST(PbrtView, LeftHandedCamerasMirrorTheImage) {
  // x is to the right and y up, seen along +z.
  const std::string film = "Film \"rgb\" \"integer xresolution\" 64 \"integer yresolution\" 64\n";
  const SceneDescription scene = pbrt_scene(film +
                                            "LookAt 0 0 -5  0 0 0  0 1 0 Camera \"perspective\" WorldBegin\n"
                                            "Translate 1 2 0 Shape \"sphere\"\n");
  const Vec3 center = std::get<SphereDescription>(scene.shapes.at(0)).center;
  const Vec3 right = view_direction(scene, {64, 32}) - view_direction(scene, {0, 32});
  const Vec3 up = view_direction(scene, {32, 0}) - view_direction(scene, {32, 64});
  EXPECT_GT(dot(right, center - scene.camera.position), 0.5f);
  EXPECT_GT(dot(up, center - scene.camera.position), 0.5f);
  EXPECT_EQ(center, (Vec3{1, 2, 0}));
}

TEST(PbrtView, RightHandedCamerasDoNot) {
  const SceneDescription scene = pbrt_scene(
      "Scale -1 1 1 LookAt 0 0 5  0 0 0  0 1 0 Camera \"perspective\" WorldBegin Translate 1 2 0 Shape "
      "\"sphere\"\n");
  EXPECT_EQ(std::get<SphereDescription>(scene.shapes.at(0)).center, (Vec3{1, 2, 0}));
  EXPECT_FALSE(scene.camera.mirrored);
  EXPECT_EQ(scene.camera.position, (Vec3{0, 0, 5}));
  EXPECT_GT((view_direction(scene, {64, 32}) - view_direction(scene, {0, 32})).x, 0);
}

TEST(PbrtView, LensesAreInTheSpaceOfTheCamera) {
  // The camera's space is half as large as the world.
  const SceneDescription scene =
      seen_by("Scale 0.5 0.5 0.5 Camera \"perspective\" \"float lensradius\" 0.1 \"float focaldistance\" 3");
  EXPECT_NEAR(scene.camera.aperture_radius, 0.2, 1e-6);
  EXPECT_NEAR(scene.camera.focus_distance, 6, 1e-5);
}

// A thin lens of 50 mm at f / 2.5, with its stop.
const MemoryAssets::Files kThinLens{
    {"thin.dat", "# radius thickness index diameter\n50 0 1.5 40\n-50 0 1 40\n0 50 0 30\n"}};

SceneDescription seen_through(const std::string& lens, const MemoryAssets::Files& files) {
  return pbrt_scene(
      "Camera \"realistic\" \"string lensfile\" \"" + lens +
          "\" \"float aperturediameter\" 20 \"float focusdistance\" 2\n"
          "Film \"rgb\" \"integer xresolution\" 60 \"integer yresolution\" 40 \"float "
          "diagonal\" 43.2666\nWorldBegin Shape \"sphere\" LightSource \"point\" \"rgb I\" [1 1 1]\n",
      files);
}

// Of thin lenses: 1 / image + 1 / object = 1 / f, with image + object = 2 m.
TEST(PbrtView, LensFilesGiveTheFieldOfViewTheLensAndTheExposure) {
  const SceneDescription scene = seen_through("thin.dat", kThinLens);
  const double image = 1000 - std::sqrt(1000.0 * 1000 - 2000 * 50), object = 2000 - image;
  EXPECT_NEAR(static_cast<double>(scene.camera.vertical_fov_degrees),
              2 * std::atan(12 / image) * 180 / std::numbers::pi, 1e-2);
  EXPECT_NEAR(static_cast<double>(scene.camera.aperture_radius), 0.01, 1e-6);
  EXPECT_NEAR(static_cast<double>(scene.camera.focus_distance), object / 1000, 1e-5);
  EXPECT_NEAR(static_cast<double>(std::fabs(scene.camera.position.z)), image / 1000, 1e-5);
  EXPECT_NEAR(static_cast<double>(std::get<PointLightDescription>(scene.lights.at(0)).intensity.g),
              std::numbers::pi * (10 / image) * (10 / image), 1e-4);
  EXPECT_THAT(warnings_of(scene), HasSubstr("with a thin lens"));
}

// A plano-convex lens of 100 mm whose stop is 20 mm behind it: the pupil is 20 / (1 - 20 / 100) mm behind,
// and larger by the same factor.
TEST(PbrtView, TheEntrancePupilIsTheImageOfTheStop) {
  const auto lens = pbrt::focused({{50, 0, 1.5, 80}, {0, 20, 1, 80}, {0, 80, 0, 16}}, 1e9);
  ASSERT_TRUE(lens);
  EXPECT_NEAR(lens->focal_length, 100, 1e-9);
  EXPECT_NEAR(lens->pupil_radius, 10, 1e-9);
  EXPECT_NEAR(lens->pupil_distance, 75, 1e-4);
  EXPECT_NEAR(lens->field, 0.01, 1e-6);
  for (const double distance : {1e15, 1e18, 1e33}) {
    const auto far = pbrt::focused({{50, 0, 1.5, 80}, {0, 20, 1, 80}, {0, 80, 0, 16}}, distance);
    ASSERT_TRUE(far) << distance;
    EXPECT_NEAR(far->field, 0.01, 1e-9);
    EXPECT_NEAR(far->focus_distance / distance, 1, 1e-9);
  }
}

TEST(PbrtView, BrokenLensesBecomeOneOf50Mm) {
  for (const char* text : {"50 0 1.5", "a b c d", "", "-50 0 1.5 40 50 0 1 40", "50 0 1.5 -1 -50 0 1 40"})
    EXPECT_THAT(warnings_of(seen_through("a.dat", {{"a.dat", text}})),
                HasSubstr("'a.dat' cannot be read; a lens of 50 mm"))
        << text;
}

// Of lamps and media; scattered light has a depth of 1 at least.
TEST(PbrtView, AMaximumDepthOf0ShowsEmissionOnly) {
  const SceneDescription scene = pbrt_scene(
      "Integrator \"volpath\" \"integer maxdepth\" 0\nWorldBegin Material \"conductor\"\n"
      "MakeNamedMedium \"fog\" \"string type\" \"homogeneous\" \"rgb sigma_a\" [1 1 1] \"rgb sigma_s\" "
      "[3 3 3] \"rgb Le\" [8 8 8]\n"
      "MediumInterface \"fog\" \"\" Shape \"sphere\"\n"
      "AreaLightSource \"diffuse\" \"rgb L\" [1 2 3]\n" +
      kPbrtTriangle);
  EXPECT_EQ(warnings_of(scene), "");
  for (const Material& material : scene.materials)
    EXPECT_EQ(std::get<Lambert>(material.model).albedo.value, Rgb{}) << material.name;
  const auto emits = [](const Material& m) { return m.emission.value == Rgb{1, 2, 3}; };
  EXPECT_EQ(std::count_if(scene.materials.begin(), scene.materials.end(), emits), 1);
  ASSERT_EQ(scene.media.size(), 1u);
  EXPECT_EQ(scene.media[0].sigma_a, Rgb::gray(4));
  EXPECT_EQ(scene.media[0].sigma_s, Rgb{});
  EXPECT_EQ(scene.media[0].emission, Rgb::gray(2));  // times the absorption as before
}

TEST(PbrtView, OtherCameras) {
  const SceneDescription flat = seen_by(
      "Camera \"orthographic\" \"float screenwindow\" [-2 2 -1 1]\n"
      "Film \"rgb\" \"integer xresolution\" 200 \"integer yresolution\" 100");
  EXPECT_EQ(flat.camera.type, CameraType::kOrthographic);
  EXPECT_FLOAT_EQ(flat.camera.view_height, 2);
  const SceneDescription around = seen_by("Camera \"spherical\" \"string mapping\" \"equirectangular\"");
  EXPECT_EQ(around.camera.type, CameraType::kPanoramic);
  EXPECT_EQ(warnings_of(around), "");
  EXPECT_THAT(warnings_of(seen_by("Camera \"realistic\" \"string lensfile\" \"a.dat\"")),
              HasSubstr("approximated by a perspective camera"));
}

TEST(PbrtView, TheSensorScalesAllLight) {
  const std::string world = "\nWorldBegin AttributeBegin AreaLightSource \"diffuse\" \"rgb L\" [1 2 3]\n" +
                            kPbrtTriangle + "AttributeEnd\nLightSource \"point\" \"rgb I\" [1 1 1]\n";
  const SceneDescription scene = pbrt_scene(
      "Camera \"perspective\" \"float shutteropen\" 0 \"float shutterclose\" 0.5 Film \"rgb\" \"float iso\" "
      "400" +
      world);
  EXPECT_EQ(scene.materials.at(0).emission.value, (Rgb{2, 4, 6}));
  EXPECT_EQ(std::get<PointLightDescription>(scene.lights.at(0)).intensity, Rgb::gray(2));
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(PbrtView, WhiteBalanceMakesItsWhiteGray) {
  const SceneDescription scene = pbrt_scene(
      "Film \"rgb\" \"float whitebalance\" 5003 WorldBegin\n"
      "LightSource \"infinite\" \"spectrum L\" \"stdillum-D50\" Shape \"sphere\"\n");
  const Rgb white = scene.environment->radiance.value;
  EXPECT_NEAR(white.r, 1, 0.01);
  EXPECT_NEAR(white.g, 1, 0.01);
  EXPECT_NEAR(white.b, 1, 0.01);
}

TEST(PbrtView, UnknownSettingsAreTold) {
  const std::string warnings =
      warnings_of(seen_by("Integrator \"ao\" PixelFilter \"mitchell\" Sampler \"halton\" \"float magic\" 1\n"
                          "Film \"gbuffer\" \"float maxcomponentvalue\" 10"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:1: the integrator 'ao' is not supported"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:1: the pixel filter 'mitchell' is not supported"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:1: the parameter 'magic' of the sampler is not supported"));
  EXPECT_THAT(warnings, HasSubstr("scene.pbrt:2: the film 'gbuffer' is not supported"));
  EXPECT_THAT(warnings,
              HasSubstr("scene.pbrt:2: the parameter 'maxcomponentvalue' of the film is not supported"));
}

}  // namespace
}  // namespace tessera::core::test
