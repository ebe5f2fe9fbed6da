// SPDX-License-Identifier: Apache-2.0
// Inputs that people met in the wild, where they are at hand: what the loaded scenes are. Numbers are those
// of the folders. shared_cases_render_test.cpp renders some of them; 25 and 26 are about processes, which
// tests/unit/client/scarcity_test.cpp and tests/integration/disk_faults_test.cpp run with inputs of their
// own.
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "core/scene/loader/loader.hpp"
#include "core/scene/validation.hpp"

namespace tessera::core::shared_cases_test {
namespace {

namespace fs = std::filesystem;
using testing::Contains;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::SizeIs;

const fs::path kFolder = TESSERA_SOURCE_DIR "/../shared/cases";

// All numbers.
constexpr std::array kCases{"01", "02", "03", "04", "05", "06", "08", "09", "10", "11",
                            "13", "15", "17", "18", "19", "22", "25", "26", "29"};

std::vector<fs::path> scenes_of(const std::string& number) {
  std::vector<fs::path> scenes;
  for (const auto& entry : fs::recursive_directory_iterator(kFolder))
    if (entry.path().extension() == ".json" &&
        fs::relative(entry.path(), kFolder).string().starts_with(number + "-"))
      scenes.push_back(entry.path());
  std::sort(scenes.begin(), scenes.end());
  return scenes;
}

class SharedCases : public testing::TestWithParam<const char*> {
 protected:
  void SetUp() override {
    if (!fs::exists(kFolder)) GTEST_SKIP() << kFolder << " is not there";
  }
};

TEST_P(SharedCases, AreValidScenes) {
  const auto scenes = scenes_of(GetParam());
  ASSERT_FALSE(scenes.empty());
  for (const fs::path& path : scenes) {
    const auto scene = load_scene_file(path.string());
    ASSERT_TRUE(scene.has_value()) << path << ": " << scene.error().message;
    EXPECT_TRUE(validate_scene(*scene).has_value()) << path;
  }
}

INSTANTIATE_TEST_SUITE_P(Numbers, SharedCases, testing::ValuesIn(kCases));

// One scene of a case: a floor, and the mesh of a file.
class SharedCase : public testing::Test {
 protected:
  void SetUp() override {
    if (!fs::exists(kFolder)) GTEST_SKIP() << kFolder << " is not there";
  }

  // The scene in the folder called `name`, or with more after a hyphen, in the case of this number.
  void load(const std::string& number, const std::string& name) {
    scene_ = {};
    SCOPED_TRACE(number + "/" + name);
    for (const fs::path& path : scenes_of(number)) {
      const std::string folder = path.parent_path().filename().string();
      if ((folder != name && !folder.starts_with(name + "-")) || path.filename() != "scene.json") continue;
      auto scene = load_scene_file(path.string());
      ASSERT_TRUE(scene.has_value()) << scene.error().message;
      scene_ = std::move(*scene);
      return;
    }
    FAIL() << "there is no such scene";
  }

  const MeshDescription& mesh() const { return std::get<MeshDescription>(scene_.shapes.back()); }
  const Material& material(std::size_t triangle = 0) const {
    const auto& materials = mesh().triangle_materials;
    return scene_.materials.at(materials.size() == 1 ? materials[0] : materials.at(triangle));
  }
  template <typename Model>
  const Model& model(std::size_t triangle = 0) const {
    return std::get<Model>(material(triangle).model);
  }
  const TextureImage& image(int texture) const {
    return *scene_.textures.at(static_cast<std::size_t>(texture)).image;
  }
  // The colours of the image that most cases have: red in its upper left corner, green in the right one.
  void expect_test_image(int texture, float tolerance = 0.02f) const {
    ASSERT_GE(texture, 0);
    const TextureImage& found = image(texture);
    ASSERT_EQ(found.width(), 64);
    ASSERT_EQ(found.height(), 64);
    expect_near(found.texel(0, 0), {0.7157f, 0.013f, 0.013f}, tolerance);
    expect_near(found.texel(63, 0), {0.013f, 0.5776f, 0.013f}, tolerance);
  }
  static void expect_near(Rgb actual, Rgb expected, float tolerance) {
    EXPECT_NEAR(actual.r, expected.r, tolerance);
    EXPECT_NEAR(actual.g, expected.g, tolerance);
    EXPECT_NEAR(actual.b, expected.b, tolerance);
  }

  SceneDescription scene_;
};

TEST_F(SharedCase, FacesWithoutUsemtlGetTheDefaultMaterial) {
  ASSERT_NO_FATAL_FAILURE(load("01", "10"));
  for (std::size_t triangle = 0; triangle < 12; ++triangle)
    EXPECT_EQ(model<Lambert>(triangle).albedo.value, Rgb::gray(0.5f));
  EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("(12 triangles)")));
  ASSERT_NO_FATAL_FAILURE(load("01", "11"));
  EXPECT_EQ(model<Lambert>(0).albedo.value, Rgb::gray(0.5f));
  expect_test_image(model<Lambert>(4).albedo.texture);
  EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("(4 triangles)")));
}

TEST_F(SharedCase, MissingLibrariesAndMaterialsAreReplaced) {
  ASSERT_NO_FATAL_FAILURE(load("02", "12"));
  EXPECT_EQ(model<Lambert>().albedo.value, Rgb::gray(0.5f));
  EXPECT_THAT(scene_.warnings, Contains(HasSubstr("does not exist")));
  ASSERT_NO_FATAL_FAILURE(load("02", "13"));
  EXPECT_EQ(model<Lambert>().albedo.value, Rgb::gray(0.5f));
  EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("there is no material 'b'")));
  ASSERT_NO_FATAL_FAILURE(load("02", "359c"));
  EXPECT_EQ(model<Lambert>().albedo.value, (Rgb{0.5f, 0.1f, 0.5f}));
  EXPECT_THAT(scene_.warnings, SizeIs(1));
}

TEST_F(SharedCase, TexturesAreFoundOrLeftOut) {
  ASSERT_NO_FATAL_FAILURE(load("03", "17"));
  EXPECT_EQ(model<Lambert>().albedo.value, (Rgb{1, 0.5f, 0.2f}));
  EXPECT_EQ(model<Lambert>().albedo.texture, -1);
  EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("stone_wall_diffuse_2k.png'")));
  for (const auto name : {"18", "19"}) {
    ASSERT_NO_FATAL_FAILURE(load("03", name));
    expect_test_image(model<Lambert>().albedo.texture);
    EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("is used"))) << name;
  }
  ASSERT_NO_FATAL_FAILURE(load("03", "84"));
  expect_test_image(model<Lambert>().albedo.texture);
  EXPECT_THAT(scene_.warnings, IsEmpty());
  for (const auto name : {"359d", "359e"}) {
    ASSERT_NO_FATAL_FAILURE(load("03", name));
    EXPECT_EQ(model<Lambert>().albedo.value, (Rgb{0.5f, 0.1f, 0.5f})) << name;
    EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("is used"))) << name;
  }
}

TEST_F(SharedCase, TexturesOfOtherFormatsAreReadOrLeftOut) {
  for (const std::string format : {"bmp", "tga", "tif", "webp"}) {
    ASSERT_NO_FATAL_FAILURE(load("04", "118-" + format));
    expect_test_image(model<Lambert>().albedo.texture, format == "webp" ? 0.1f : 0.02f);
    EXPECT_THAT(scene_.warnings, IsEmpty()) << format;
  }
  for (const std::string format : {"dds", "gif"}) {
    ASSERT_NO_FATAL_FAILURE(load("04", "118-" + format));
    EXPECT_EQ(model<Lambert>().albedo.texture, -1) << format;
    EXPECT_THAT(scene_.warnings, testing::ElementsAre(HasSubstr("the map is ignored"))) << format;
  }
}

TEST_F(SharedCase, MetalsOfBlenderHaveColorAndRoughness) {
  ASSERT_NO_FATAL_FAILURE(load("05", "70"));
  EXPECT_EQ(model<Principled>().base_color.value, (Rgb{0.8f, 0.1f, 0.1f}));
  expect_test_image(model<Principled>().base_color.texture);
  EXPECT_EQ(model<Principled>().base_metalness.value, 0.2f);
  EXPECT_EQ(model<Principled>().specular_roughness.value, 0.8f);
  ASSERT_NO_FATAL_FAILURE(load("05", "71"));
  EXPECT_EQ(model<Principled>().base_color.value, (Rgb{0.9f, 0.6f, 0.2f}));
  EXPECT_EQ(model<Principled>().base_metalness.value, 1);
  EXPECT_EQ(model<Principled>().specular_roughness.value, 0.6f);
  EXPECT_THAT(scene_.warnings, IsEmpty());
}

TEST_F(SharedCase, TheDefaultMaterialOfBlenderReflectsFourPercent) {
  for (const auto name : {"420", "421", "423"}) {
    ASSERT_NO_FATAL_FAILURE(load("06", name));
    const auto& paint = model<CookTorrance>();
    expect_near(paint.diffuse.value, Rgb::gray(0.8f), 1e-6f);
    expect_near(paint.f0.value, Rgb::gray(0.04f), 1e-6f);
    EXPECT_NEAR(paint.roughness.value, 0.5f, 1e-6f) << name;
    EXPECT_EQ(paint.diffuse.texture >= 0, std::string(name) != "420");
  }
}

TEST_F(SharedCase, CutoutsAreTransparentOutsideTheMask) {
  for (const auto name : {"74", "74b", "75"}) {
    ASSERT_NO_FATAL_FAILURE(load("08", name));
    const ScalarParameter opacity = material().opacity;
    EXPECT_EQ(opacity.value, 1) << name;
    ASSERT_GE(opacity.texture, 0) << name;
    EXPECT_EQ(image(opacity.texture).texel(0, 0).r, 0) << name;
    EXPECT_EQ(image(opacity.texture).texel(32, 32).r, 1) << name;
    EXPECT_GE(model<Lambert>().albedo.texture, 0) << name;
    EXPECT_THAT(scene_.warnings, IsEmpty()) << name;
  }
}

TEST_F(SharedCase, EmissionHasItsMap) {
  ASSERT_NO_FATAL_FAILURE(load("09", "45"));
  EXPECT_EQ(material().emission.value, Rgb::gray(1));
  expect_test_image(material().emission.texture);
}

TEST_F(SharedCase, NormalBumpAndSpecularMapsAreUsed) {
  ASSERT_NO_FATAL_FAILURE(load("10", "79"));
  EXPECT_GE(material().normal_map.texture, 0);
  ASSERT_NO_FATAL_FAILURE(load("10", "80"));
  EXPECT_GE(material().bump.texture, 0);
  EXPECT_GT(material().bump.height, 0);
  ASSERT_NO_FATAL_FAILURE(load("10", "87"));
  EXPECT_GE(model<CookTorrance>().f0.texture, 0);
  EXPECT_THAT(scene_.warnings, IsEmpty());
}

TEST_F(SharedCase, VerticesHaveTheirColors) {
  ASSERT_NO_FATAL_FAILURE(load("11", "78"));
  EXPECT_EQ(model<Lambert>().albedo.value, Rgb::gray(1));
  ASSERT_EQ(mesh().colors.size(), mesh().positions.size());
  // The cube's corners have the colours of its position.
  for (std::size_t i = 0; i < mesh().colors.size(); ++i) {
    const Vec3 p = mesh().positions[i];
    EXPECT_EQ(mesh().colors[i], (Rgb{(p.x + 1) / 2, p.y / 2, (p.z + 1) / 2}));
  }
}

TEST_F(SharedCase, CornersMayLackAnyPart) {
  for (const auto name : {"02", "03", "04"}) {
    ASSERT_NO_FATAL_FAILURE(load("13", name));
    EXPECT_THAT(mesh().triangles, SizeIs(12)) << name;
    EXPECT_EQ(mesh().uvs.empty(), std::string(name) == "02") << name;
  }
}

TEST_F(SharedCase, ValuesThatAreNoNumbersCostNoMoreThanThemselves) {
  for (const auto name : {"05", "06", "07", "08", "48"}) {
    ASSERT_NO_FATAL_FAILURE(load("15", name));
    EXPECT_THAT(mesh().triangles, SizeIs(12)) << name;
    for (const Vec3 n : mesh().normals) EXPECT_NEAR(length(n), 1, 1e-5f) << name;
    for (const Vec2 uv : mesh().uvs) EXPECT_TRUE(std::isfinite(uv.x) && std::isfinite(uv.y)) << name;
    for (const Rgb c : mesh().colors) EXPECT_TRUE(is_finite(c)) << name;
    expect_test_image(model<Lambert>().albedo.texture);
  }
}

TEST_F(SharedCase, NumbersOutOfRangeAreClampedOrReplaced) {
  const std::pair<const char*, Rgb> cases[] = {
      {"20", {1, 0.8f, 0.8f}},        {"21", {1, 0.8f, 0.8f}},        {"22", {1, 0.8f, 0.8f}},
      {"23", {1, 0.8f, 0.8f}},        {"24", {1, 0.8f, 0.8f}},        {"26", {1, 0.8f, 0.8f}},
      {"27", {1, 0.8f, 0.8f}},        {"29", {1, 0.8f, 0.8f}},        {"30", Rgb::gray(0.5f)},
      {"127e", {1, 0.5f, 0.5f}},      {"127f", {1, 0.5f, 0.5f}},      {"400", Rgb::gray(0.64f)},
      {"402", {0.64f, 0.64f, 0.64f}}, {"408", {0.64f, 0.64f, 0.64f}}, {"409", {0.64f, 0.64f, 0.64f}}};
  for (const auto& [name, albedo] : cases) {
    ASSERT_NO_FATAL_FAILURE(load("17", name));
    EXPECT_EQ(model<Lambert>().albedo.value, albedo) << name;
    const bool has_image = name == std::string("20") || name[0] == '4';
    EXPECT_EQ(model<Lambert>().albedo.texture >= 0, has_image && name != std::string("402")) << name;
    EXPECT_FALSE(scene_.warnings.empty()) << name;
  }
}

TEST_F(SharedCase, LinesThatAreNotUnderstoodCostNoMoreThanThemselves) {
  for (const auto name :
       {"35", "36", "37", "38", "39", "41", "42", "43", "49", "403", "404", "405", "411", "412"}) {
    ASSERT_NO_FATAL_FAILURE(load("18", name));
    EXPECT_THAT(mesh().triangles, SizeIs(12)) << name;
  }
  for (const auto name : {"35", "37", "38", "39", "49"}) {
    ASSERT_NO_FATAL_FAILURE(load("18", name));
    EXPECT_FALSE(scene_.warnings.empty()) << name;
  }
}

TEST_F(SharedCase, JpegFilesWithStrayBytesAreRead) {
  for (const auto& [name, width] : {std::pair("361", 64), std::pair("364", 256), std::pair("165x", 512)}) {
    ASSERT_NO_FATAL_FAILURE(load("19", name));
    ASSERT_GE(model<Lambert>().albedo.texture, 0) << name;
    const TextureImage& found = image(model<Lambert>().albedo.texture);
    EXPECT_EQ(found.width(), width) << name;
    EXPECT_GT(max_component(found.mean()), 0.01f) << name;
  }
}

// All have the same sky of four colours, one for each quarter; 140 has these numbers as XYZ.
TEST_F(SharedCase, EnvironmentsOfAllFormatsHaveTheSameSky) {
  for (const auto name : {"132", "133", "134", "135", "136", "137", "139", "140", "150", "151"}) {
    SCOPED_TRACE(name);
    ASSERT_NO_FATAL_FAILURE(load("22", name));
    ASSERT_TRUE(scene_.environment.has_value());
    const TextureImage& sky = image(scene_.environment->radiance.texture);
    EXPECT_EQ(scene_.environment->radiance.value, Rgb::gray(1));
    EXPECT_TRUE(sky.width() == 64 || sky.width() == 200) << sky.width();
    const int right = sky.width() - 1, bottom = sky.height() - 1;
    if (name == std::string("140")) {
      expect_near(sky.texel(right, bottom), {1.309f, 0.727f, 0}, 0.02f);
      continue;
    }
    constexpr float kHigh = 0.797f, kLow = 0.098f;
    expect_near(sky.texel(0, 0), {kHigh, kLow, kLow}, 0.01f);
    expect_near(sky.texel(right, 0), {kLow, kHigh, kLow}, 0.01f);
    expect_near(sky.texel(0, bottom), {kLow, kLow, kHigh}, 0.01f);
    expect_near(sky.texel(right, bottom), {kHigh, kHigh, kLow}, 0.01f);
  }
}

// Twice the volume that a mesh encloses; negative if its triangles face inwards.
float enclosed_volume(const MeshDescription& mesh) {
  float sum = 0;
  for (const auto& [a, b, c] : mesh.triangles)
    sum += dot(mesh.positions[a], cross(mesh.positions[b], mesh.positions[c])) / 3;
  return sum;
}

TEST_F(SharedCase, WindingIsKeptWhateverTheNormals) {
  for (const auto name : {"67", "68", "89b"}) {
    ASSERT_NO_FATAL_FAILURE(load("29", name));
    EXPECT_GT(enclosed_volume(mesh()), 0) << name;
  }
  for (const auto name : {"69", "89c"}) {
    ASSERT_NO_FATAL_FAILURE(load("29", name));
    EXPECT_LT(enclosed_volume(mesh()), 0) << name;
  }
}

}  // namespace
}  // namespace tessera::core::shared_cases_test
