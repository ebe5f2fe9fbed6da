// SPDX-License-Identifier: Apache-2.0
// PLY and STL files: all encodings, types and names, and what is broken.
#include "core/scene/loader/mesh_file.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <libdeflate.h>

#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <string>
#include <utility>

#include "core/image/srgb.hpp"

namespace tessera::core {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using Triangle = std::array<std::uint32_t, 3>;

enum class Order { kLittle, kBig };

// Appends values as bytes in one order.
class Bytes {
 public:
  explicit Bytes(Order order, std::string begin = "") : order_(order), bytes_(std::move(begin)) {}

  template <typename T>
  Bytes& operator<<(T value) {
    const auto raw = std::bit_cast<std::array<char, sizeof(T)>>(value);
    std::string text(raw.begin(), raw.end());
    if ((order_ == Order::kBig) == (std::endian::native == std::endian::little))
      std::reverse(text.begin(), text.end());
    bytes_ += text;
    return *this;
  }
  const std::string& str() const { return bytes_; }

 private:
  Order order_;
  std::string bytes_;
};

MeshFile ply(const std::string& bytes, MeshAttributes attributes = MeshAttributes::kIgnore) {
  auto file = read_ply(bytes, "m.ply", {}, attributes);
  EXPECT_TRUE(file) << file.error().message;
  return file ? std::move(*file) : MeshFile();
}

std::string ply_error(const std::string& bytes, const SceneLimit& limit = {}) {
  const auto file = read_ply(bytes, "m.ply", limit);
  return file ? "" : file.error().message;
}

constexpr const char* kAsciiTriangle =
    "ply\nformat ascii 1.0\ncomment a triangle\nelement vertex 3\nproperty float x\nproperty float y\n"
    "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
    "0 0 0\n1 0 0\n0 1.5 1e-3\n3 0 1 2\n";

TEST(Ply, ReadsText) {
  const MeshFile file = ply(kAsciiTriangle);
  EXPECT_THAT(file.mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{1, 0, 0}, Vec3{0, 1.5f, 1e-3f}));
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
  EXPECT_THAT(file.mesh.triangle_materials, ElementsAre(0u));
  EXPECT_THAT(file.mesh.normals, IsEmpty());
  EXPECT_TRUE(file.warnings.empty());
}

TEST(Ply, ReadsBinaryFilesOfBothByteOrders) {
  for (const Order order : {Order::kLittle, Order::kBig}) {
    const std::string name = order == Order::kBig ? "binary_big_endian" : "binary_little_endian";
    Bytes bytes(order, "ply\nformat " + name +
                           " 1.0\nelement vertex 4\nproperty float x\nproperty double y\n"
                           "property float32 z\nproperty float nx\nproperty float ny\nproperty float nz\n"
                           "property float s\nproperty float t\nelement face 2\n"
                           "property uchar flags\nproperty list uint8 uint32 vertex_index\nend_header\n");
    for (float i = 0; i < 4; ++i)
      bytes << i << double{i * i} << 0.25f << 0.0f << 0.0f << 1.0f << i / 4 << 1 - i / 4;
    bytes << std::uint8_t{7} << std::uint8_t{3} << 0u << 1u << 2u;
    bytes << std::uint8_t{7} << std::uint8_t{3} << 0u << 2u << 3u;
    const MeshFile file = ply(bytes.str());
    ASSERT_EQ(file.mesh.positions.size(), 4u) << name;
    EXPECT_EQ(file.mesh.positions[3], (Vec3{3, 9, 0.25f})) << name;
    EXPECT_EQ(file.mesh.normals[2], (Vec3{0, 0, 1})) << name;
    EXPECT_EQ(file.mesh.uvs[1], (Vec2{0.25f, 0.75f})) << name;
    EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3})) << name;
    EXPECT_THAT(file.warnings.messages("m.ply"),
                ElementsAre("m.ply: the property 'flags' of 'face' is not used"))
        << name;
  }
}

// A quad with extra text in the vertex element's properties and rows.
std::string quad_with(const std::string& properties, const std::string& values) {
  const std::string end = " " + values + "\n";
  return "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n" +
         properties + "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0" + end +
         "1 0 0" + end + "1 1 0" + end + "0 1 0" + end + "4 0 1 2 3\n";
}

TEST(Ply, TriangulatesPolygons) {
  EXPECT_THAT(ply(quad_with("", "")).mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 2, 3}));
}

TEST(Ply, KnowsTheUsualNamesOfTextureCoordinates) {
  for (const auto& [u, v] : {std::pair("u", "v"), std::pair("s", "t"), std::pair("texture_u", "texture_v"),
                             std::pair("texture_s", "texture_t")}) {
    const std::string names = std::string("property float ") + u + "\nproperty float " + v + "\n";
    EXPECT_THAT(ply(quad_with(names, "0.5 2")).mesh.uvs,
                ElementsAre(Vec2{0.5f, 2}, Vec2{0.5f, 2}, Vec2{0.5f, 2}, Vec2{0.5f, 2}))
        << u;
  }
}

TEST(Ply, ReadsSecondTextureCoordinatesBesideFirstOnes) {
  const std::string second = "property float u1\nproperty float v1\n";
  const MeshFile both = ply(quad_with("property float u\nproperty float v\n" + second, "0.5 2 7 8"));
  EXPECT_EQ(both.mesh.uvs.at(1), (Vec2{0.5f, 2}));
  EXPECT_EQ(both.mesh.second_uvs.at(3), (Vec2{7, 8}));
  const MeshFile alone = ply(quad_with(second, "7 8"));
  EXPECT_THAT(alone.mesh.second_uvs, IsEmpty());
  EXPECT_THAT(alone.warnings.messages("m.ply").at(0), HasSubstr("the property 'u1' of 'vertex' is not used"));
}

TEST(Ply, ReadsTangentsAndTheirHandedness) {
  const std::string direction = "property float tx\nproperty float ty\nproperty float tz\n";
  EXPECT_EQ(ply(quad_with(direction, "0.5 2 1")).mesh.tangents.at(3), (VertexTangent{{0.5f, 2, 1}, 1}));
  EXPECT_EQ(ply(quad_with(direction + "property float tw\n", "0.5 2 1 -1")).mesh.tangents.at(0),
            (VertexTangent{{0.5f, 2, 1}, -1}));
  const MeshFile alone = ply(quad_with("property float tw\n", "-1"));
  EXPECT_THAT(alone.mesh.tangents, IsEmpty());
  EXPECT_THAT(alone.warnings.messages("m.ply").at(0), HasSubstr("the property 'tw' of 'vertex' is not used"));
}

TEST(Ply, ReadsByteColorsAsSrgbAndFloatsAsLinear) {
  const MeshFile bytes =
      ply(quad_with("property uchar red\nproperty uchar green\nproperty uchar blue\n", "255 0 188"));
  EXPECT_EQ(bytes.mesh.colors.at(0), (Rgb{1, 0, srgb_decode(std::uint8_t{188})}));
  const MeshFile floats = ply(quad_with("property float r\nproperty float g\nproperty float b\n", "1 0 0.5"));
  EXPECT_EQ(floats.mesh.colors.at(3), (Rgb{1, 0, 0.5f}));
}

TEST(Ply, ReadsBytesInWideIntegersAsBytes) {
  for (const std::string type : {"int", "uint", "short", "ushort"}) {
    const std::string properties =
        "property " + type + " red\nproperty " + type + " green\nproperty " + type + " blue\n";
    EXPECT_EQ(ply(quad_with(properties, "255 0 188")).mesh.colors.at(0),
              (Rgb{1, 0, srgb_decode(std::uint8_t{188})}))
        << type;
  }
  const std::string wide = "property ushort red\nproperty ushort green\nproperty ushort blue\n";
  EXPECT_EQ(ply(quad_with(wide, "65535 0 255")).mesh.colors.at(0), (Rgb{1, 0, srgb_decode(255 / 65535.0)}));
}

TEST(Ply, IgnoresHalfOfAPair) {
  const MeshFile file = ply(quad_with("property float u\nproperty float nx\n", "0 0"));
  EXPECT_THAT(file.mesh.uvs, IsEmpty());
  EXPECT_THAT(file.mesh.normals, IsEmpty());
}

TEST(Ply, KeepsOtherPropertiesOnRequest) {
  const MeshFile file = ply(quad_with("property float heat\n", "0.25"), MeshAttributes::kKeep);
  ASSERT_EQ(file.attributes.size(), 1u);
  EXPECT_EQ(file.attributes[0].name, "heat");
  EXPECT_THAT(file.attributes[0].values, ElementsAre(0.25f, 0.25f, 0.25f, 0.25f));
}

TEST(Ply, ReadsValuesOfFacesForEachOfTheirTriangles) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 2\nproperty list uchar int vertex_indices\nproperty int material_index\n"
      "property float face_id\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3 5 0.5\n3 0 1 2 2 1.5\n";
  const MeshFile file = ply(text, MeshAttributes::kKeep);
  EXPECT_THAT(file.mesh.triangle_materials, ElementsAre(5u, 5u, 2u));
  ASSERT_EQ(file.attributes.size(), 1u);
  EXPECT_TRUE(file.attributes[0].of_triangles);
  EXPECT_THAT(file.attributes[0].values, ElementsAre(0.5f, 0.5f, 1.5f));
}

TEST(Ply, ReadsTextureCoordinatesOfCorners) {
  const std::string text =
      "ply\nformat ascii 1.0\ncomment TextureFile a b.png\ncomment TextureFile c.png\nelement vertex 4\n"
      "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\n"
      "property float nz\nelement face 2\nproperty list uchar int vertex_indices\n"
      "property list uchar float texcoord\nproperty int texnumber\nend_header\n0 0 0 0 0 1\n1 0 0 0 0 1\n"
      "1 1 0 0 0 1\n0 1 0 0 0 1\n3 0 1 2 6 0 0 1 0 1 1 1\n3 0 2 3 4 0 0 0.5 1 0\n";
  const MeshFile file = ply(text);
  EXPECT_THAT(file.images, ElementsAre("a b.png", "c.png"));
  EXPECT_THAT(file.triangle_images, ElementsAre(1u, 0u));
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{0, 4, 3}));
  EXPECT_THAT(file.mesh.uvs, ElementsAre(Vec2{0, 0}, Vec2{1, 0}, Vec2{1, 1}, Vec2{0, 0}, Vec2{0.5f, 1}));
  EXPECT_EQ(file.mesh.positions.at(4), file.mesh.positions[2]);
  EXPECT_EQ(file.mesh.normals.size(), 5u);
  EXPECT_THAT(file.warnings.messages("m.ply"),
              ElementsAre("m.ply: face 2 has 2 texture coordinates for 3 corners; the others are 0 0"));
  EXPECT_THAT(ply(text, MeshAttributes::kKeep).mesh.uvs, IsEmpty());
}

TEST(Ply, ReadsTriangleStrips) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 5\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\nend_header\n0 0 0\n1 0 0\n1 1 0\n0 1 0\n"
      "2 2 0\n8 0 1 2 3 -1 2 3 4\n";
  EXPECT_THAT(ply(text).mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{2, 1, 3}, Triangle{2, 3, 4}));
}

TEST(Ply, MayHaveFacesBeforeVertices) {
  const MeshFile file =
      ply("ply\nformat ascii 1.0\nelement face 1\nproperty list uchar int vertex_indices\nelement vertex 3\n"
          "property float x\nproperty float y\nproperty float z\nend_header\n3 0 1 2\n0 0 0\n1 0 0\n0 1 0\n");
  EXPECT_EQ(file.mesh.positions.size(), 3u);
  EXPECT_THAT(file.mesh.triangles, ElementsAre(Triangle{0, 1, 2}));
}

TEST(Ply, HasFacesBesideStrips) {
  const std::string text =
      "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
      "element tristrips 1\nproperty list int int vertex_indices\n"
      "element face 1\nproperty list uchar int vertex_indices\nproperty int material_index\n"
      "property float heat\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n"
      "0 0 0\n1 0 0\n1 1 0\n0 1 0\n4 0 1 2 3\n3 0 1 2 7 0.5\n3 0 1 2\n";
  const MeshFile file = ply(text, MeshAttributes::kKeep);
  EXPECT_EQ(file.mesh.triangles.size(), 4u);
  EXPECT_THAT(file.mesh.triangle_materials, ElementsAre(0u, 0u, 7u, 0u));
  ASSERT_EQ(file.attributes.size(), 1u);
  EXPECT_THAT(file.attributes[0].values, ElementsAre(0, 0, 0.5f, 0));
}

TEST(Ply, DecompressesGzip) {
  const std::string text = kAsciiTriangle;
  std::string packed(1000, '\0');
  libdeflate_compressor* compressor = libdeflate_alloc_compressor(6);
  packed.resize(libdeflate_gzip_compress(compressor, text.data(), text.size(), packed.data(), packed.size()));
  libdeflate_free_compressor(compressor);
  EXPECT_EQ(ply(packed).mesh.positions.size(), 3u);
  EXPECT_THAT(ply_error(packed.substr(0, packed.size() - 9)), HasSubstr("'m.ply' "));
}

TEST(Ply, SaysWhatIsBroken) {
  EXPECT_EQ(ply_error("solid"), "'m.ply' is no PLY file: it does not begin with 'ply'");
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\n"), HasSubstr("'end_header' is missing"));
  EXPECT_THAT(ply_error("ply\nformat odd 1.0\n"), HasSubstr("line 2: there is no format 'odd'"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty half x\n"),
              HasSubstr("line 4: there is no type 'half'"));
  std::string text = kAsciiTriangle;
  EXPECT_THAT(ply_error(text.substr(0, text.size() - 3)),
              HasSubstr("it ends in row 1 of 'face', which says that it has 3 corners"));
  text.replace(text.find("1.5"), 3, "1,5");
  EXPECT_THAT(ply_error(text), HasSubstr("a row of 'vertex' has something else than numbers"));
  EXPECT_THAT(ply_error("ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                        "property float z\nend_header\n0 0 0\n"),
              HasSubstr("has no faces"));
}

TEST(Ply, RefusesRowsThatCannotBeThereBeforeItTakesMemory) {
  const std::string header =
      "ply\nformat binary_little_endian 1.0\nelement vertex 4000000000\nproperty float x\nproperty float y\n"
      "property float z\nelement face 1\nproperty list uchar int vertex_indices\nend_header\n";
  EXPECT_THAT(ply_error(header + "0123"), HasSubstr("too short for the 4000000000 rows of 'vertex'"));
  std::string text = kAsciiTriangle;
  text.replace(text.find("3 0 1 2"), 1, "300000000");
  EXPECT_EQ(ply_error(text),
            "'m.ply' is a broken PLY file (it ends in row 1 of 'face', which says that it has 300000000 "
            "corners)");
}

TEST(Ply, KeepsWithinTheLimit) {
  EXPECT_EQ(ply_error(quad_with("", ""), {.most = 1, .option = "--triangles"}),
            "'m.ply' has more than the 1 triangles that a scene may have here (--triangles)");
  EXPECT_EQ(ply_error(quad_with("", ""), {.most = 2, .option = "--triangles"}), "");
}

TEST(Ply, LeavesOutFacesThatCannotBeUsed) {
  std::string text = quad_with("", "");
  text.replace(text.find("element face 1"), 14, "element face 6");
  const MeshFile file = ply(text + "4 0 1 2 9\n3 0 1 4\n3 0 1 -1\n2 0 1\n1 0\n");
  EXPECT_EQ(file.mesh.triangles.size(), 2u);
  EXPECT_THAT(
      file.warnings.messages("m.ply"),
      ElementsAre(
          "m.ply: face 2 names a vertex that is not there: the file has 4, counted from 0; it is left "
          "out (3 faces)",
          "m.ply: face 5 must have at least 3 corners, got 2; it is left out (2 faces)"));
}

TEST(Ply, SaysWhyNoFaceIsLeft) {
  std::string text = quad_with("", "");
  text.replace(text.find("4 0 1 2 3"), 1, "-4");
  EXPECT_EQ(ply_error(text),
            "'m.ply' has no face that can be used; the first: face 1 must have at least 3 corners, got -4");
}

TEST(Ply, ReadsAByteOrderMark) {
  EXPECT_EQ(ply("\xef\xbb\xbf" + quad_with("", "")).mesh.triangles.size(), 2u);
}

std::string stl_error(const std::string& bytes) {
  const auto file = read_stl(bytes, "m.stl");
  return file ? "" : file.error().message;
}

TEST(Stl, ReadsTextAndMergesEqualCorners) {
  const std::string text =
      "solid part\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n"
      "  endloop\n endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 1 0 0\n   vertex 1 1 0\n"
      "   vertex -0 1 0\n  endloop\n endfacet\nendsolid part\n";
  const auto file = read_stl(text, "m.stl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.triangles, ElementsAre(Triangle{0, 1, 2}, Triangle{1, 3, 2}));
  EXPECT_EQ(file->mesh.positions.size(), 4u);
}

TEST(Stl, ReadsBinaryFilesAlsoIfTheyBeginWithSolid) {
  Bytes bytes(Order::kLittle, "solid of a program that does not know better" + std::string(36, ' '));
  bytes << 1u;
  for (const float value : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 0.0f, 2.0f, 0.0f, 0.0f, 0.0f, 3.0f, 0.5f})
    bytes << value;
  bytes << std::uint16_t{0};
  const auto file = read_stl(bytes.str(), "m.stl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_THAT(file->mesh.positions, ElementsAre(Vec3{0, 0, 0}, Vec3{2, 0, 0}, Vec3{0, 3, 0.5f}));
  std::string cut = bytes.str().substr(0, bytes.str().size() - 1);
  cut[0] = 'S';
  EXPECT_EQ(stl_error(cut), "'m.stl' is a broken STL file (it ends too early)");
  cut[0] = 's';
  EXPECT_EQ(stl_error(cut), "'m.stl' is a broken STL file (it ends too early)");
  EXPECT_EQ(stl_error(bytes.str() + "\n\n"), "");
}

// Two triangles with a common edge.
std::string stl_with(const std::string& header, std::uint16_t first, std::uint16_t second) {
  Bytes bytes(Order::kLittle, header + std::string(80 - header.size(), '\0'));
  bytes << 2u;
  const auto add = [&bytes](const std::array<float, 9>& corners, std::uint16_t attributes) {
    bytes << 0.0f << 0.0f << 1.0f;
    for (const float value : corners) bytes << value;
    bytes << attributes;
  };
  add({0, 0, 0, 1, 0, 0, 1, 1, 0}, first);
  add({0, 0, 0, 1, 1, 0, 0, 1, 0}, second);
  return bytes.str();
}

std::vector<Rgb> stl_colors_of(const std::string& header, std::uint16_t first, std::uint16_t second) {
  const auto file = read_stl(stl_with(header, first, second), "m.stl");
  EXPECT_TRUE(file) << file.error().message;
  if (!file || file->mesh.colors.empty()) return {};
  const auto& [a, b] = std::pair(file->mesh.triangles[0], file->mesh.triangles[1]);
  return {file->mesh.colors.at(a[0]), file->mesh.colors.at(b[0])};
}

TEST(Stl, ReadsColoursOfFacets) {
  EXPECT_THAT(stl_colors_of("COLOR=\xff\xff\x01\xff,MATERIAL=", 0x8000, 31),
              ElementsAre(Rgb{1, 1, srgb_decode(std::uint8_t{1})}, Rgb{1, 0, 0}));
  EXPECT_THAT(stl_colors_of("VCG", 0x8000 | 31 << 10, 0x8000 | 31), ElementsAre(Rgb{1, 0, 0}, Rgb{0, 0, 1}));
  EXPECT_THAT(stl_colors_of("", 0x8000 | 31 << 5, 0), ElementsAre(Rgb{0, 1, 0}, Rgb::gray(0.5f)));
  EXPECT_THAT(stl_colors_of("", 0, 0), IsEmpty());
  EXPECT_THAT(stl_colors_of("", 0x8123, 0x0042), IsEmpty()) << "other programs leave any bytes there";
  EXPECT_EQ(read_stl(stl_with("", 0x8001, 0x8001), "m.stl").value().mesh.positions.size(), 4u);
}

TEST(Stl, ReadsTheWholeTrianglesOfBinaryFilesThatEndTooEarly) {
  const std::string whole = stl_with("", 0, 0);
  const auto file = read_stl(whole.substr(0, whole.size() - 20), "m.stl");
  ASSERT_TRUE(file) << file.error().message;
  EXPECT_EQ(file->mesh.triangles.size(), 1u);
  EXPECT_THAT(file->warnings.messages("m.stl"),
              ElementsAre("m.stl: ends after 1 of its 2 triangles: a part of the mesh is missing"));
  std::string mostly = whole;
  mostly[80] = 21;
  EXPECT_EQ(stl_error(mostly), "'m.stl' is a broken STL file (it ends too early)");
}

constexpr std::string_view kTextFacet =
    "facet normal 0 0 1\nouter loop\nvertex 0 0 0\nvertex 1 0 0\nvertex 0 1 0\nendloop\nendfacet\n";

std::vector<std::string> stl_warnings(const std::string& bytes) {
  const auto file = read_stl(bytes, "m.stl");
  EXPECT_TRUE(file) << file.error().message;
  if (!file) return {};
  EXPECT_EQ(file->mesh.triangles.size(), 1u);
  return file->warnings.messages("m.stl");
}

TEST(Stl, WarnsOfTextThatEndsTooEarly) {
  const std::string facet(kTextFacet);
  const auto is_told = ElementsAre("m.stl: ends without 'endsolid': a part of the mesh may be missing");
  EXPECT_THAT(stl_warnings("solid a\n" + facet + "endsolid a\n"), IsEmpty());
  EXPECT_THAT(stl_warnings("solid a\n" + facet), is_told);
  EXPECT_THAT(stl_warnings("solid a\n" + facet + "f"), is_told);
  EXPECT_THAT(stl_warnings("solid a\n" + facet + "facet normal 0 0 1\nouter loop\nvertex 0 1"), is_told);
  EXPECT_THAT(stl_warnings(facet + "facet normal 0 0 1\n"), is_told);
}

TEST(Stl, ReadsOtherSpellingsOfText) {
  const std::string facet(kTextFacet);
  EXPECT_THAT(stl_warnings(facet), IsEmpty());
  EXPECT_THAT(stl_warnings(facet + "endsolid\n"), IsEmpty());
  EXPECT_THAT(stl_warnings("\xef\xbb\xbfsolid a\n" + facet + "endsolid a\n"), IsEmpty());
  EXPECT_THAT(stl_warnings("\n  solid a\n" + facet + "endsolid a\n"), IsEmpty());
  std::string upper = "solid a\n" + facet + "endsolid a\n";
  for (char& c : upper)
    if (c >= 'a' && c <= 'z') c = static_cast<char>(c - 'a' + 'A');
  EXPECT_THAT(stl_warnings(upper), IsEmpty());
}

TEST(Stl, ReadsTrianglesThatShareNoCorner) {
  for (const std::uint32_t count : {3u, 7u, 100u}) {
    Bytes bytes(Order::kLittle, std::string(80, ' '));
    bytes << count;
    float x = 0;
    for (std::uint32_t i = 0; i < count; ++i) {
      for (int k = 0; k < 12; ++k) bytes << ++x;
      bytes << std::uint16_t{0};
    }
    const auto file = read_stl(bytes.str(), "m.stl");
    ASSERT_TRUE(file) << file.error().message;
    EXPECT_EQ(file->mesh.positions.size(), 3 * count);
  }
}

TEST(Stl, SaysWhatIsBroken) {
  EXPECT_THAT(stl_error("solid a\nfacet\nvertex 1 2\n"), HasSubstr("line 3: 'vertex' needs three numbers"));
  EXPECT_THAT(stl_error("facet\nouter loop\nvertex 1 2 3\nendloop\n"), HasSubstr("line 4: a loop needs"));
  EXPECT_EQ(stl_error("solid a\nendsolid a\n"), "'m.stl' has no triangles");
}

}  // namespace
}  // namespace tessera::core
