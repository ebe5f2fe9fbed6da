// SPDX-License-Identifier: Apache-2.0
// The materials that meshes get from the MTL files that their OBJ files name.
#include <gtest/gtest.h>

#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::mesh_materials_test {
namespace {

using test::load_valid;
using test::MemoryAssets;
using test::scene_with;

const std::string kTwoMaterialsObj =
    "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl red\nf 1 2 3\nusemtl wood\nf 1 3 2\nusemtl "
    "red\nf 2 4 3\n";

TEST(MeshMaterials, TakesMaterialsFromMtlFiles) {
  const MemoryAssets::Files files{
      {"models/a.obj", kTwoMaterialsObj},
      {"models/a.mtl", "newmtl wood\nmap_Kd maps/wood.png\nnewmtl red\nKd 1 0 0\nKe 5 5 5\n"},
      {"models/maps/wood.png", test::png(test::one_color(1, 1, Rgb::gray(1)))}};
  const std::string shape = "{\"type\": \"mesh\", \"file\": \"models/a.obj\"}";
  const SceneDescription scene = load_valid(scene_with("", "", shape + "," + shape), files);
  ASSERT_EQ(scene.materials.size(), 3u);  // not twice for two shapes
  EXPECT_EQ(scene.materials[1].name, "models/a.mtl: red");
  EXPECT_EQ(scene.materials[1].emission.value, Rgb::gray(5));
  EXPECT_EQ(std::get<Lambert>(scene.materials[2].model).albedo.texture, 0);
  ASSERT_EQ(scene.textures.size(), 1u);
  for (const int i : {0, 1})
    EXPECT_EQ(std::get<MeshDescription>(scene.shapes[static_cast<std::size_t>(i)]).triangle_materials,
              (std::vector<std::uint32_t>{1, 2, 1}));
}

TEST(MeshMaterials, PrefersTheMaterialOfTheShapeAndThenNeedsNoMtlFile) {
  const SceneDescription scene =
      load_valid(scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\", \"material\": \"light\"}"),
                 {{"a.obj", kTwoMaterialsObj}});
  EXPECT_EQ(std::get<MeshDescription>(scene.shapes[0]).triangle_materials, (std::vector<std::uint32_t>{0}));
}

TEST(MeshMaterials, TakesACommentForPartOfANameOnlyWhereThatNameExists) {
  const auto material_of = [](const std::string& usemtl, const std::string& mtl) {
    const SceneDescription scene = load_valid(
        scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"),
        {{"a.obj", "mtllib a.mtl # materials\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl " + usemtl + "\nf 1 2 3\n"},
         {"a.mtl", mtl}});
    const auto& mesh = std::get<MeshDescription>(scene.shapes[0]);
    return scene.materials[mesh.triangle_materials[0]].name;
  };
  EXPECT_EQ(material_of("red # brick", "newmtl red\n"), "a.mtl: red");
  EXPECT_EQ(material_of("red", "newmtl red # brick\n"), "a.mtl: red # brick");
  EXPECT_EQ(material_of("red # a", "newmtl red # b\n"), "a.mtl: red # b");
  EXPECT_EQ(material_of("Material #2", "newmtl Material #1\nnewmtl Material #2\nnewmtl Material\n"),
            "a.mtl: Material #2");
  EXPECT_EQ(material_of("Material", "newmtl Material #1\nnewmtl Material\n"), "a.mtl: Material");
}

TEST(MeshMaterials, PutsMapsOnTheMattPartOfMaterialsWithHighlights) {
  const SceneDescription scene =
      load_valid(scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"),
                 {{"a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl m\nf 1 2 3\n"},
                  {"a.mtl", "newmtl m\nillum 2\nNs 50\nKs 0.25\nmap_Kd gray.png\n"}});
  const auto& mesh = std::get<MeshDescription>(scene.shapes[0]);
  const auto& model = std::get<CookTorrance>(scene.materials[mesh.triangle_materials[0]].model);
  EXPECT_EQ(model.diffuse.texture, 0);
  EXPECT_EQ(model.f0.texture, -1);
}

SceneDescription with_material(const std::string& mtl, MemoryAssets::Files files = {}) {
  files.emplace("a.obj", "mtllib a.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nusemtl m\nf 1/1 2/1 3/1\n");
  files.emplace("a.mtl", "newmtl m\n" + mtl);
  return load_valid(scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"), files);
}

TEST(MeshMaterials, KeepsTheTexelsOfPhysicallyBasedMaps) {
  const SceneDescription scene =
      with_material("Kd 0.5\nmap_Pr gray.png\nmap_Pm gray.png\nmap_Ps gray.png\nmap_Pc gray.png\n");
  const auto& model = std::get<Principled>(scene.materials.back().model);
  for (const ScalarParameter& parameter :
       {model.specular_roughness, model.base_metalness, model.coat_weight, model.fuzz_weight}) {
    ASSERT_GE(parameter.texture, 0);
    const Texture& texture = scene.textures.at(static_cast<std::size_t>(parameter.texture));
    EXPECT_EQ(texture.image->color_space(), ColorSpace::kLinear);
  }
  EXPECT_TRUE(scene.warnings.empty());
}

// As packed images of games have them.
TEST(MeshMaterials, TakesTheChannelThatTheFileNames) {
  const Image packed = test::one_color(1, 1, {0.25f, 0.5f, 1});
  const SceneDescription scene =
      with_material("Kd 0.5\nmap_Pr -imfchan g p.hdr\nmap_Pm -imfchan b p.hdr\nmap_d -imfchan r p.hdr\n",
                    {{"p.hdr", test::hdr(packed)}});
  const Material& material = scene.materials.back();
  const auto& model = std::get<Principled>(material.model);
  const auto value = [&](const ScalarParameter& parameter) {
    return scene.textures.at(static_cast<std::size_t>(parameter.texture)).image->texel(0, 0).r;
  };
  EXPECT_NEAR(value(model.specular_roughness), 0.5f, 0.01f);
  EXPECT_NEAR(value(model.base_metalness), 1, 0.01f);
  EXPECT_NEAR(value(material.opacity), 0.25f, 0.01f);
}

TEST(MeshMaterials, ClampsReflectancesAboveOne) {
  Image bright = test::one_color(3, 1, Rgb::gray(0.5f));
  bright.at(1, 0) = {4, 0.25f, 0};
  bright.at(2, 0) = {0, 0, 2};
  for (const std::string map : {"map_Kd", "map_Ks"}) {
    const SceneDescription scene =
        with_material("Kd 1\nKs 1\nNs 250\n" + map + " b.hdr\n", {{"b.hdr", test::hdr(bright)}});
    ASSERT_EQ(scene.textures.size(), 1u);
    const TextureImage& image = *scene.textures[0].image;
    EXPECT_NEAR(image.texel(0, 0).g, 0.5f, 0.01f);
    EXPECT_EQ(image.texel(1, 0).r, 1);
    EXPECT_NEAR(image.texel(1, 0).g, 0.25f, 0.02f);
    EXPECT_EQ(image.texel(2, 0).b, 1);
    EXPECT_EQ(scene.warnings, std::vector<std::string>{
                                  "a.mtl:5: 'b.hdr' has values above 1, and nothing reflects more light than "
                                  "it gets; they are clamped (2 texels)"});
  }
}

TEST(MeshMaterials, TellsWhatHasNoEffect) {
  using Strings = std::vector<std::string>;
  EXPECT_EQ(with_material("Kd 0.5\nTf 0.5\nillum 2\n").warnings,
            Strings{"a.mtl: 'Tf' is used for materials that transmit light only"});
  EXPECT_TRUE(with_material("Kd 0.5\nPr 0.5\nTf 0.5\nillum 2\n").warnings.empty());
}

TEST(MeshMaterials, FindsMapsWhoseNamesHaveSpacesAndMarks) {
  const std::string image = test::png(test::one_color(1, 1, Rgb::gray(1)));
  for (const std::string name : {"red brick #2.png", "my maps\\red.png", "\"a b.png\"", "2.png # old"}) {
    const auto scene =
        test::load(scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"),
                   {{"a.obj", "mtllib sub\\a.mtl\r\nv 0 0 0\r\nv 1 0 0\r\nv 0 1 0\r\nusemtl m\r\nf 1 2 3"},
                    {"sub/a.mtl", "newmtl m\r\nmap_Kd " + name + "\r\n"},
                    {"sub/red brick #2.png", image},
                    {"sub/my maps/red.png", image},
                    {"sub/a b.png", image},
                    {"sub/2.png", image}});
    EXPECT_TRUE(scene.has_value()) << name << ": " << scene.error().message;
  }
}

TEST(MeshMaterials, TakesSeveralLibrariesFromOneLine) {
  const SceneDescription scene =
      load_valid(scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"),
                 {{"a.obj", "mtllib one.mtl two.mtl\nv 0 0 0\nv 1 0 0\nv 0 1 0\nusemtl b\nf 1 2 3\n"},
                  {"one.mtl", "newmtl a\nKd 1 0 0\n"},
                  {"two.mtl", "newmtl b\nKd 0 1 0\n"}});
  const auto& mesh = std::get<MeshDescription>(scene.shapes[0]);
  EXPECT_EQ(scene.materials[mesh.triangle_materials[0]].name, "two.mtl: b");
}

}  // namespace
}  // namespace tessera::core::mesh_materials_test
