// SPDX-License-Identifier: Apache-2.0
// Mitsuba's serialized meshes.
#include <gmock/gmock.h>

#include <cstring>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

template <typename T>
void append(std::string& bytes, T value) {
  bytes.append(reinterpret_cast<const char*>(&value), sizeof(T));
}

// A zlib stream of one stored block (RFC 1950, RFC 1951).
std::string stored(const std::string& content) {
  std::string bytes = "\x78\x01\x01";
  append(bytes, static_cast<std::uint16_t>(content.size()));
  append(bytes, static_cast<std::uint16_t>(~content.size()));
  bytes += content;
  std::uint32_t a = 1, b = 0;  // Adler-32
  for (const char c : content) {
    a = (a + static_cast<unsigned char>(c)) % 65521;
    b = (b + a) % 65521;
  }
  for (int shift = 24; shift >= 0; shift -= 8) bytes += static_cast<char>((b << 16 | a) >> shift);
  return bytes;
}

// A triangle at this height, of which the file says that it has so many vertices.
std::string triangle(float height, std::uint64_t vertices = 3) {
  std::string content;
  append(content, std::uint32_t{0x1002});  // floats, with texture coordinates
  content += std::string("name") + '\0';
  append(content, vertices);
  append(content, std::uint64_t{1});
  for (const float value : {0.0f, 0.0f, height, 1.0f, 0.0f, height, 0.0f, 1.0f, height})
    append(content, value);
  for (const float value : {0.0f, 0.0f, 1.0f, 0.0f, 0.0f, 1.0f}) append(content, value);
  for (const std::uint32_t corner : {0u, 1u, 2u}) append(content, corner);
  return content;
}

// A file of version 4 of these meshes.
std::string serialized(const std::vector<std::string>& meshes) {
  std::string bytes;
  std::vector<std::uint64_t> offsets;
  for (const std::string& mesh : meshes) {
    offsets.push_back(bytes.size());
    append(bytes, std::uint16_t{0x041c});
    append(bytes, std::uint16_t{4});
    bytes += stored(mesh);
  }
  for (const std::uint64_t offset : offsets) append(bytes, offset);
  append(bytes, static_cast<std::uint32_t>(offsets.size()));
  return bytes;
}

SceneDescription shape_of(const std::string& file, const std::string& index = "0") {
  return scene_of(
      "<shape type=\"serialized\"><string name=\"filename\" value=\"m.serialized\"/>"
      "<integer name=\"shape_index\" value=\"" +
          index + "\"/></shape>",
      {{"m.serialized", file}});
}

TEST(MitsubaSerialized, EachMeshIsReadByItsIndex) {
  const std::string file = serialized({triangle(1), triangle(2)});
  for (const int index : {0, 1}) {
    const SceneDescription scene = shape_of(file, std::to_string(index));
    ASSERT_EQ(scene.shapes.size(), 2u) << warnings_of(scene);
    const auto& mesh = std::get<MeshDescription>(scene.shapes[0]);
    ASSERT_EQ(mesh.positions.size(), 3u);
    EXPECT_EQ(mesh.positions[1], (Vec3{1, 0, index + 1.0f}));
    EXPECT_EQ(mesh.uvs[2], (Vec2{0, 1}));
  }
}

TEST(MitsubaSerialized, BrokenFilesAreTold) {
  EXPECT_THAT(warnings_of(shape_of("garbage")), HasSubstr("is no serialized mesh"));
  EXPECT_THAT(warnings_of(shape_of(serialized({triangle(1)}), "1")),
              HasSubstr("has no mesh number 1, but 1"));
  EXPECT_THAT(warnings_of(shape_of(serialized({triangle(1, 1000000000)}))), HasSubstr("fewer vertices"));
  const std::string file = serialized({triangle(1)});
  for (std::size_t size = 0; size < file.size(); ++size) shape_of(file.substr(0, size));
}

}  // namespace
}  // namespace tessera::core::test
