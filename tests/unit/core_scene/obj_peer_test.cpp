// SPDX-License-Identifier: Apache-2.0
// What tinyobjloader understands, we understand alike: files of triangles with every kind of corner, written
// in every way that both take.
#include <gtest/gtest.h>
#include <tiny_obj_loader.h>

#include <random>
#include <sstream>

#include "core/scene/loader/obj_reader.hpp"

namespace tessera::core {
namespace {

class ObjWriter {
 public:
  explicit ObjWriter(unsigned seed) : random_(seed), line_end_(pick({"\n", "\r\n", " \n", "\t\r\n"})) {}

  std::string write() {
    for (int i = 0; i < 3; ++i) add_vertices();
    for (int i = 0; i < 200; ++i) {
      const auto choice = random_() % 10;
      if (choice < 3) add_vertices();
      if (choice == 3) text_ += pick({"# comment", "", "s 1", "s off", "g a b", "o thing"}) + line_end_;
      add_face();
    }
    return text_;
  }

 private:
  std::string pick(const std::vector<std::string>& choices) { return choices[random_() % choices.size()]; }
  std::string number() {
    return std::to_string(static_cast<int>(random_() % 2000) - 1000) + pick({"", ".5", "e-2"});
  }

  void add_vertices() {
    const std::string gap = pick({" ", "  ", "\t"});
    text_ += "v" + gap + number() + gap + number() + gap + number() + line_end_;
    text_ += "vt" + gap + number() + gap + number() + line_end_;
    text_ += "vn" + gap + number() + gap + number() + gap + number() + line_end_;
    ++count_;
  }
  std::string index() {
    const int i = static_cast<int>(random_() % static_cast<unsigned>(count_));
    return std::to_string(random_() % 2 == 0 ? i + 1 : i - count_);
  }
  void add_face() {
    const auto kind = random_() % 4;
    text_ += "f";
    for (int k = 0; k < 3; ++k) {
      text_ += pick({" ", "  ", "\t"}) + index();
      if (kind == 1) text_ += "/" + index();
      if (kind == 2) text_ += "//" + index();
      if (kind == 3) text_ += "/" + index() + "/" + index();
    }
    text_ += line_end_;
  }

  std::mt19937 random_;
  std::string line_end_, text_;
  int count_ = 0;  // of each kind of vertex data
};

ObjFile::Corners corners_of_peer(const std::string& text) {
  tinyobj::attrib_t attributes;
  std::vector<tinyobj::shape_t> shapes;
  std::vector<tinyobj::material_t> materials;
  std::string warnings, errors;
  std::istringstream stream(text);
  EXPECT_TRUE(tinyobj::LoadObj(&attributes, &shapes, &materials, &warnings, &errors, &stream)) << errors;
  ObjFile::Corners corners;
  for (const auto& shape : shapes)
    for (const auto& index : shape.mesh.indices) {
      corners.positions.push_back(index.vertex_index);
      corners.uvs.push_back(index.texcoord_index);
      corners.normals.push_back(index.normal_index);
    }
  return corners;
}

TEST(ObjPeer, ReadsTheSameCorners) {
  for (unsigned seed = 0; seed < 100; ++seed) {
    const std::string text = ObjWriter(seed).write();
    const auto file = read_obj(text, "x.obj");
    ASSERT_TRUE(file.has_value()) << file.error().message;
    const ObjFile::Corners expected = corners_of_peer(text);
    ASSERT_EQ(file->corners.positions, expected.positions) << seed;
    ASSERT_EQ(file->corners.uvs, expected.uvs) << seed;
    ASSERT_EQ(file->corners.normals, expected.normals) << seed;
  }
}

}  // namespace
}  // namespace tessera::core
