// SPDX-License-Identifier: Apache-2.0
// Bare meshes as scenes, and PLY and STL files in scenes of our own format.
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <cmath>
#include <string>
#include <tuple>
#include <utility>

#include "core/scene/import/scene_bounds.hpp"
#include "core/scene/scene.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core {
namespace {

using test::MemoryAssets;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;
using testing::StartsWith;

// A roof of two triangles; `more` are further properties of faces, `first` and `second` their values.
std::string roof_ply(const std::string& more = "", const std::string& first = "",
                     const std::string& second = "") {
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
         "property float red\nproperty float green\nproperty float blue\nelement face 2\n"
         "property list uchar int vertex_indices\n" +
         more + "end_header\n0 0 0 1 0 0\n2 0 0 1 0 0\n2 1 1 1 0 0\n0 1 1 1 0 0\n3 0 1 2 " + first +
         "\n3 0 2 3 " + second + "\n";
}

constexpr const char* kTriangleStl =
    "solid t\nfacet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 0 2\nendloop\nendfacet\n"
    "endsolid t\n";

Result<SceneDescription> load_bare(const std::string& name, const std::string& content) {
  MemoryAssets assets(MemoryAssets::Files{{name, content}});
  return load_scene(assets, name, "folder/" + name);
}

SceneDescription bare(const std::string& name, const std::string& content) {
  auto scene = load_bare(name, content);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription();
}

// Whether the camera sees the corners of the scene's bounds.
bool sees_all(const SceneDescription& scene) {
  const Aabb box = scene_bounds(scene);
  const CameraDescription& c = scene.camera;
  const Vec3 view = normalize(c.look_at - c.position);
  const Vec3 right = normalize(cross(view, c.up));
  const Vec3 up = cross(right, view);
  const float reach = 0.36397f;  // tan(20 degrees)
  const float aspect =
      static_cast<float>(scene.settings.width_px) / static_cast<float>(scene.settings.height_px);
  for (const float x : {box.lower.x, box.upper.x})
    for (const float y : {box.lower.y, box.upper.y})
      for (const float z : {box.lower.z, box.upper.z}) {
        const Vec3 to = Vec3{x, y, z} - c.position;
        const float depth = dot(to, view);
        if (!(std::fabs(dot(to, up)) < reach * depth)) return false;
        if (!(std::fabs(dot(to, right)) < reach * aspect * depth)) return false;
      }
  return true;
}

TEST(BareMesh, GetsACameraThatSeesItAllAndAStudio) {
  for (const auto& [name, content] : MemoryAssets::Files{
           {"roof.ply", roof_ply()}, {"t.stl", kTriangleStl}, {"t.obj", test::kTriangleObj}}) {
    SceneDescription scene = bare(name, content);
    EXPECT_TRUE(sees_all(scene)) << name;
    ASSERT_TRUE(scene.environment) << name;
    EXPECT_THAT(scene.materials, SizeIs(1)) << name;
    const auto built = Scene::build(std::move(scene), 1);
    EXPECT_TRUE(built) << name << ": " << built.error().message;
  }
}

// A quad of two triangles, with `comments` in its header. `uvs` are two further properties of vertices.
std::string textured_ply(const std::string& comments,
                         const std::string& uvs = "property float s\nproperty float t\n",
                         const std::string& number = "", const std::string& first = "",
                         const std::string& second = "") {
  return "ply\nformat ascii 1.0\n" + comments +
         "element vertex 4\nproperty float x\nproperty float y\nproperty float z\n" + uvs +
         "element face 2\nproperty list uchar int vertex_indices\n" + number +
         "end_header\n0 0 0 0 0\n1 0 0 1 0\n1 1 0 1 1\n0 1 0 0 1\n3 0 1 2 " + first + "\n3 0 2 3 " + second +
         "\n";
}

SceneDescription textured(const std::string& ply, MemoryAssets::Files files = {}) {
  files.emplace("m/scan.ply", ply);
  files.emplace("m/a.png", test::png(test::one_color(2, 2, {1, 0, 0})));
  files.emplace("m/b.png", test::png(test::one_color(2, 2, {0, 1, 0})));
  MemoryAssets assets(files);
  auto scene = load_scene(assets, "m/scan.ply", "m/scan.ply");
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription();
}

// The mean of the image of the triangle's material, or of the whole mesh's.
Rgb color_of(const SceneDescription& scene, std::size_t triangle) {
  const auto& materials = std::get<MeshDescription>(scene.shapes.at(0)).triangle_materials;
  const auto& albedo = std::get<Lambert>(scene.materials[materials.at(triangle)].model).albedo;
  return albedo.texture < 0 ? albedo.value
                            : scene.textures.at(static_cast<std::size_t>(albedo.texture)).image->mean();
}

TEST(BareMesh, OfAScannerHasItsImages) {
  const SceneDescription one = textured(textured_ply("comment TextureFile a.png\n"));
  EXPECT_EQ(color_of(one, 0), (Rgb{1, 0, 0}));
  EXPECT_THAT(one.warnings, IsEmpty());
  const std::string both = "comment TextureFile a.png\ncomment TextureFile C:\\scans\\b.png\n";
  const SceneDescription two = textured(
      textured_ply(both, "property float s\nproperty float t\n", "property int texnumber\n", "1", "0"));
  EXPECT_EQ(color_of(two, 0), (Rgb{0, 1, 0}));
  EXPECT_EQ(color_of(two, 1), (Rgb{1, 0, 0}));
}

TEST(BareMesh, TellsWhichImagesItDoesNotShow) {
  const SceneDescription missing = textured(textured_ply("comment TextureFile gone.jpg\n"));
  EXPECT_EQ(color_of(missing, 0), Rgb::gray(0.5f));
  EXPECT_THAT(
      missing.warnings,
      ElementsAre("m/scan.ply: 'gone.jpg' does not exist, and neither does a file of this name beside "
                  "the file; the map is ignored"));
  EXPECT_THAT(textured(textured_ply("comment TextureFile a.png\n", "property float q\nproperty float p\n"))
                  .warnings.back(),
              "m/scan.ply: has no texture coordinates for the image 'a.png'; it is ignored");
  EXPECT_THAT(
      textured(textured_ply("comment TextureFile a.png\ncomment TextureFile b.png\n")).warnings,
      ElementsAre(
          "m/scan.ply: names 2 images, and no 'texnumber' gives a face one of them; the first is used"));
  EXPECT_THAT(textured(textured_ply("comment TextureFile a.png\n", "property float s\nproperty float t\n",
                                    "property int texnumber\n", "-1", "0"))
                  .warnings,
              ElementsAre("m/scan.ply: 'texnumber' of a face names no image; the default material is used"));
}

TEST(BareMesh, OfAPrinterStandsUpright) {
  EXPECT_EQ(bare("t.stl", kTriangleStl).camera.up, (Vec3{0, 0, 1}));
  EXPECT_EQ(bare("roof.ply", roof_ply()).camera.up, (Vec3{0, 1, 0}));
}

TEST(BareMesh, IsRecognisedByItsContent) {
  EXPECT_THAT(bare("scan", roof_ply()).shapes, SizeIs(1));
}

TEST(BareMesh, IsRefusedWithItsNameOnceIfBroken) {
  const std::string flat = "v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n";
  for (const auto& [name, content, message] :
       {std::tuple("t.ply", std::string("ply\n"), "'folder/t.ply' is a broken PLY file ("),
        std::tuple("t.stl", std::string("solid t\nfacet"), "'folder/t.stl' "),
        std::tuple("t.obj", std::string("v 0 0 0\n"), "folder/t.obj: the file has no faces"),
        std::tuple("t.obj", flat, "'folder/t.obj' has no face with an area greater than 0")}) {
    const auto scene = load_bare(name, content);
    ASSERT_FALSE(scene);
    EXPECT_THAT(scene.error().message, StartsWith(message));
    EXPECT_EQ(scene.error().message.find(name), scene.error().message.rfind(name)) << scene.error().message;
  }
}

// Two triangles at a distance from the origin.
std::string surveyed_obj(double offset, double size) {
  std::string text;
  for (const auto& [x, y, z] :
       {std::tuple(0, 0, 0), std::tuple(1, 0, 0), std::tuple(1, 1, 0), std::tuple(0, 1, 1)})
    text += fmt::format("v {} {} {}\n", offset + x * size, offset + y * size, z * size);
  return text + "f 1 2 3\nf 1 3 4\n";
}

std::string coarse_warnings(const SceneDescription& scene) {
  std::string all;
  for (const std::string& warning : scene.warnings)
    if (warning.find("rounded") != std::string::npos) all += warning + "\n";
  return all;
}

TEST(BareMesh, FarFromTheOriginIsTold) {
  EXPECT_EQ(
      coarse_warnings(bare("t.obj", surveyed_obj(4.5e6, 50))),
      "folder/t.obj: coordinates so far from the origin are rounded to multiples of 0.5, which changes the "
      "shape of triangles; subtract an offset from all coordinates when you export the file (2 "
      "triangles)\n");
  EXPECT_EQ(coarse_warnings(bare("t.obj", surveyed_obj(4.5e6, 20'000))), "") << "only large triangles";
  EXPECT_EQ(coarse_warnings(bare("t.obj", surveyed_obj(4500, 50))), "") << "less than a millimeter";
  EXPECT_EQ(coarse_warnings(bare("t.obj", surveyed_obj(0, 1e-3))), "");
}

// Details of half a metre in a mesh of 20 kilometres.
TEST(BareMesh, TellsDetailsThatAreTooSmallFarFromTheOrigin) {
  const std::string text = surveyed_obj(4.5e6, 20'000) +
                           "v 4500001 4500000 0\nv 4500002 4500000 0\nv 4500002 4500001 0\nf 5 6 7\n";
  EXPECT_THAT(coarse_warnings(bare("t.obj", text)), HasSubstr("when you export the file\n"));
}

TEST(BareMesh, TellsTrianglesWithoutAnArea) {
  std::string text = roof_ply();
  text.replace(text.find("element face 2"), 14, "element face 3");
  EXPECT_THAT(bare("t.ply", text + "3 0 1 1\n").warnings,
              ElementsAre("folder/t.ply: triangles without an area are left out"));
}

TEST(Formats, WithoutReaderAreRefusedByASentence) {
  const auto scene = load_bare("t.xyz", "nonsense");
  ASSERT_FALSE(scene);
  EXPECT_THAT(scene.error().message, HasSubstr("folder/t.xyz"));
}

SceneDescription with_mesh(const std::string& mesh, const MemoryAssets::Files& files) {
  auto scene = test::load(test::scene_with("", R"("a": {"type": "lambert"}, "b": {"type": "mirror"})",
                                           R"({"type": "mesh", )" + mesh + "}"),
                          files);
  EXPECT_TRUE(scene) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription();
}

const MeshDescription& mesh_of(const SceneDescription& scene) {
  return *std::get_if<MeshDescription>(&scene.shapes.at(0));
}

TEST(MeshOfAScene, ComesFromPlyAndStlFiles) {
  const SceneDescription ply = with_mesh(R"("file": "m.ply", "material": "a")", {{"m.ply", roof_ply()}});
  EXPECT_THAT(mesh_of(ply).triangles, SizeIs(2));
  EXPECT_THAT(mesh_of(ply).colors, IsEmpty()) << "a material replaces vertex colours";
  EXPECT_EQ(mesh_of(ply).normals.size(), mesh_of(ply).positions.size()) << "computed";
  const SceneDescription stl =
      with_mesh(R"("file": "m.stl", "material": "a", "normals": "flat", "transform": [{"scale": 2}])",
                {{"m.stl", kTriangleStl}});
  EXPECT_THAT(mesh_of(stl).normals, IsEmpty());
  EXPECT_EQ(mesh_of(stl).positions.at(2), (Vec3{0, 0, 4}));
}

TEST(MeshOfAScene, FarFromTheOriginInItsFileIsTold) {
  const std::string obj = surveyed_obj(4.5e6, 50), vertices = obj.substr(0, obj.find("f "));
  std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty double x\nproperty double y\nproperty double z\n"
      "element face 2\nproperty list uchar int vertex_indices\nend_header\n";
  for (const char c : vertices)
    if (c != 'v') ply += c;
  for (const auto& [name, content] :
       {std::pair("m.obj", obj), std::pair("m.ply", ply + "3 0 1 2\n3 0 2 3\n")}) {
    const SceneDescription scene = with_mesh(
        fmt::format(R"("file": "{}", "material": "a", "transform": [{{"translate": [-4.5e6, -4.5e6, 0]}}])",
                    name),
        {{name, content}});
    EXPECT_THAT(coarse_warnings(scene), HasSubstr("rounded to multiples of 0.5")) << name;
  }
}

TEST(MeshOfAScene, CanUseVertexColorsWithAMaterial) {
  const SceneDescription scene =
      with_mesh(R"("file": "m.ply", "material": "a", "vertex_colors": "use")", {{"m.ply", roof_ply()}});
  EXPECT_EQ(mesh_of(scene).colors.at(0), (Rgb{1, 0, 0}));
}

TEST(MeshOfAScene, TakesMaterialsByIndex) {
  const std::string file = roof_ply("property int material_index\n", "1", "0");
  const SceneDescription scene = with_mesh(R"("file": "m.ply", "materials": ["a", "b"])", {{"m.ply", file}});
  EXPECT_EQ(scene.materials.at(mesh_of(scene).triangle_materials.at(0)).name, "b");
  EXPECT_EQ(scene.materials.at(mesh_of(scene).triangle_materials.at(1)).name, "a");
  const auto mistakes = [&](const std::string& mesh) {
    return test::mistakes_in(
        test::scene_with("", R"("a": {"type": "lambert"})", R"({"type": "mesh", )" + mesh + "}"),
        {{"m.ply", file}});
  };
  EXPECT_THAT(mistakes(R"("file": "m.ply", "materials": ["a"])"),
              HasSubstr("'m.ply' has the material_index 1, but there are 1 'materials'"));
  EXPECT_THAT(mistakes(R"("file": "triangle.obj", "materials": ["a"])"),
              HasSubstr("'materials' is for PLY files"));
}

}  // namespace
}  // namespace tessera::core
