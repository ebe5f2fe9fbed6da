// SPDX-License-Identifier: Apache-2.0
// Damaged files must be refused or read, and nothing else: no crash, no exception, no endless loop. (The
// sanitizer build gives this its teeth.)
#include <gtest/gtest.h>

#include <algorithm>
#include <random>

#include "core/scene/loader/mesh_builder.hpp"
#include "core/scene/loader/mtl_material.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/validation.hpp"
#include "tests/support/effort.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

constexpr int kMutants = 2000 / static_cast<int>(tessera::test::kEffortDivisor);

// Cuts, removes, repeats or replaces a piece of `text`, once to four times.
std::string mutate(std::string text, std::mt19937& random) {
  constexpr std::string_view kPieces[] = {"0",
                                          "-1",
                                          "1e999",
                                          "nan",
                                          "[",
                                          "]",
                                          "{",
                                          "}",
                                          "\"",
                                          ",",
                                          ":",
                                          "\n",
                                          "\r",
                                          "/",
                                          "//",
                                          "f ",
                                          "v ",
                                          "\\",
                                          "#",
                                          "18446744073709551616",
                                          "-9223372036854775808",
                                          "\xff",
                                          " ",
                                          "1e-400",
                                          "null",
                                          "[[[[",
                                          "usemtl ",
                                          "\\\n",
                                          " # ",
                                          "s off\n",
                                          "s 1\n",
                                          "vt ",
                                          "vn ",
                                          "newmtl ",
                                          "map_Kd -s 2 ",
                                          "-o ",
                                          "-clamp ",
                                          "mtllib x",
                                          "f -1 -1 -1\n"};
  for (auto changes = 1 + random() % 4; changes > 0; --changes) {
    const std::size_t at = text.empty() ? 0 : random() % text.size(), length = random() % 12;
    switch (random() % 5) {
      case 0:
        text.resize(at);
        break;
      case 1:
        text.erase(at, length);
        break;
      case 2:
        text.insert(at, text.substr(at, length));
        break;
      case 3:
        text.insert(at, kPieces[random() % std::size(kPieces)]);
        break;
      default:
        if (!text.empty()) text[at] = static_cast<char>(random());
    }
  }
  return text;
}

// Either a value, or an error that says something.
template <typename T>
void expect_answer(const Result<T>& result, const std::string& input) {
  EXPECT_TRUE(result || !result.error().message.empty()) << input;
}

const std::string kObj =
    "# a roof\nmtllib roof.mtl\nv 0 0 0\nv 2 0 0\nv 2 2 0\nv 0 2 0\nv 1 1 1.5\nvt 0 0\nvt 1 0\nvt 1 1\nvt "
    "0.5 0.5\nvn 0 0 1\n"
    "vn 0.6 0 0.8\nusemtl tiles\nf 1/1/1 2/2/1 5/4/2\nf 2/1/1 3/2/1 -1/-1/-1\ng side\nusemtl wood\nf 3//1 "
    "4//2 5//1\nf 4 1 5\n"
    "s off\nf 4 3 2 1 # floor\ns 1\nf 1 \\\n 5 2 3 4\nf 4 3 2 1\n";
const std::string kMtl =
    "newmtl tiles\nKd 0.6 0.2 0.1\nKe 1 1 1\nillum 2\nnewmtl wood\nKd 0.5 0.4 0.3\nmap_Kd -s 2 2 1 "
    "-o .5 -mm 0 1 -clamp on gray.png # old\nNi 1.45\nd -halo 1.0\n";
const std::string kScene = test::scene_with(
    "\"render\": {\"width\": 64, \"height\": 48, \"spp\": 16, \"seed\": 7, \"integrator\": \"mis\"},"
    "\"objects\": {\"hut\": {\"shapes\": [{\"type\": \"mesh\", \"file\": \"roof.obj\", \"material\": "
    "\"g\"}]}},"
    "\"textures\": {\"t\": {\"file\": \"gray.png\", \"wrap\": \"clamp\", \"scale\": [2, 2]},"
    "\"sky\": {\"file\": \"gray.png\"}},"
    "\"lights\": [{\"type\": \"point\", \"position\": [1, 2, 3], \"intensity\": [4, 5, 6]},"
    "{\"type\": \"spot\", \"position\": [0, 4, 0], \"look_at\": [0, 0, 0], \"intensity\": 9, "
    "\"angle_degrees\": 60, \"softness\": 0.5},"
    "{\"type\": \"directional\", \"direction\": [0, -1, 0], \"irradiance\": 2}],"
    "\"environment\": {\"radiance\": [1, 2, 3], \"texture\": \"sky\", \"rotation_degrees\": 45, "
    "\"visible_to_camera\": false, \"orientation\": [{\"rotate\": {\"axis\": [1, 0, 0], \"degrees\": 30}}]}",
    "\"a\": {\"type\": \"lambert\", \"albedo\": {\"texture\": \"t\", \"tint\": 0.5}, "
    "\"emission\": {\"texture\": \"t\", \"tint\": 5}}, // comment\n"
    "\"g\": {\"type\": \"glass\", \"ior\": 1.5, \"transmittance\": [1, 0.9, 0.8], \"fresnel\": \"none\", "
    "\"roughness\": {\"texture\": \"t\", \"scale\": 0.4}},\n"
    "\"b\": {\"type\": \"principled\", \"coat_roughness_anisotropy\": 0.5, "
    "\"geometry_tangent\": {\"texture\": \"t\"}, \"geometry_tangent_rotation\": 0.25},\n"
    "\"p\": {\"type\": \"phong\", \"diffuse\": 0.4, \"specular\": 0.5, \"exponent\": 9, \"lobe\": \"n+2\"},\n"
    "\"c\": {\"type\": \"cook_torrance\", \"conductor\": \"gold\", \"sampling\": \"half_vector\", "
    "\"normal_map\": {\"texture\": \"t\", \"strength\": 2}, \"bump\": {\"texture\": \"t\", \"height\": 0.1}, "
    "\"opacity\": {\"texture\": \"t\", \"scale\": 0.5}}",
    "{\"type\": \"mesh\", \"file\": \"roof.obj\", \"normals\": \"smooth\", \"transform\": [{\"scale\": [1, "
    "-2, 1]},"
    "{\"rotate\": {\"axis\": [0, 1, 0], \"degrees\": 30}}, {\"translate\": [1, 2, 3]}]},"
    "{\"type\": \"quad\", \"corner\": [0, 0, 0], \"edge_u\": [1, 0, 0], \"edge_v\": [0, 1, 0], \"material\": "
    "\"a\"},"
    "{\"type\": \"instance\", \"object\": \"hut\", \"material\": \"a\", \"transform\": [{\"matrix\": "
    "[[1, 0, 0, 5], [0, 2, 0, 0], [0, 0, 1, 0]]}]},"
    "{\"type\": \"disk\", \"center\": [0, 1, 0], \"normal\": [0, 1, 0], \"radius\": 2, \"inner_radius\": 1, "
    "\"material\": \"g\"},"
    "{\"type\": \"cylinder\", \"start\": [0, 0, 0], \"end\": [0, 1, 0], \"radius\": 2, \"flip_normal\": "
    "true, "
    "\"material\": \"a\"},"
    "{\"type\": \"mesh\", \"file\": \"roof.obj\", \"material\": \"g\"}");

test::MemoryAssets::Files files(const std::string& obj, const std::string& mtl) {
  return {{"roof.obj", obj}, {"roof.mtl", mtl}};
}

// With the file's own normals, and so its smoothing groups; kScene asks for "smooth".
Result<MeshDescription> built_mesh(const std::string& obj) {
  const auto file = read_obj(obj, "x.obj");
  if (!file) return fail(file.error());
  return build_mesh(*file, NormalsMode::kFile, {}, {0});
}

// Every index of a mesh that was built refers to something.
void expect_sound(const MeshDescription& mesh, const std::string& input) {
  EXPECT_TRUE(mesh.normals.empty() || mesh.normals.size() == mesh.positions.size()) << input;
  EXPECT_TRUE(mesh.uvs.empty() || mesh.uvs.size() == mesh.positions.size()) << input;
  for (const auto& triangle : mesh.triangles)
    for (const std::uint32_t v : triangle) EXPECT_LT(v, mesh.positions.size()) << input;
}

TEST(Mutants, OfAnObjFileBecomeSoundMeshesOrAreRefused) {
  std::mt19937 random(5);
  int built = 0;
  for (int i = 0; i < 10 * kMutants; ++i) {
    const std::string obj = mutate(kObj, random);
    const auto mesh = built_mesh(obj);
    expect_answer(mesh, obj);
    if (mesh) expect_sound(*mesh, obj);
    built += mesh ? 1 : 0;
  }
  EXPECT_GT(built, kMutants / 2);
}

TEST(Mutants, OfAnMtlFileBecomeValidMaterials) {
  std::mt19937 random(6);
  for (int i = 0; i < 10 * kMutants; ++i) {
    const std::string mtl = mutate(kMtl, random);
    SceneDescription scene;
    for (const MtlMaterial& material : read_mtl(mtl).materials)
      scene.materials.push_back(make_material(material, {}));
    scene.materials.push_back({"plain", Lambert{}});
    scene.shapes.emplace_back(SphereDescription{});
    EXPECT_TRUE(validate_scene(scene).has_value()) << mtl;
  }
}

TEST(Mutants, OfASceneAreReadOrRefused) {
  ASSERT_EQ(test::mistakes_in(kScene, files(kObj, kMtl)), "no mistake");
  std::mt19937 random(1);
  for (int i = 0; i < kMutants; ++i) {
    const std::string scene = mutate(kScene, random);
    expect_answer(test::load(scene, files(kObj, kMtl)), scene);
  }
}

TEST(Mutants, OfAnObjFileAreReadOrRefused) {
  std::mt19937 random(2);
  for (int i = 0; i < kMutants; ++i) {
    const std::string obj = mutate(kObj, random);
    expect_answer(test::load(kScene, files(obj, kMtl)), obj);
  }
}

TEST(Mutants, OfAnMtlFileAreReadOrRefused) {
  std::mt19937 random(3);
  for (int i = 0; i < kMutants; ++i) {
    const std::string mtl = mutate(kMtl, random);
    expect_answer(test::load(kScene, files(kObj, mtl)), mtl);
  }
}

TEST(Mutants, EveryCutOfASceneIsRefused) {
  const std::size_t end = kScene.rfind('}');
  for (std::size_t size = 0; size <= end; ++size)
    EXPECT_NE(test::mistakes_in(kScene.substr(0, size), files(kObj, kMtl)), "no mistake") << size;
}

TEST(Mutants, OfAnyBytesAreReadOrRefused) {
  std::mt19937 random(4);
  for (int i = 0; i < kMutants; ++i) {
    std::string bytes(random() % 64, '\0');
    for (char& byte : bytes) byte = static_cast<char>(random());
    expect_answer(test::load(bytes), bytes);
    expect_answer(read_obj(bytes, "x.obj"), bytes);
    read_mtl(bytes);
  }
}

}  // namespace
}  // namespace tessera::core
