// SPDX-License-Identifier: Apache-2.0
// Meshes, nodes, skins and instances of glTF files.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using Corners = std::array<std::uint32_t, 3>;

constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
              kFloat = 5126;

// A mesh of one primitive in a node at the origin.
GltfFile file_of(GltfFile file, nlohmann::json primitive) {
  file.json["meshes"].push_back({{"primitives", {std::move(primitive)}}});
  file.node({{"mesh", 0}});
  return file;
}

TEST(GltfGeometry, ReadsATriangle) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}, {"name", "Leaf"}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const MeshDescription& mesh = mesh_of(*scene);
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(mesh.uvs, ElementsAre(Vec2{0, 1}, Vec2{1, 1}, Vec2{0, 0}));  // v upwards
  EXPECT_THAT(mesh.triangles, ElementsAre(Corners{0, 1, 2}));
  EXPECT_TRUE(mesh.normals.empty());
  EXPECT_EQ(scene->shape_names[0], "nodes[0] (Leaf)");
  EXPECT_EQ(warnings_of(*scene), "");
}

TEST(GltfGeometry, OfBinaryFilesIsTheSame) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  const auto text = load_gltf(file.text()), binary = load_gltf(file.binary());
  ASSERT_TRUE(binary) << binary.error().message;
  EXPECT_EQ(mesh_of(*text).positions, mesh_of(*binary).positions);
  EXPECT_EQ(mesh_of(*text).uvs, mesh_of(*binary).uvs);
}

TEST(GltfGeometry, ReadsBuffersOfFiles) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  const std::string binary = file.binary();
  auto json = file.json;
  const std::string buffer = binary.substr(binary.find("BIN") + 4);
  json["buffers"] = {{{"byteLength", buffer.size()}, {"uri", "my%20buffer.bin"}}};
  const auto scene = load_gltf(json.dump(), {{"my buffer.bin", buffer}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).positions.size(), 3u);
}

TEST(GltfGeometry, PlacesNodesByTheirParents) {
  GltfFile file;
  const int mesh = file.triangle();
  file.node({{"children", {1}}, {"matrix", {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 10, 20, 30, 1}}});
  // A quarter turn about z.
  file.node({{"mesh", mesh},
             {"translation", {1, 0, 0}},
             {"rotation", {0, 0, 0.70710678f, 0.70710678f}},
             {"scale", {3, 1, 1}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const Vec3 expected[] = {{12, 20, 30}, {12, 26, 30}, {10, 20, 30}};
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_LT(length(mesh_of(*scene).positions[i] - expected[i]), 1e-5f) << i;
}

TEST(GltfGeometry, KeepsTheOutsideOfMirroredMeshes) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}, {"scale", {-1, 1, 1}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const MeshDescription& mesh = mesh_of(*scene);
  const auto [a, b, c] = mesh.triangles[0];
  const Vec3 normal = cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]);
  EXPECT_GT(normal.z, 0);
}

TEST(GltfGeometry, MakesTrianglesOfStripsAndFans) {
  const std::pair<int, std::vector<Corners>> modes[] = {{5, {{0, 1, 2}, {1, 3, 2}}},
                                                        {6, {{1, 2, 0}, {2, 3, 0}}}};
  for (const auto& [mode, expected] : modes) {
    GltfFile file;
    const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});
    const auto scene =
        load_gltf(file_of(file, {{"attributes", {{"POSITION", positions}}}, {"mode", mode}}).text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_EQ(mesh_of(*scene).triangles, expected);
  }
}

TEST(GltfGeometry, LeavesOutWhatHasNoArea) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  for (const int mode : {0, 1, 2, 3})
    file.json["meshes"][0]["primitives"].push_back({{"attributes", {{"POSITION", 0}}}, {"mode", mode}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 1u);
  EXPECT_THAT(warnings_of(*scene), HasSubstr("points and lines have no area; they are left out (4 times)"));
}

TEST(GltfGeometry, ReadsEveryTypeOfIndices) {
  const std::pair<int, std::string> kinds[] = {{kUnsignedByte, std::string("\0\2\1", 3)},
                                               {kUnsignedShort, std::string("\0\0\2\0\1\0", 6)},
                                               {kUnsignedInt, std::string("\0\0\0\0\2\0\0\0\1\0\0\0", 12)}};
  for (const auto& [type, bytes] : kinds) {
    GltfFile file;
    const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0});
    const int indices = file.accessor(file.view(bytes), type, "SCALAR", 3);
    const auto scene =
        load_gltf(file_of(file, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}}).text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(mesh_of(*scene).triangles, ElementsAre(Corners{0, 2, 1}));
  }
}

// As KHR_mesh_quantization allows.
TEST(GltfGeometry, ReadsQuantizedAttributes) {
  GltfFile file;
  const int positions =
      file.accessor(file.view(std::string("\0\0\0\0\1\0\0\0\0\2\0\0", 12), 4), kByte, "VEC3", 3);
  const std::string up("\0\0\xff\x7f", 4);  // shorts 0, 32767
  const std::string normal = std::string("\0\0", 2) + up;
  const int normals = file.accessor(file.view(normal + normal + normal, 6), kShort, "VEC3", 3, true);
  const int uvs = file.accessor(file.view("\xff\xff\x80\x80\xff\x01"), kUnsignedByte, "VEC2", 3, true);
  const int colors = file.accessor(file.view(std::string("\xff\xff\0\0\xff\xff\0\0\xff\xff\0\0"
                                                         "\xff\xff\0\0\xff\xff",
                                                         18)),
                                   kUnsignedShort, "VEC3", 3, true);
  file.json["extensionsRequired"] = {"KHR_mesh_quantization"};
  const auto scene = load_gltf(
      file_of(file,
              {{"attributes",
                {{"POSITION", positions}, {"NORMAL", normals}, {"TEXCOORD_0", uvs}, {"COLOR_0", colors}}}})
          .text());
  ASSERT_TRUE(scene) << scene.error().message;
  const MeshDescription& mesh = mesh_of(*scene);
  EXPECT_THAT(mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 2, 0}));
  EXPECT_THAT(mesh.normals, ElementsAre(Vec3{0, 0, 1}, Vec3{0, 0, 1}, Vec3{0, 0, 1}));
  EXPECT_EQ(mesh.uvs[0], (Vec2{1, 0}));
  EXPECT_EQ(mesh.uvs[2], (Vec2{1, 1 - 1.0f / 255}));
  EXPECT_EQ(mesh.colors[0], (Rgb{1, 0, 1}));
}

TEST(GltfGeometry, ReadsInterleavedAttributes) {
  GltfFile file;
  const int view = file.view(bytes_of({0, 0, 0, 7, 7, 1, 0, 0, 8, 8, 0, 1, 0, 9, 9}), 20);
  const int positions = file.accessor(view, kFloat, "VEC3", 3);
  const int uvs = file.accessor(view, kFloat, "VEC2", 3, false, 12);
  const auto scene =
      load_gltf(file_of(file, {{"attributes", {{"POSITION", positions}, {"TEXCOORD_0", uvs}}}}).text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(mesh_of(*scene).uvs, ElementsAre(Vec2{7, -6}, Vec2{8, -7}, Vec2{9, -8}));
}

TEST(GltfGeometry, ReadsSparseAccessors) {
  GltfFile file;
  const int values = file.view(bytes_of({1, 0, 0, 0, 1, 0})), places = file.view("\1\2");
  file.json["accessors"].push_back({{"componentType", kFloat},
                                    {"type", "VEC3"},
                                    {"count", 3},
                                    {"sparse",
                                     {{"count", 2},
                                      {"indices", {{"bufferView", places}, {"componentType", kUnsignedByte}}},
                                      {"values", {{"bufferView", values}}}}}});
  const auto scene = load_gltf(file_of(file, {{"attributes", {{"POSITION", 0}}}}).text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
}

// Of a long array that many primitives share.
TEST(GltfGeometry, KeepsOnlyVerticesThatTrianglesUse) {
  for (const std::size_t vertices : {4u, 200u}) {
    std::vector<float> values(3 * vertices);
    values[3 * (vertices - 1)] = 5;
    values[3] = 1;
    values[7] = 1;
    GltfFile file;
    const int positions = file.floats("VEC3", values);
    const auto last = static_cast<std::uint16_t>(vertices - 1);
    const int indices = file.indices({2, last, 1});
    const auto scene =
        load_gltf(file_of(file, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}}).text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{1, 0, 0}, Vec3{0, 1, 0}, Vec3{5, 0, 0}));
    EXPECT_THAT(mesh_of(*scene).triangles, ElementsAre(Corners{1, 2, 0}));
  }
}

TEST(GltfGeometry, IsAtRestWherePositionsAreNoNumbers) {
  GltfFile file;
  const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, std::nanf(""), 0, 0});
  const int indices = file.indices({0, 1, 2, 0, 1, 3});
  const auto scene =
      load_gltf(file_of(file, {{"attributes", {{"POSITION", positions}}}, {"indices", indices}}).text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(mesh_of(*scene).triangles.size(), 1u);
  EXPECT_TRUE(mesh_of(*scene).steps.empty());
  EXPECT_FALSE(scene->animation.deforms);
}

TEST(GltfGeometry, AppliesMorphTargets) {
  GltfFile file;
  const int mesh = file.triangle();
  auto& json = file.json["meshes"][0];
  json["primitives"][0]["targets"] = {{{"POSITION", file.floats("VEC3", {0, 0, 8, 0, 0, 0, 0, 0, 0})}},
                                      {{"POSITION", file.floats("VEC3", {0, 0, 0, 0, 0, 4, 0, 0, 0})}}};
  json["weights"] = {0.5, 0};
  file.node({{"mesh", mesh}});
  file.node({{"mesh", mesh}, {"weights", {0, 1}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  const auto& at_rest = std::get<MeshDescription>(scene->objects[0].shapes[0]);
  EXPECT_THAT(at_rest.positions, ElementsAre(Vec3{0, 0, 4}, Vec3{1, 0, 0}, Vec3{0, 1, 0}));
  EXPECT_THAT(mesh_of(*scene, 1).positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 4}, Vec3{0, 1, 0}));
}

TEST(GltfGeometry, AppliesSkins) {
  GltfFile file;
  const int mesh = file.triangle();
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  const std::string first_two("\0\1\0\0", 4);
  attributes["JOINTS_0"] =
      file.accessor(file.view(first_two + first_two + first_two), kUnsignedByte, "VEC4", 3);
  attributes["WEIGHTS_0"] = file.floats("VEC4", {1, 0, 0, 0, 0, 1, 0, 0, 0.5f, 0.5f, 0, 0});
  const std::vector<float> unmoved{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
  std::vector<float> matrices = unmoved;
  matrices.insert(matrices.end(), unmoved.begin(), unmoved.end());
  matrices[16 + 12] = 100;
  file.json["skins"] = {{{"joints", {1, 2}}, {"inverseBindMatrices", file.floats("MAT4", matrices)}}};
  file.node({{"mesh", mesh}, {"skin", 0}, {"translation", {7, 7, 7}}});  // which a skin ignores
  file.node({{"translation", {0, 0, 1}}});
  file.node({{"translation", {0, 0, 3}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{0, 0, 1}, Vec3{101, 0, 3}, Vec3{50, 1, 2}));
}

// A triangle with normals along z and tangents along x, whose material follows them or not.
GltfFile with_tangents(bool followed) {
  GltfFile file;
  file.json["materials"].push_back(nlohmann::json::object());
  if (followed)
    file.json["materials"][0]["extensions"]["KHR_materials_anisotropy"] = {{"anisotropyStrength", 0.5}};
  file.triangle(0);
  auto& attributes = file.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["NORMAL"] = file.floats("VEC3", {0, 0, 1, 0, 0, 1, 0, 0, 1});
  attributes["TANGENT"] = file.floats("VEC4", {1, 0, 0, -1, 1, 0, 0, -1, 1, 0, 0, -1});
  return file;
}

VertexTangent first_tangent(const GltfFile& file) {
  const auto scene = load_gltf(file.text());
  EXPECT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(warnings_of(*scene), "");
  return mesh_of(*scene).tangents.at(0);
}

TEST(GltfGeometry, ReadsTangentsThatMaterialsFollow) {
  GltfFile file = with_tangents(true);
  file.node({{"mesh", 0}});
  EXPECT_EQ(first_tangent(file), (VertexTangent{{1, 0, 0}, -1}));
  GltfFile plain = with_tangents(false);
  plain.node({{"mesh", 0}});
  EXPECT_TRUE(mesh_of(*load_gltf(plain.text())).tangents.empty());
}

TEST(GltfGeometry, MovesTangentsWithNodesMorphTargetsAndSkins) {
  GltfFile turned = with_tangents(true);
  turned.node({{"mesh", 0}, {"matrix", {0, 2, 0, 0, 2, 0, 0, 0, 0, 0, 2, 0, 0, 0, 0, 1}}});  // a reflection
  EXPECT_EQ(first_tangent(turned), (VertexTangent{{0, 1, 0}, 1}));

  GltfFile morphed = with_tangents(true);
  auto& mesh = morphed.json["meshes"][0];
  mesh["primitives"][0]["targets"] = {{{"TANGENT", morphed.floats("VEC3", {-1, 2, 0, 0, 0, 0, 0, 0, 0})}}};
  mesh["weights"] = {0.5};
  morphed.node({{"mesh", 0}});
  EXPECT_EQ(first_tangent(morphed), (VertexTangent{{0.5f, 1, 0}, -1}));

  GltfFile skinned = with_tangents(true);
  auto& attributes = skinned.json["meshes"][0]["primitives"][0]["attributes"];
  attributes["JOINTS_0"] = skinned.accessor(skinned.view(std::string(12, '\0')), kUnsignedByte, "VEC4", 3);
  attributes["WEIGHTS_0"] = skinned.floats("VEC4", {1, 0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0});
  skinned.json["skins"] = {{{"joints", {1}}}};
  skinned.node({{"mesh", 0}, {"skin", 0}});
  skinned.node({{"matrix", {0, 0, 1, 0, 0, 1, 0, 0, -1, 0, 0, 0, 0, 0, 0, 1}}});  // turns x to z
  EXPECT_EQ(first_tangent(skinned), (VertexTangent{{0, 0, 1}, -1}));
}

TEST(GltfGeometry, StartsTheFirstAnimation) {
  GltfFile file;
  file.node({{"mesh", file.triangle()}, {"translation", {9, 9, 9}}});
  const int times = file.floats("SCALAR", {1, 2});
  const int linear = file.floats("VEC3", {1, 2, 3, 4, 5, 6});
  const int spline = file.floats("VEC3", {9, 9, 9, 2, 2, 2, 9, 9, 9, 9, 9, 9, 7, 7, 7, 9, 9, 9});
  file.json["animations"] = {
      {{"samplers",
        {{{"input", times}, {"output", linear}},
         {{"input", times}, {"output", spline}, {"interpolation", "CUBICSPLINE"}}}},
       {"channels",
        {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}},
         {{"sampler", 1}, {"target", {{"node", 0}, {"path", "scale"}}}}}}},
      {{"samplers", {{{"input", times}, {"output", spline}}}},
       {"channels", {{{"sampler", 0}, {"target", {{"node", 0}, {"path", "translation"}}}}}}}};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{1, 2, 3}, Vec3{3, 2, 3}, Vec3{1, 4, 3}));
  EXPECT_THAT(warnings_of(*scene), HasSubstr("the beginning of the first of 2 animations"));
}

TEST(GltfGeometry, SharesMeshesOfSeveralNodes) {
  GltfFile file;
  const int mesh = file.triangle();
  file.node({{"mesh", mesh}});
  file.node({{"mesh", mesh}, {"translation", {5, 0, 0}}});
  file.node({{"mesh", mesh}, {"scale", {1, 1, 0}}});  // which no instance can have
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  ASSERT_EQ(scene->shapes.size(), 3u);
  EXPECT_EQ(std::get<InstanceDescription>(scene->shapes[1]).to_world.origin, (Vec3{5, 0, 0}));
  EXPECT_EQ(mesh_of(*scene, 2).triangles.size(), 1u);
}

TEST(GltfGeometry, PlacesInstancesOfTheExtension) {
  GltfFile file;
  const int mesh = file.triangle();
  const int offsets = file.floats("VEC3", {1, 0, 0, 2, 0, 0}),
            scales = file.floats("VEC3", {1, 1, 1, 3, 3, 3});
  file.node(
      {{"mesh", mesh},
       {"translation", {0, 10, 0}},
       {"extensions",
        {{"EXT_mesh_gpu_instancing", {{"attributes", {{"TRANSLATION", offsets}, {"SCALE", scales}}}}}}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->shapes.size(), 2u);
  const auto& second = std::get<InstanceDescription>(scene->shapes[1]).to_world;
  EXPECT_EQ(second.origin, (Vec3{2, 10, 0}));
  EXPECT_EQ(second.x_axis, (Vec3{3, 0, 0}));
}

TEST(GltfGeometry, IsThatOfTheDefaultScene) {
  GltfFile file;
  const int mesh = file.triangle();
  file.node({{"mesh", mesh}, {"name", "first"}});
  file.node({{"mesh", mesh}, {"name", "second"}});
  file.json["scenes"] = {{{"nodes", {0}}}, {{"nodes", {1}}}};
  file.json["scene"] = 1;
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->shapes.size(), 1u);
  EXPECT_EQ(scene->shape_names[0], "nodes[1] (second)");
  EXPECT_THAT(warnings_of(*scene), HasSubstr("of 2 scenes, only scenes[1] is rendered"));
}

TEST(GltfGeometry, IsThatOfVisibleNodes) {
  GltfFile file;
  const int mesh = file.triangle();
  file.json["extensionsRequired"] = {"KHR_node_visibility"};
  file.node({{"children", {1}}, {"extensions", {{"KHR_node_visibility", {{"visible", false}}}}}});
  file.node({{"mesh", mesh}, {"name", "hidden by its parent"}});
  file.node({{"mesh", mesh}, {"extensions", {{"KHR_node_visibility", {{"visible", true}}}}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->shapes.size(), 1u);
  EXPECT_EQ(scene->shape_names[0], "nodes[2]");
}

TEST(GltfGeometry, NestsNodesAsDeepAsItLikes) {
  GltfFile file;
  const int mesh = file.triangle();
  constexpr int kDepth = 20000;
  auto& nodes = file.json["nodes"] = nlohmann::json::array();
  for (int i = 0; i < kDepth; ++i) nodes.push_back({{"children", {i + 1}}});
  nodes.push_back({{"mesh", mesh}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->shapes.size(), 1u);
}

}  // namespace
}  // namespace tessera::core::test
