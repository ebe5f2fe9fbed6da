// SPDX-License-Identifier: Apache-2.0
// Sensors, films, integrators and emitters of Mitsuba scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <numbers>

#include "core/lights/equirectangular.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/spectra/spectrum_color.hpp"
#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

SceneDescription with_sensor(const std::string& inside, const std::string& type = "perspective") {
  return scene_of("<sensor type=\"" + type + "\">" + inside + "</sensor>");
}

constexpr const char* kSquareFilm =
    "<film type=\"hdrfilm\"><integer name=\"width\" value=\"200\"/><integer name=\"height\" "
    "value=\"100\"/></film>";

TEST(MitsubaSensor, LooksAlongItsZ) {
  const CameraDescription camera =
      with_sensor(
          "<transform name=\"to_world\"><lookat origin=\"1,2,3\" target=\"1,2,8\" up=\"0,1,0\"/></transform>")
          .camera;
  EXPECT_EQ(camera.position, (Vec3{1, 2, 3}));
  EXPECT_EQ(camera.look_at, (Vec3{1, 2, 4}));
  EXPECT_EQ(camera.up, (Vec3{0, 1, 0}));
}

TEST(MitsubaSensor, FieldOfViewIsThatOfItsAxis) {
  const auto vertical = [](const std::string& parameters) {
    return with_sensor(parameters + kSquareFilm).camera.vertical_fov_degrees;
  };
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/>"), 2 * std::atan(0.5) * 180 / std::numbers::pi,
              1e-3);
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"y\"/>"), 90,
              1e-3);
  EXPECT_NEAR(vertical("<float name=\"fov\" value=\"90\"/><string name=\"fov_axis\" value=\"smaller\"/>"), 90,
              1e-3);
  // 50 mm: half of the diagonal of 36 x 24 mm, for an image that is twice as wide as high.
  const double tangent = std::sqrt(36.0 * 36 + 24 * 24) / 100 / std::sqrt(5.0);
  EXPECT_NEAR(vertical(""), 2 * std::atan(tangent) * 180 / std::numbers::pi, 1e-3);
}

TEST(MitsubaSensor, OrthographicCamerasHaveTheScaleOfTheirTransform) {
  const CameraDescription camera =
      with_sensor(
          std::string("<transform name=\"to_world\"><scale x=\"3\" y=\"3\"/></transform>") + kSquareFilm,
          "orthographic")
          .camera;
  EXPECT_EQ(camera.type, CameraType::kOrthographic);
  EXPECT_NEAR(camera.view_height, 3, 1e-6);
}

TEST(MitsubaSensor, ClippingPlanesThatCutTheSceneAreTold) {
  const auto told = [](const std::string& planes) {
    return warnings_of(with_sensor(
        "<transform name='to_world'><lookat origin='0,0,5' target='0,0,0' up='0,1,0'/></transform>" +
        planes));
  };
  EXPECT_EQ(told("<float name='near_clip' value='3'/><float name='far_clip' value='7'/>"), "");
  EXPECT_THAT(told("<float name='near_clip' value='4.5'/>"), HasSubstr("in front of 'near_clip'"));
  EXPECT_THAT(told("<float name='far_clip' value='5.5'/>"), HasSubstr("beyond 'far_clip'"));
}

// Its default is the far plane.
TEST(MitsubaSensor, ThinLensesFocusFarAwayUnlessTold) {
  const auto focus = [](const std::string& parameters) {
    return with_sensor("<float name='aperture_radius' value='0.5'/>" + parameters, "thinlens")
        .camera.focus_distance;
  };
  EXPECT_EQ(focus(""), 1e4f);
  EXPECT_EQ(focus("<float name='far_clip' value='50'/>"), 50);
  EXPECT_EQ(focus("<float name='focus_distance' value='3'/>"), 3);
}

TEST(MitsubaSensor, FilmAndSamplerBecomeSettings) {
  const RenderSettings settings =
      with_sensor(
          "<film type=\"hdrfilm\"><rfilter type=\"tent\"/><integer name=\"width\" value=\"20\"/>"
          "<integer name=\"height\" value=\"10\"/><integer name=\"crop_offset_x\" value=\"5\"/>"
          "<integer name=\"crop_width\" value=\"7\"/></film>"
          "<sampler type=\"independent\"><integer name=\"sample_count\" value=\"33\"/></sampler>")
          .settings;
  EXPECT_EQ(settings.spp, 33u);
  EXPECT_EQ(settings.filter, (PixelFilter{FilterKind::kTent, 1}));
  EXPECT_EQ(settings.crop, (PixelRect{5, 0, 12, 10}));
  EXPECT_EQ(with_sensor(kSquareFilm).settings.filter, (PixelFilter{FilterKind::kGaussian, 1.5f}));
}

TEST(MitsubaIntegrator, DepthCountsTheCamerasSegment) {
  const auto depth = [](const std::string& type, const std::string& written) {
    const std::string parameter =
        written.empty() ? "" : "<integer name=\"max_depth\" value=\"" + written + "\"/>";
    return scene_of("<integrator type=\"moment\"><integrator type=\"" + type + "\">" + parameter +
                    "</integrator></integrator>")
        .settings.max_depth;
  };
  EXPECT_EQ(depth("path", ""), 0);
  EXPECT_EQ(depth("path", "-1"), 0);
  EXPECT_EQ(depth("path", "2"), 1);
  EXPECT_EQ(depth("volpath", "6"), 5);
  EXPECT_EQ(depth("direct", ""), 1);
}

TEST(MitsubaIntegrator, IsTheInnermostOne) {
  for (const char* type : {"moment", "aov", "stokes", "unheard_of"}) {
    const SceneDescription scene = scene_of(std::string("<integrator type='") + type +
                                            "'><integrator type='path'><integer name='max_depth' value='2'/>"
                                            "<boolean name='hide_emitters' value='true'/></integrator>"
                                            "</integrator><emitter type='constant'/>");
    EXPECT_EQ(scene.settings.max_depth, 1) << type;
    EXPECT_FALSE(scene.environment->visible_to_camera) << type;
    if (type == std::string("moment"))
      EXPECT_EQ(warnings_of(scene), "");
    else
      EXPECT_THAT(warnings_of(scene), HasSubstr("without what this one adds")) << type;
  }
}

TEST(MitsubaIntegrator, HidesEmittersFromTheCamera) {
  for (const bool hides : {false, true}) {
    const SceneDescription scene = scene_of(
        std::string("<integrator type='path'><boolean name='hide_emitters' value='") +
        (hides ? "true" : "false") +
        "'/></integrator><emitter type='constant'/><shape type='sphere'><emitter type='area'/></shape>");
    EXPECT_EQ(warnings_of(scene), "");
    EXPECT_EQ(scene.environment->visible_to_camera, !hides);
    int hidden = 0;
    for (const Material& material : scene.materials) hidden += material.visible_to_camera ? 0 : 1;
    EXPECT_EQ(hidden, hides ? 1 : 0);
  }
}

TEST(MitsubaEmitter, MayHaveNoSurface) {
  const Material material = material_of("<bsdf type='null'/><emitter type='area'/>");
  EXPECT_TRUE(std::holds_alternative<Null>(material.model));
  EXPECT_EQ(material.emission.value, Rgb::gray(1));
}

TEST(MitsubaEmitter, MayStandBesideTheShapesThatReferToIt) {
  const SceneDescription scene = scene_of(
      "<shape type='sphere'><ref id='lamp'/></shape>"
      "<emitter type='area' id='lamp'><rgb name='radiance' value='3'/></emitter>");
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(scene.materials.at(0).emission.value, Rgb::gray(3));
}

TEST(MitsubaEmitter, MasksDoNotWeakenIt) {
  const auto masked = [](const std::string& opacity) {
    return material_of("<bsdf type='mask'>" + opacity +
                       "<bsdf type='diffuse'/></bsdf><emitter type='area'/>");
  };
  const Material half = masked("<float name='opacity' value='0.5'/>");
  EXPECT_EQ(half.opacity.value, 0.5f);
  EXPECT_EQ(half.emission.value, Rgb::gray(2));
  EXPECT_TRUE(std::holds_alternative<Null>(masked("<float name='opacity' value='0'/>").model));
}

TEST(MitsubaEmitter, LightsWithoutExtent) {
  const SceneDescription scene = scene_of(
      "<emitter type=\"point\"><transform name=\"to_world\"><translate z=\"2\"/></transform>"
      "<rgb name=\"intensity\" value=\"1 2 3\"/></emitter>"
      "<emitter type=\"spot\"><transform name=\"to_world\"><lookat origin=\"0,5,0\" "
      "target=\"0,0,0\"/></transform>"
      "<float name=\"cutoff_angle\" value=\"40\"/><float name=\"beam_width\" value=\"10\"/></emitter>"
      "<emitter type=\"directional\"><vector name=\"direction\" value=\"0,0,-1\"/>"
      "<float name=\"irradiance\" value=\"4\"/></emitter>");
  ASSERT_EQ(scene.lights.size(), 3u);
  const auto& point = std::get<PointLightDescription>(scene.lights[0]);
  EXPECT_EQ(point.position, (Vec3{0, 0, 2}));
  EXPECT_EQ(point.intensity, (Rgb{1, 2, 3}));
  const auto& spot = std::get<SpotLightDescription>(scene.lights[1]);
  EXPECT_EQ(spot.position, (Vec3{0, 5, 0}));
  EXPECT_EQ(spot.look_at, (Vec3{0, 4, 0}));
  EXPECT_EQ(spot.angle_degrees, 80);
  EXPECT_EQ(spot.softness, 0.75f);
  EXPECT_EQ(spot.falloff, lights::SpotFalloff::kLinear);
  EXPECT_LT(spot.image.texture, 0);
  const auto& sun = std::get<DirectionalLightDescription>(scene.lights[2]);
  EXPECT_EQ(sun.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(sun.irradiance, Rgb::gray(4));
}

TEST(MitsubaEmitter, SpotsAndProjectorsShowImages) {
  const std::string bitmap = "type=\"bitmap\"><string name=\"filename\" value=\"slide.hdr\"/></texture>";
  const SceneDescription scene = scene_of(
      "<emitter type=\"spot\"><float name=\"cutoff_angle\" value=\"45\"/><texture name=\"texture\" " +
          bitmap +
          "</emitter><emitter type=\"projector\"><float name=\"fov\" value=\"90\"/>"
          "<float name=\"scale\" value=\"2\"/><texture name=\"irradiance\" " +
          bitmap + "</emitter>",
      {{"slide.hdr", hdr(one_color(4, 2, Rgb::gray(0.5f)))}});
  const auto& spot = std::get<SpotLightDescription>(scene.lights.at(0));
  EXPECT_GE(spot.image.texture, 0);
  EXPECT_NEAR(spot.image.right.x, 1, 1e-5f);
  EXPECT_NEAR(spot.image.up.y, 1, 1e-5f);
  EXPECT_FALSE(spot.image.flat_field);
  const auto& projector = std::get<SpotLightDescription>(scene.lights.at(1));
  EXPECT_NEAR(projector.image.right.x, -1, 1e-5f);
  EXPECT_NEAR(projector.image.up.y, -0.5f, 1e-5f);
  EXPECT_TRUE(projector.image.flat_field);
  EXPECT_NEAR(projector.intensity.g, 2 * kPi, 1e-4f);
  EXPECT_EQ(projector.softness, 0);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(MitsubaEmitter, ProjectorsOfFlatImagesAreLeftOut) {
  const SceneDescription scene = scene_of(
      "<emitter type=\"projector\"><transform name=\"to_world\"><scale x=\"0\"/></transform></emitter>");
  EXPECT_TRUE(scene.lights.empty());
  EXPECT_THAT(warnings_of(scene), HasSubstr("flattens its image; it is left out"));
}

TEST(MitsubaEmitter, EnvironmentMapsHaveTheirEdgeAtMinusZ) {
  const SceneDescription scene = scene_of(
      "<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.hdr\"/>"
      "<float name=\"scale\" value=\"2\"/></emitter>",
      {{"sky.hdr", hdr(one_color(8, 4, Rgb::gray(1)))}});
  ASSERT_TRUE(scene.environment);
  EXPECT_EQ(scene.environment->radiance.value, Rgb::gray(2));
  const lights::EquirectangularMap map(scene.environment->rotation_degrees);
  EXPECT_NEAR(map.uv_of(Vec3{1, 0, -1e-3f}).x, 0.25, 1e-3);
  EXPECT_NEAR(map.uv_of(Vec3{0, 0, 1}).x, 0.5, 1e-3);
}

// Of three rows, the middle one is the horizon, and the others are the poles.
TEST(MitsubaEmitter, RowsOfEnvironmentMapsGoFromPoleToPole) {
  Image sky(4, 3);
  for (std::size_t x = 0; x < 4; ++x) sky.pixels[4 + x] = Rgb::gray(1);
  const SceneDescription scene =
      scene_of("<emitter type=\"envmap\"><string name=\"filename\" value=\"sky.hdr\"/></emitter>",
               {{"sky.hdr", hdr(sky)}});
  const TextureImage& image = *scene.textures.at(0).image;
  ASSERT_EQ(image.height(), 16);
  for (int y = 0; y < 16; ++y) {
    const int from_pole = std::min(y, 15 - y);
    EXPECT_EQ(image.texel(1, y).g, (static_cast<float>(from_pole) + 0.5f) / 8) << y;
  }
}

TEST(MitsubaEmitter, SamplesAreIntegratedWithoutAnIlluminant) {
  const auto intensity = [](const std::string& samples) {
    const SceneDescription scene = scene_of("<emitter type=\"point\"><spectrum name=\"intensity\" value=\"" +
                                            samples + "\"/></emitter>");
    return std::get<PointLightDescription>(scene.lights.at(0)).intensity;
  };
  // Light of equal energy is redder than D65, the white of Rec. 709, and has the luminance 1.
  const Rgb equal = intensity("360:1, 830:1");
  EXPECT_NEAR(luminance(equal), 1, 2e-3);
  EXPECT_NEAR(equal.r, 1.2048, 2e-3);
  EXPECT_NEAR(equal.g, 0.9483, 2e-3);
  EXPECT_NEAR(equal.b, 0.9087, 2e-3);
  EXPECT_EQ(intensity("830:1, 360:1"), equal);
  const Rgb uniform = intensity("2");
  EXPECT_NEAR(uniform.r, 2 * equal.r, 4e-3);
  EXPECT_NEAR(uniform.b, 2 * equal.b, 4e-3);
}

TEST(MitsubaEmitter, NumbersAndColorsOfLightAreAsWritten) {
  const auto radiance = [](const std::string& inside) {
    return scene_of("<emitter type='constant'>" + inside + "</emitter>").environment->radiance.value;
  };
  EXPECT_EQ(radiance("<float name='radiance' value='2'/>"), Rgb::gray(2));
  EXPECT_EQ(radiance("<rgb name='radiance' value='2'/>"), Rgb::gray(2));
  EXPECT_EQ(radiance("<spectrum name='radiance' type='uniform'><float name='value' value='2'/></spectrum>"),
            Rgb::gray(2));
}

TEST(MitsubaEmitter, SpectraArePlugins) {
  const auto intensity = [](const std::string& inside) {
    const SceneDescription scene =
        scene_of("<emitter type='point'><spectrum name='intensity' " + inside + "</emitter>");
    return std::get<PointLightDescription>(scene.lights.at(0)).intensity;
  };
  const Rgb samples = intensity("value='400:1, 500:3, 600:2'/>");
  EXPECT_EQ(intensity("type='irregular'><string name='wavelengths' value='400, 500, 600'/>"
                      "<string name='values' value='1, 3, 2'/></spectrum>"),
            samples);
  EXPECT_EQ(
      intensity("type='regular'><float name='wavelength_min' value='400'/>"
                "<float name='wavelength_max' value='600'/><string name='values' value='1 3 2'/></spectrum>"),
      samples);
  EXPECT_EQ(intensity("type='regular'><string name='range' value='400, 600'/>"
                      "<string name='values' value='1 3 2'/></spectrum>"),
            samples);
  const SceneDescription broken = scene_of(
      "<emitter type='point'><spectrum name='intensity' type='irregular'>"
      "<string name='wavelengths' value='500, 400'/><string name='values' value='1, "
      "2'/></spectrum></emitter>");
  EXPECT_THAT(warnings_of(broken), HasSubstr("has no samples at growing wavelengths"));
}

// Planck's law at the wavelength of the eye's mean, about 570 nm, where the spectrum is even.
TEST(MitsubaEmitter, BlackBodiesHaveTheirPower) {
  const SceneDescription scene = scene_of(
      "<emitter type='point'><spectrum name='intensity' type='blackbody'>"
      "<float name='temperature' value='5000'/></spectrum></emitter>");
  const Rgb intensity = std::get<PointLightDescription>(scene.lights.at(0)).intensity;
  const double power =
      1e-9 * 1.191043e-16 / (std::pow(570e-9, 5) * std::expm1(1.438777e-2 / (570e-9 * 5000)));
  EXPECT_NEAR(luminance(intensity) / power, 1, 0.02);
  const Rgb color = spectra::blackbody_color(5000);
  EXPECT_NEAR(intensity.r / luminance(intensity), color.r, 2e-3);
  EXPECT_NEAR(intensity.b / luminance(intensity), color.b, 2e-3);
}

// Public scenes, where they are.
TEST(MitsubaCollection, RegressionTestsLoad) {
  const std::string folder = TESSERA_SOURCE_DIR "/../shared/data/scenes/mitsuba/tests/scenes/";
  for (const char* name :
       {"instancing/test_instancing_path.xml", "orthographic_sensor/test_orthographic_path.xml",
        "mesh_attributes/test_mesh_attributes_1_face_direct.xml",
        "participating_media/test_hetero_sigmat_volpath.xml"}) {
    if (!std::filesystem::exists(folder + name)) GTEST_SKIP() << folder << " is not here";
    const auto scene = load_scene_file(folder + name);
    EXPECT_TRUE(scene) << name << ": " << scene.error().message;
  }
}

TEST(MitsubaScene, IsSeenByTheChosenSensor) {
  const std::string sensors =
      "<sensor type='perspective' id='left'><transform name='to_world'><translate "
      "x='-3'/></transform></sensor>"
      "<sensor type='perspective' id='right'><transform name='to_world'><translate "
      "x='3'/></transform></sensor>";
  const auto position_by = [&](const std::string& camera) {
    MemoryAssets files(MemoryAssets::Files{{"scene.xml", xml_scene(sensors)}});
    OverriddenAssets assets(files, "scene.xml", {select_by_name("camera", camera)});
    const auto scene = load_scene(assets, "scene.xml", "scene.xml");
    return scene ? fmt::format("{}", scene->camera.position.x) : scene.error().message;
  };
  EXPECT_EQ(position_by("left"), "-3");
  EXPECT_EQ(position_by("1"), "3");
  EXPECT_EQ(position_by("top"), "scene.xml: there is no camera 'top'; the file has 0 ('left'), 1 ('right')");
  const SceneDescription scene = scene_of(sensors);
  EXPECT_EQ(scene.camera.position.x, -3);
  EXPECT_EQ(scene.contents.cameras, (std::vector<std::string>{"left", "right"}));
}

std::string animation(const std::string& from, const std::string& to) {
  return "<animation name=\"to_world\"><transform time=\"1\">" + from + "</transform><transform time=\"3\">" +
         to + "</transform></animation>";
}

// The shutter opens at frame 0, and each unit of time has a frame.
TEST(MitsubaMotion, OfInstancesIsSeenWhileTheShutterIsOpen) {
  const SceneDescription scene = scene_of(
      "<sensor type=\"perspective\"><float name=\"shutter_open\" value=\"1\"/>"
      "<float name=\"shutter_close\" value=\"1.5\"/></sensor>"
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/>" +
      animation("<scale value=\"2\"/>",
                "<scale value=\"4\"/><rotate z=\"1\" angle=\"90\"/><translate x=\"6\"/>") +
      "</shape>");
  EXPECT_EQ(warnings_of(scene), "");
  EXPECT_EQ(scene.camera.shutter_open, 0);
  EXPECT_EQ(scene.camera.shutter_close, 0.5f);
  ASSERT_EQ(scene.animation.instances.size(), 1u);
  const auto& steps = scene.animation.instances[0].steps;
  const auto near = [&](float frame, Vec3 p, Vec3 expected) {
    EXPECT_LT(length(transform_at(steps, frame).point(p) - expected), 1e-5f) << frame;
  };
  near(0, {1, 0, 0}, {2, 0, 0});
  near(1, {1, 0, 0}, {3 + 3 * 0.70710678f, 3 * 0.70710678f, 0});
  near(2, {1, 0, 0}, {6, 4, 0});
  near(9, {1, 0, 0}, {6, 4, 0});
}

// Mitsuba's instances have a parameter of this name, too.
TEST(MitsubaMotion, OfInstancesMayBeCalledAnimation) {
  const SceneDescription scene = scene_of(
      "<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/></shape>"
      "<shape type=\"instance\"><ref id=\"g\"/><animation name=\"animation\"><transform time=\"0\">"
      "<translate x=\"-2\"/></transform><transform time=\"1\"><translate x=\"2\"/></transform></animation>"
      "</shape>");
  EXPECT_EQ(warnings_of(scene), "");
  ASSERT_EQ(scene.animation.instances.size(), 1u);
  EXPECT_LT(length(transform_at(scene.animation.instances[0].steps, 0.75f).origin - Vec3{1, 0, 0}), 1e-5f);
}

TEST(MitsubaMotion, OfTheSensorIsThatOfTheCamera) {
  const SceneDescription scene =
      scene_of("<sensor type=\"perspective\"><float name=\"shutter_close\" value=\"2\"/>" +
               animation("<translate z=\"-5\"/>", "<translate x=\"2\" z=\"-5\"/>") + "</sensor>");
  EXPECT_EQ(warnings_of(scene), "");
  const CameraDescription at = camera_at(scene.camera, scene.animation.camera, 2);
  EXPECT_LT(length(at.position - Vec3{1, 0, -5}), 1e-5f);
  EXPECT_LT(length(normalize(at.look_at - at.position) - Vec3{0, 0, 1}), 1e-5f);
  EXPECT_EQ(scene.camera.shutter_close, 2);
}

// From frame 0 to 2, with 1 at the start of the first keyframe's frame.
TEST(MitsubaMotion, OfLightsIsManyLights) {
  const SceneDescription scene = scene_of(
      "<sensor type=\"perspective\"><float name=\"shutter_open\" value=\"1\"/><float name=\"shutter_close\" "
      "value=\"3\"/></sensor><emitter type=\"spot\"><rgb name=\"intensity\" value=\"32 64 96\"/>" +
      animation("<translate x=\"0\"/>", "<translate x=\"32\"/>") + "</emitter>");
  EXPECT_NE(warnings_of(scene).find("moves; 32 lights along its way replace it"), std::string::npos);
  ASSERT_EQ(scene.lights.size(), 32u);
  for (std::size_t i = 0; i < 32; ++i) {
    const auto& light = std::get<SpotLightDescription>(scene.lights[i]);
    EXPECT_NEAR(light.position.x, static_cast<float>(i) + 0.5f, 1e-4f);
    EXPECT_EQ(light.intensity, (Rgb{1, 2, 3}));
  }
}

TEST(MitsubaMotion, OfEnvironmentsAndByWrongKeyframesIsTold) {
  const SceneDescription scene =
      scene_of("<emitter type=\"directional\">" + animation("<translate x=\"1\"/>", "<translate x=\"2\"/>") +
               "</emitter><emitter type=\"point\"><animation name=\"to_world\"><transform time=\"2\"/>"
               "<transform time=\"1\"/><transform/></animation></emitter>");
  EXPECT_NE(warnings_of(scene).find("does not move; the first keyframe of 'to_world' counts"),
            std::string::npos);
  EXPECT_NE(warnings_of(scene).find(
                "a keyframe needs a 'time' after that of the one before; it is left out (2 times)"),
            std::string::npos)
      << warnings_of(scene);
}

}  // namespace
}  // namespace tessera::core::test
