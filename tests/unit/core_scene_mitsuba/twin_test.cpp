// SPDX-License-Identifier: Apache-2.0
// A Mitsuba scene renders to the same bytes as the same scene in Tessera's own format.
#include <vector>

#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

constexpr const char* kXml = R"(<scene version="3.0.0">
  <integrator type="path"><integer name="max_depth" value="6"/></integrator>
  <sensor type="perspective">
    <float name="fov" value="40"/><string name="fov_axis" value="y"/>
    <transform name="to_world"><lookat origin="0, 0, 5" target="0, 0, 4" up="0, 1, 0"/></transform>
    <film type="hdrfilm"><integer name="width" value="16"/><integer name="height" value="12"/><rfilter type="box"/></film>
    <sampler type="independent"><integer name="sample_count" value="4"/></sampler>
  </sensor>
  <emitter type="constant"><rgb name="radiance" value="0.5 0.6 0.7"/></emitter>
  <emitter type="point"><point name="position" x="2" y="3" z="4"/><rgb name="intensity" value="20"/></emitter>
  <bsdf type="twosided" id="clay"><bsdf type="diffuse"><rgb name="reflectance" value="0.7 0.3 0.2"/></bsdf></bsdf>
  <shape type="sphere"><point name="center" x="-1" y="0" z="0"/><ref id="clay"/></shape>
  <shape type="sphere"><point name="center" x="1" y="0" z="0"/>
    <bsdf type="dielectric"><float name="int_ior" value="1.5"/><float name="ext_ior" value="1"/></bsdf></shape>
  <shape type="disk"><transform name="to_world"><scale value="4"/><translate z="-2"/></transform><ref id="clay"/></shape>
</scene>)";

constexpr const char* kTwin = R"({
  "render": { "width": 16, "height": 12, "spp": 4, "max_depth": 5 },
  "camera": { "position": [0, 0, 5], "look_at": [0, 0, 4], "vertical_fov_degrees": 40 },
  "environment": { "radiance": [0.5, 0.6, 0.7] },
  "lights": [ { "type": "point", "position": [2, 3, 4], "intensity": 20 } ],
  "materials": { 
    "clay": { "type": "lambert", "albedo": [0.7, 0.3, 0.2], "shading_normals": "plain" },
    "glass": { "type": "glass", "shading_normals": "plain" } },
  "shapes": [
    { "type": "sphere", "center": [-1, 0, 0], "radius": 1, "material": "clay" },
    { "type": "sphere", "center": [1, 0, 0], "radius": 1, "material": "glass" },
    { "type": "disk", "center": [0, 0, -2], "radius": 4, "normal": [0, 0, 1], "material": "clay" }
  ]
})";

std::vector<std::uint64_t> rendered(Result<SceneDescription> description) {
  EXPECT_TRUE(description) << description.error().message;
  if (!description) return {};
  EXPECT_NEAR(description->camera.vertical_fov_degrees, 40, 1e-4);
  description->camera.vertical_fov_degrees = 40;  // converted by way of its tangent, which rounds
  const auto scene = Scene::build(std::move(*description), 1);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene) return {};
  return render(integrators::prepare(*scene, scene->settings(), 1), PixelRect{0, 0, 16, 12},
                SampleRange{0, 4}, 1)
      .sums;
}

TEST(MitsubaTwin, RendersToTheSameBytes) {
  const auto of_xml = rendered(load_xml(kXml)), of_json = rendered(load(kTwin));
  ASSERT_FALSE(of_xml.empty());
  EXPECT_EQ(of_xml, of_json);
}

}  // namespace
}  // namespace tessera::core::test
