// SPDX-License-Identifier: Apache-2.0
// Meshes of other programs whose materials and images are missing, elsewhere or odd: what can be rendered is,
// and what is replaced is told.
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>
#include <fstream>

#include "tests/support/bundle_files.hpp"
#include "tests/unit/core_scene/memory_assets.hpp"

namespace tessera::core::other_programs_test {
namespace {

namespace fs = std::filesystem;
using Files = test::MemoryAssets::Files;
using Strings = std::vector<std::string>;
using testing::AllOf;
using testing::ElementsAre;
using testing::EndsWith;
using testing::StartsWith;

const std::string kVertices = "v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n";

std::string scene_of(const std::string& more = "") {
  return test::scene_with("", "\"red\": {\"type\": \"lambert\", \"albedo\": [1, 0, 0]}",
                          "{\"type\": \"mesh\", \"file\": \"m/a.obj\"" + more + "}");
}

SceneDescription loaded(const Files& files, const std::string& more = "") {
  auto scene = test::load(scene_of(more), files);
  EXPECT_TRUE(scene.has_value()) << scene.error().message;
  return scene ? std::move(*scene) : SceneDescription{};
}

const MeshDescription& mesh_of(const SceneDescription& scene) {
  return std::get<MeshDescription>(scene.shapes.at(0));
}

const Material& material_of(const SceneDescription& scene, std::size_t triangle) {
  const auto& materials = mesh_of(scene).triangle_materials;
  return scene.materials.at(materials.size() == 1 ? materials[0] : materials.at(triangle));
}

Rgb albedo_of(const SceneDescription& scene, std::size_t triangle) {
  return std::get<Lambert>(material_of(scene, triangle).model).albedo.value;
}

std::string gray_png() {
  return test::png(test::one_color(2, 2, Rgb::gray(0.5f)));
}

TEST(OtherPrograms, FacesWithoutMaterialsGetADefault) {
  const Files files{{"m/a.obj", "mtllib a.mtl\n" + kVertices + "f 1 2 3\nusemtl a\nf 2 4 3\n"},
                    {"m/a.mtl", "newmtl a\nKd 0 1 0\n"}};
  const SceneDescription scene = loaded(files);
  EXPECT_EQ(albedo_of(scene, 0), Rgb::gray(0.5f));
  EXPECT_EQ(albedo_of(scene, 1), (Rgb{0, 1, 0}));
  EXPECT_EQ(scene.warnings,
            Strings{"m/a.obj:9: no 'usemtl' gives this face a material; the default material, a "
                    "mid-grey lambert, is used"});
}

TEST(OtherPrograms, ADefaultMaterialFillsGapsAndAMaterialReplacesAll) {
  const Files files{
      {"m/a.obj", "mtllib a.mtl\n" + kVertices + "f 1 2 3\nusemtl a\nf 2 4 3\nusemtl b\nf 1 4 3\n"},
      {"m/a.mtl", "newmtl a\nKd 0 1 0\n"}};
  const SceneDescription filled = loaded(files, ", \"default_material\": \"red\"");
  EXPECT_EQ(albedo_of(filled, 0), (Rgb{1, 0, 0}));
  EXPECT_EQ(albedo_of(filled, 1), (Rgb{0, 1, 0}));
  EXPECT_EQ(albedo_of(filled, 2), (Rgb{1, 0, 0}));
  EXPECT_EQ(filled.warnings,
            Strings{"m/a.obj:12: there is no material 'b' in the 'mtllib' files; did you mean "
                    "'a'?; 'default_material' is used"});
  const SceneDescription replaced = loaded(files, ", \"material\": \"red\", \"default_material\": \"light\"");
  EXPECT_EQ(mesh_of(replaced).triangle_materials.size(), 1u);
  EXPECT_EQ(albedo_of(replaced, 0), (Rgb{1, 0, 0}));
  EXPECT_TRUE(replaced.warnings.empty());
}

TEST(OtherPrograms, WithVertexColoursAloneAreToldWhatTheyGet) {
  const Files files{{"m/a.obj", "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n"}};
  const SceneDescription ignored = loaded(files, ", \"vertex_colors\": \"ignore\"");
  EXPECT_EQ(albedo_of(ignored, 0), Rgb::gray(0.5f));
  EXPECT_EQ(ignored.warnings, Strings{"m/a.obj:4: no 'usemtl' gives this face a material; the default "
                                      "material, a mid-grey lambert, is used"});
  const SceneDescription scene = loaded(files);
  EXPECT_EQ(albedo_of(scene, 0), Rgb::gray(1));
  EXPECT_EQ(scene.warnings, Strings{"m/a.obj:4: no 'usemtl' gives this face a material; a white lambert with "
                                    "the vertex colours is used"});
}

TEST(OtherPrograms, ThatNameMissingLibrariesAreRendered) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib gone.mtl a.mtl\n" + kVertices + "usemtl a\nf 1 2 3\nusemtl c\nf 1 2 4 3\n"},
              {"m/a.mtl", "newmtl a\nKd 0 1 0\n"}});
  EXPECT_EQ(albedo_of(scene, 0), (Rgb{0, 1, 0}));
  EXPECT_EQ(albedo_of(scene, 1), Rgb::gray(0.5f));
  EXPECT_EQ(
      scene.warnings,
      (Strings{"m/a.obj:1: 'gone.mtl' does not exist, and neither does a file of this name beside the OBJ "
               "file; its materials are missing",
               "m/a.obj:11: there is no material 'c' in the 'mtllib' files; did you mean 'a'?; the default "
               "material, a mid-grey lambert, is used (2 triangles)"}));
}

TEST(OtherPrograms, LibrariesAndImagesAreFoundByTheirLastName) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib C:\\art\\me\\a.mtl\n" + kVertices + "usemtl a\nf 1/1 2/2 3/3\n"},
              {"m/a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd /opt/me/wood.png\nmap_Ke maps\\glow.png\n"},
              {"m/wood.png", gray_png()},
              {"m/maps/glow.png", gray_png()}});
  const Material& material = material_of(scene, 0);
  EXPECT_GE(std::get<Lambert>(material.model).albedo.texture, 0);
  EXPECT_GE(material.emission.texture, 0);
  EXPECT_EQ(scene.warnings,
            (Strings{"m/a.obj:1: 'C:\\art\\me\\a.mtl' does not exist; 'm/a.mtl' is used",
                     "m/a.mtl:3: '/opt/me/wood.png' does not exist; 'm/wood.png' is used (2 times)"}));
}

TEST(OtherPrograms, MissingAndBrokenImagesCostTheTextureOnly) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1 2 3\nusemtl b\nf 2 4 3\n"},
              {"m/a.mtl",
               "newmtl a\nKd 0 1 0\nmap_Kd gone.png\nnewmtl b\nKd 0 0 1\nmap_Kd b.png\n"
               "newmtl unused\nmap_Kd also_gone.png\n"},
              {"m/b.png", "no image"}});
  EXPECT_EQ(albedo_of(scene, 0), (Rgb{0, 1, 0}));
  EXPECT_EQ(albedo_of(scene, 1), (Rgb{0, 0, 1}));
  EXPECT_TRUE(scene.textures.empty());
  ASSERT_EQ(scene.warnings.size(), 2u);
  EXPECT_EQ(scene.warnings[0],
            "m/a.mtl:3: 'gone.png' does not exist, and neither does a file of this name beside "
            "the file; the map is ignored");
  EXPECT_TRUE(scene.warnings[1].starts_with("m/a.mtl:6: 'm/b.png' is not a")) << scene.warnings[1];
}

TEST(OtherPrograms, FacesWithoutTextureCoordinatesOfMaterialsWithImagesAreTold) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib a.mtl\n" + kVertices +
                              "usemtl b\nf 1 2 3\nusemtl a\nf 1 2 3\nf 2/1 4/2 3/3\n"
                              "f 1/1 2/2 4\n"},
              {"m/a.mtl", "newmtl a\nmap_Kd a.png\nnewmtl b\nKd 1 0 0\n"},
              {"m/a.png", gray_png()}});
  EXPECT_EQ(scene.warnings,
            (Strings{"m/a.obj:11: 'm/a.mtl: a' has images, and faces of it have no texture coordinates; they "
                     "show a single texel (2 triangles)"}));
}

TEST(OtherPrograms, TheLastMaterialOfANameIsUsed) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1 2 3\n"},
              {"m/a.mtl", "newmtl a\nKd 1 0 0\nnewmtl b\nKd 1 1 1\nnewmtl a\nKd 0 1 0\n"}});
  EXPECT_EQ(albedo_of(scene, 0), (Rgb{0, 1, 0}));
}

TEST(OtherPrograms, TheFirstTileOfAnImageIsUsed) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1/1 2/2 3/3\n"},
              {"m/a.mtl", "newmtl a\nmap_Kd a.<UDIM>.png\nmap_Ks b.<UVTILE>.png\n"},
              {"m/a.1001.png", gray_png()}});
  EXPECT_EQ(scene.textures.size(), 1u);
  EXPECT_EQ(
      scene.warnings,
      (Strings{"m/a.mtl:2: 'a.<UDIM>.png' stands for the tiles of an image, which are not supported; tile "
               "1001 is used for all (2 times)",
               "m/a.mtl:3: 'b.u1_v1.png' does not exist, and neither does a file of this name beside the "
               "file; the map is ignored"}));
}

TEST(OtherPrograms, EachImageThatCannotBeUsedIsTold) {
  const SceneDescription scene =
      loaded({{"m/a.obj", "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1 2 3\nusemtl b\nf 2 4 3\n"},
              {"m/a.mtl",
               "newmtl a\nmap_Kd gone.png\nmap_Ks a.png\nmap_Ke b.jpg\nmap_Pr c.exr\n"
               "newmtl b\nmap_Kd also_gone.png\nmap_Ks a.png\n"},
              {"m/a.png", "\x89PNG\r\n\x1a\n"},
              {"m/b.jpg", "\xff\xd8\xff\xe0"},
              {"m/c.exr", "no image"}});
  EXPECT_THAT(scene.warnings,
              ElementsAre(StartsWith("m/a.mtl:2: 'gone.png' does not exist"),
                          AllOf(StartsWith("m/a.mtl:3: 'm/a.png' is a broken PNG"), EndsWith(" (2 times)")),
                          StartsWith("m/a.mtl:4: 'm/b.jpg' is a broken JPEG"),
                          StartsWith("m/a.mtl:5: 'm/c.exr' is not a"),
                          StartsWith("m/a.mtl:7: 'also_gone.png' does not exist")));
}

TEST(OtherPrograms, WarningsOfAFileAreToldOnceHoweverManyShapesShowIt) {
  const std::string mesh = "{\"type\": \"mesh\", \"file\": \"a.obj\"}";
  const auto scene = test::load(test::scene_with("", "", mesh + "," + mesh),
                                {{"a.obj", "mtllib gone.mtl\n" + kVertices + "odd\nf 1 2 3\n"}});
  ASSERT_TRUE(scene.has_value()) << scene.error().message;
  EXPECT_EQ(scene->warnings.size(), 3u);
}

TEST(OtherPrograms, ColorsOfVerticesAreKept) {
  const std::string obj = "v 0 0 0 1 0 0\nv 1 0 0 0 1 0\nv 0 1 0 0 0 1\nf 1 2 3\n";
  const SceneDescription scene = loaded({{"m/a.obj", obj}});
  EXPECT_EQ(mesh_of(scene).colors, (std::vector<Rgb>{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}));
  EXPECT_EQ(albedo_of(scene, 0), Rgb::gray(1));
  EXPECT_TRUE(mesh_of(loaded({{"m/a.obj", obj}}, ", \"material\": \"red\"")).colors.empty());
}

TEST(OtherPrograms, HeightsBecomeBumpMapsAndNormalsNormalMaps) {
  const std::string obj = "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1/1 2/2 3/3\n";
  const auto with_bump = [&](Rgb color) {
    return loaded({{"m/a.obj", obj},
                   {"m/a.mtl", "newmtl a\nKd 1 1 1\nmap_Bump -bm 0.5 b.png\n"},
                   {"m/b.png", test::png(test::one_color(2, 2, color))}});
  };
  const SceneDescription height = with_bump(Rgb::gray(0.5f));
  EXPECT_GE(material_of(height, 0).bump.texture, 0);
  EXPECT_LT(material_of(height, 0).normal_map.texture, 0);
  // One repeat of the texture is one unit long.
  EXPECT_NEAR(material_of(height, 0).bump.height, 0.5f * 0.02f, 1e-6f);
  // The linear values whose codes are 128, 128 and 255.
  const SceneDescription normal = with_bump({0.2159f, 0.2159f, 1});
  EXPECT_GE(material_of(normal, 0).normal_map.texture, 0);
  EXPECT_EQ(material_of(normal, 0).normal_map.strength, 0.5f);
  EXPECT_LT(material_of(normal, 0).bump.texture, 0);
}

TEST(OtherPrograms, OdditiesOfImagesAreToldOnce) {
  std::string pfm = "PF\n1 1\n-1\n";
  for (const float value : {-1.0f, 0.5f, 1.0f})
    pfm.append(reinterpret_cast<const char*>(&value), sizeof value);
  const SceneDescription scene = loaded(
      {{"m/a.obj", "mtllib a.mtl\n" + kVertices + "usemtl a\nf 1/1 2/2 3/3\nusemtl b\nf 2/2 4/1 3/3\n"},
       {"m/a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd a.pfm\nnewmtl b\nmap_Kd a.pfm\nmap_d a.pfm\n"},
       {"m/a.pfm", pfm}});
  EXPECT_EQ(scene.warnings,
            Strings{"m/a.pfm: has values that are negative, infinite or not numbers (1 of them); "
                    "0 or 65504 is used instead"});
}

class OtherProgramsInFolder : public testing::Test {
 protected:
  void SetUp() override {
    std::string pattern = (fs::temp_directory_path() / "tessera-programs-XXXXXX").string();
    ASSERT_NE(mkdtemp(pattern.data()), nullptr);
    folder_ = pattern;
    write("scene.json", test::scene_with("", "", "{\"type\": \"mesh\", \"file\": \"a.obj\"}"));
    write("a.obj", "mtllib A.MTL\n" + kVertices + "usemtl a\nf 1/1 2/2 3/3\n");
    write("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd Maps/WOOD.PNG\n");
  }
  void TearDown() override { fs::remove_all(folder_); }

  void write(const std::string& name, const std::string& bytes) {
    fs::create_directories((folder_ / name).parent_path());
    std::ofstream(folder_ / name, std::ios::binary) << bytes;
  }
  // As it is rendered here; then again from the files that its bundle has.
  std::size_t textures() {
    FolderAssets files(folder_.string());
    std::map<std::string, std::string> blobs;
    RecordingAssets recording(
        files, [&](const std::string& path, const std::string&) { blobs[path] = (folder_ / path).string(); });
    const auto here = load_scene(recording, "scene.json", "scene.json");
    BundleAssets bundle = bundle_at(blobs);
    const auto there = load_scene(bundle, "scene.json", "scene.json");
    EXPECT_TRUE(here.has_value() && there.has_value());
    if (!here || !there) return 99;
    EXPECT_EQ(here->textures.size(), there->textures.size());
    EXPECT_EQ(here->materials.size(), there->materials.size());
    EXPECT_EQ(here->warnings, there->warnings);
    return here->textures.size();
  }

  fs::path folder_;
};

TEST_F(OtherProgramsInFolder, FilesAreFoundInAnotherCaseOfLetters) {
  write("maps/wood.png", gray_png());
  EXPECT_EQ(textures(), 1u);
  write("Maps/other.png", gray_png());  // the folder is there now, the file is still in the other one
  EXPECT_EQ(textures(), 1u);
}

TEST_F(OtherProgramsInFolder, FilesThatDifferInCaseAloneAreAmbiguous) {
  write("maps/wood.png", gray_png());
  write("maps/Wood.png", gray_png());
  EXPECT_EQ(textures(), 0u);
}

TEST_F(OtherProgramsInFolder, FilesAreFoundInOtherSpellings) {
  for (const std::string name : {"gr\xfcn.png", "gr%C3%BCn.png", "gru\xcc\x88n.png", "GR\xc3\xbcN.png"}) {
    write("gr\xc3\xbcn.png", gray_png());
    write("a.mtl", "newmtl a\nKd 1 1 1\nmap_Kd " + name + "\n");
    EXPECT_EQ(textures(), 1u) << name;
  }
}

TEST_F(OtherProgramsInFolder, TheCaseThatIsWrittenComesFirst) {
  write("maps/wood.png", gray_png());
  write("Maps/WOOD.PNG", gray_png());
  write("WOOD.PNG", gray_png());
  EXPECT_EQ(textures(), 1u);
}

}  // namespace
}  // namespace tessera::core::other_programs_test
