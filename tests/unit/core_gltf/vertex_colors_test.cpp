// SPDX-License-Identifier: Apache-2.0
// Vertex colours of glTF files that change more than the base colour, and attributes that change nothing.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "core/scene/gltf/vertex_tints.hpp"
#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using nlohmann::json;
using testing::HasSubstr;
using testing::Not;

// Two triangles with this material whose corners, three of each, have these colours of four channels.
GltfFile colored_triangles(const json& material, const std::vector<float>& colors) {
  GltfFile file;
  file.json["materials"].push_back(material);
  const int positions = file.floats("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 1, 0, 1, 0, 1, 1});
  file.json["meshes"] = {
      {{"primitives",
        {{{"material", 0},
          {"attributes", {{"POSITION", positions}, {"COLOR_0", file.floats("VEC4", colors)}}}}}}}};
  file.node({{"mesh", 0}});
  return file;
}

SceneDescription loaded_triangles(const json& material, const std::vector<float>& colors) {
  auto scene = load_gltf(colored_triangles(material, colors).text());
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription();
}

const Material& material_of_triangle(const SceneDescription& scene, std::size_t triangle) {
  const auto& materials = mesh_of(scene).triangle_materials;
  return scene.materials.at(materials.at(materials.size() == 1 ? 0 : triangle));
}

// Each corner of a triangle has the same colour.
std::vector<float> by_triangle(const std::vector<float>& first, const std::vector<float>& second) {
  std::vector<float> colors;
  for (const auto* color : {&first, &second})
    for (int corner = 0; corner < 3; ++corner) colors.insert(colors.end(), color->begin(), color->end());
  return colors;
}

TEST(GltfVertexColors, HaveAnAlphaThatMultipliesOpacity) {
  const json half{{"alphaMode", "BLEND"}, {"pbrMetallicRoughness", {{"baseColorFactor", {1, 1, 1, 0.5}}}}};
  const auto scene = loaded_triangles(half, by_triangle({1, 0, 0, 0.5f}, {0, 1, 0, 1}));
  EXPECT_EQ(material_of_triangle(scene, 0).opacity.value, 0.25f);
  EXPECT_EQ(material_of_triangle(scene, 1).opacity.value, 0.5f);
  EXPECT_EQ(mesh_of(scene).colors.at(0), (Rgb{1, 0, 0}));
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(GltfVertexColors, HaveAnAlphaThatMasksMayCut) {
  const auto scene = loaded_triangles({{"alphaMode", "MASK"}, {"alphaCutoff", 0.4}},
                                      by_triangle({1, 1, 1, 0.25f}, {1, 1, 1, 0.75f}));
  EXPECT_EQ(material_of_triangle(scene, 0).opacity.value, 0);
  EXPECT_EQ(material_of_triangle(scene, 1).opacity.value, 1);
}

TEST(GltfVertexColors, HaveNoAlphaOnOpaqueSurfaces) {
  const auto scene = loaded_triangles(json::object(), by_triangle({1, 0, 0, 0.5f}, {0, 1, 0, 1}));
  EXPECT_EQ(mesh_of(scene).triangle_materials.size(), 1u);
  EXPECT_EQ(material_of_triangle(scene, 0).opacity.value, 1);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(GltfVertexColors, OfTheMiddleOfATriangleCountWhereTheyVary) {
  std::vector<float> colors = by_triangle({1, 1, 1, 0}, {1, 1, 1, 1});
  colors[3] = 0.75f;
  const auto scene = loaded_triangles({{"alphaMode", "BLEND"}}, colors);
  EXPECT_EQ(material_of_triangle(scene, 0).opacity.value, 0.25f);
  EXPECT_EQ(material_of_triangle(scene, 1).opacity.value, 1);
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("the alpha of vertex colours is that of the middle of each triangle"));
}

TEST(GltfVertexColors, OfUnlitSurfacesAreEmitted) {
  const json unlit{{"extensions", {{"KHR_materials_unlit", json::object()}}},
                   {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}}};
  const auto scene = loaded_triangles(unlit, by_triangle({1, 0.5f, 0.25f, 1}, {0, 1, 0, 1}));
  EXPECT_EQ(material_of_triangle(scene, 0).emission.value, (Rgb{0.5f, 0.5f, 0.25f}));
  EXPECT_EQ(material_of_triangle(scene, 1).emission.value, (Rgb{0, 1, 0}));
  EXPECT_THAT(warnings_of(scene), Not(HasSubstr("vertex colours")));
}

TEST(GltfVertexColors, TintWhatIsTransmitted) {
  const json clear{{"extensions", {{"KHR_materials_transmission", {{"transmissionFactor", 1}}}}},
                   {"emissiveFactor", {1, 1, 1}},
                   {"pbrMetallicRoughness", {{"baseColorFactor", {0.5, 1, 1, 1}}}}};
  const auto scene = loaded_triangles(clear, by_triangle({1, 0.5f, 0.25f, 1}, {0, 1, 0, 1}));
  const auto color = [&](std::size_t triangle) {
    return std::get<Principled>(material_of_triangle(scene, triangle).model).transmission_color.value;
  };
  EXPECT_EQ(color(0), (Rgb{0.5f, 0.5f, 0.25f}));
  EXPECT_EQ(color(1), (Rgb{0, 1, 0}));
  EXPECT_EQ(material_of_triangle(scene, 1).emission.value, Rgb::gray(1));
  EXPECT_EQ(mesh_of(scene).colors.at(0), (Rgb{1, 0.5f, 0.25f}));
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(GltfVertexColors, AreRoundedToAFewTints) {
  MeshDescription mesh;
  std::vector<float> alphas;
  for (std::uint32_t i = 0; i < 1000; ++i) {
    mesh.triangles.push_back({i, i, i});
    alphas.push_back(static_cast<float>(i) / 999);
  }
  const auto rounded = gltf::triangle_tints(mesh, {}, alphas);
  EXPECT_EQ(rounded.steps, 255);
  EXPECT_FALSE(rounded.varies_in_triangles);
  for (std::size_t i = 0; i < 1000; ++i) EXPECT_NEAR(rounded.tints[i].alpha, alphas[i], 0.5f / 255 + 1e-6f);
  mesh.triangles.resize(200);
  const auto exact = gltf::triangle_tints(mesh, {}, alphas);
  EXPECT_EQ(exact.steps, 0);
  EXPECT_EQ(exact.tints[17].alpha, alphas[17]);
}

std::string warnings_with_attributes(const json& material, const std::vector<std::string>& names) {
  GltfFile file;
  file.json["materials"].push_back(material);
  file.json["images"].push_back({{"uri", "lost.png"}});
  file.json["textures"].push_back({{"source", 0}});
  file.node({{"mesh", file.triangle(0)}});
  const int values = file.floats("VEC4", std::vector<float>(12, 1));
  for (const std::string& name : names) file.json["meshes"][0]["primitives"][0]["attributes"][name] = values;
  const auto scene = load_gltf(file.text());
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? warnings_of(*scene) : "";
}

TEST(GltfAttributes, ThatAreIgnoredAreTold) {
  const json plain = json::object();
  EXPECT_THAT(
      warnings_with_attributes(plain, {"COLOR_1"}),
      HasSubstr("meshes[0].primitives[0].attributes.COLOR_1: COLOR_1 is ignored: only COLOR_0 is used"));
  EXPECT_THAT(warnings_with_attributes(plain, {"TEXCOORD_1"}),
              HasSubstr("TEXCOORD_1 is ignored: no texture of its material uses it"));
  EXPECT_THAT(warnings_with_attributes(plain, {"SHADE"}),
              HasSubstr("there is no attribute 'SHADE'; it is ignored"));
  EXPECT_EQ(warnings_with_attributes(plain, {"_SHADE", "TANGENT", "JOINTS_0", "WEIGHTS_0"}), "");
  for (const json& material :
       {json{{"normalTexture", {{"index", 0}}}},
        json{{"extensions", {{"KHR_materials_anisotropy", {{"anisotropyStrength", 0.5}}}}}},
        json{{"extensions", {{"KHR_materials_clearcoat", {{"clearcoatNormalTexture", {{"index", 0}}}}}}}}})
    EXPECT_THAT(warnings_with_attributes(material, {"TANGENT"}),
                HasSubstr("the tangents of a mesh without normals are ignored, as glTF demands"));
}

TEST(GltfAttributes, ThicknessTexturesAreTold) {
  EXPECT_THAT(
      warnings_with_attributes(
          {{"extensions",
            {{"KHR_materials_transmission", {{"transmissionFactor", 1}}},
             {"KHR_materials_volume", {{"thicknessFactor", 1}, {"thicknessTexture", {{"index", 0}}}}}}}},
          {}),
      HasSubstr("the thickness of a volume is that of its geometry; the texture is ignored"));
}

}  // namespace
}  // namespace tessera::core::test
