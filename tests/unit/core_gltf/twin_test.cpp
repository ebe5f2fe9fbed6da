// SPDX-License-Identifier: Apache-2.0
// glTF files against the same scene in our own format: the images have the same bytes.
#include <gtest/gtest.h>

#include <algorithm>

#include "core/integrators/render.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

FilmTile small_image(Result<SceneDescription> description) {
  EXPECT_TRUE(description) << description.error().message;
  const auto scene = Scene::build(std::move(*description), 1);
  EXPECT_TRUE(scene) << scene.error().message;
  return render(integrators::prepare(*scene, scene->settings(), 1), {400, 280, 424, 296}, {0, 4}, 1);
}

// A textured, half metallic triangle that a node mirrors and turns, seen by a camera in front of it.
GltfFile gltf_scene() {
  GltfFile file;
  file.json["materials"] = {{{"pbrMetallicRoughness",
                              {{"baseColorTexture", {{"index", 0}}},
                               {"baseColorFactor", {1, 0.5, 0.25, 1}},
                               {"metallicFactor", 0.5},
                               {"roughnessFactor", 0.25}}}}};
  file.json["images"] = {{{"uri", "image.png"}}};
  file.json["samplers"] = {{{"wrapS", 33071}, {"wrapT", 33648}}};
  file.json["textures"] = {{{"source", 0}, {"sampler", 0}}};
  file.node({{"mesh", file.triangle(0)}, {"scale", {-2, 1, 1}}, {"translation", {1, 0, 0}}});
  file.json["cameras"] = {{{"type", "orthographic"}, {"orthographic", {{"xmag", 1.5}, {"ymag", 1}}}}};
  file.node({{"camera", 0}, {"translation", {0, 0.5, 4}}});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}, {"intensity", 5}}};
  file.node({{"translation", {0, 1, 3}}, {"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  return file;
}

constexpr const char* kOwnScene = R"({
  "render": { "width": 768, "height": 512 },
  "camera": { "type": "orthographic", "view_height": 2, "position": [0, 0.5, 4], "look_at": [0, 0.5, 0] },
  "textures": { "image": { "file": "image.png", "wrap": "clamp", "wrap_v": "mirror" } },
  "materials": { "paint": { "type": "principled", "base_color": { "texture": "image", "tint": [1, 0.5, 0.25] },
                            "base_metalness": 0.5, "specular_roughness": 0.25 } },
  "shapes": [ { "type": "mesh", "file": "triangle.obj", "normals": "flat", "material": "paint",
                "transform": [ { "scale": [-2, 1, 1] }, { "translate": [1, 0, 0] } ] } ],
  "lights": [ { "type": "point", "position": [0, 1, 3], "intensity": 5 } ]
})";

TEST(GltfTwin, HasTheSameBytes) {
  const std::string image = png(one_color(2, 2, {0.25f, 0.5f, 0.75f}));
  // The triangle of GltfFile, with v upwards.
  const std::string obj = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 1\nvt 1 1\nvt 0 0\nf 1/1 2/2 3/3\n";
  const FilmTile imported = small_image(load_gltf(gltf_scene().text(), {{"image.png", image}}));
  const FilmTile own = small_image(load(kOwnScene, {{"image.png", image}, {"triangle.obj", obj}}));
  EXPECT_EQ(imported.sums, own.sums);
  EXPECT_TRUE(std::any_of(own.sums.begin(), own.sums.end(), [](auto sum) { return sum > 0; }));
}

}  // namespace
}  // namespace tessera::core::test
