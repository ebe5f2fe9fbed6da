// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/mesh_builder.hpp"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/support/effort.hpp"
#include "tests/support/near.hpp"

namespace tessera::core {
namespace {

ObjFile file_of(const std::string& text) {
  auto file = read_obj(text, "x.obj");
  EXPECT_TRUE(file.has_value()) << file.error().message;
  return file ? std::move(*file) : ObjFile{};
}

MeshDescription mesh_of(const std::string& text, NormalsMode mode = NormalsMode::kFlat,
                        const Transform& transform = {}) {
  auto mesh = build_mesh(file_of(text), mode, transform, {0});
  EXPECT_TRUE(mesh.has_value()) << mesh.error().message;
  return mesh ? std::move(*mesh) : MeshDescription{};
}

Vec3 face_normal(const MeshDescription& mesh, std::size_t t) {
  const auto [a, b, c] = mesh.triangles[t];
  return normalize(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

// A cube from -1 to 1 with six quads, counter-clockwise from outside, without normals.
const std::string kCube =
    "v -1 -1 -1\nv 1 -1 -1\nv 1 1 -1\nv -1 1 -1\nv -1 -1 1\nv 1 -1 1\nv 1 1 1\nv -1 1 1\n"
    "f 4 3 2 1\nf 5 6 7 8\nf 1 2 6 5\nf 2 3 7 6\nf 3 4 8 7\nf 4 1 5 8\n";

// Two squares in the planes z = 0 and, turned up around the line x = 1, at `degrees` to it.
std::string folded_sheet(double degrees) {
  const double x = 1 + std::cos(degrees * M_PI / 180), z = std::sin(degrees * M_PI / 180);
  const std::string edge = std::to_string(x), height = std::to_string(z);
  return "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv " + edge + " 0 " + height + "\nv " + edge + " 1 " + height +
         "\nf 1 2 3 4\nf 2 5 6 3\n";
}

TEST(BuildMesh, UnifiesCornersIntoVertices) {
  const MeshDescription flat = mesh_of(kCube);
  EXPECT_EQ(flat.positions.size(), 8u);
  EXPECT_EQ(flat.triangles.size(), 12u);
  EXPECT_TRUE(flat.normals.empty());
  EXPECT_TRUE(flat.uvs.empty());
  EXPECT_EQ(flat.triangle_materials, (std::vector<std::uint32_t>{0}));
}

TEST(BuildMesh, SplitsVerticesWhereTextureCoordinatesDiffer) {
  const MeshDescription mesh =
      mesh_of("v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nvt 0 0\nvt 0.5 1\nf 1/1 2/1 3/1\nf 1/2 3/1 4\n");
  EXPECT_EQ(mesh.positions, (std::vector<Vec3>{{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 0, 0}, {0, 1, 0}}));
  EXPECT_EQ(mesh.uvs, (std::vector<Vec2>{{0, 0}, {0, 0}, {0, 0}, {0.5f, 1}, {0, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<std::array<std::uint32_t, 3>>{{0, 1, 2}, {3, 2, 4}}));
}

TEST(BuildMesh, UnifiesManyCorners) {
  std::string text;
  for (int i = 0; i < 2000; ++i)
    text +=
        "v " + std::to_string(i) + " 0 0\nv " + std::to_string(i) + " 1 0\nvt 0 " + std::to_string(i) + "\n";
  for (int i = 1; i < 3999; ++i)
    for (int side = 0; side < 2; ++side) {  // every face twice, back to back
      text += "f";
      for (int c = 0; c < 3; ++c) {
        const int v = side == 0 ? i + c : i + 2 - c;
        text += " " + std::to_string(v) + "/" + std::to_string(v % 2000 + 1);
      }
      text += "\n";
    }
  const MeshDescription mesh = mesh_of(text);
  EXPECT_EQ(mesh.positions.size(), 4000u);
  EXPECT_EQ(mesh.triangles.size(), 2u * 3998);
}

TEST(BuildMesh, LeavesOutTrianglesWithoutArea) {
  const MeshDescription mesh =
      mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 2 0 0\nf 1 2 4\nf 1 1 2\nf 1 2 3\nf 2 2 2\n");
  EXPECT_EQ(mesh.triangles.size(), 1u);
  const auto none = build_mesh(file_of("v 0 0 0\nv 1 0 0\nv 2 0 0\nf 1 2 3\n"), NormalsMode::kFile, {}, {0});
  ASSERT_FALSE(none.has_value());
  EXPECT_EQ(none.error().message, "has no face with an area greater than 0");
}

TEST(BuildMesh, LeavesOutTrianglesThatLieOnEarlierOnes) {
  const std::string square = "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nv 0 -0 0\n";
  using Triangles = std::vector<std::array<std::uint32_t, 3>>;
  EXPECT_EQ(mesh_of(square + "f 1 2 3 4\nf 1 2 3 4\n").triangles, (Triangles{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_EQ(mesh_of(square + "f 1 2 3\nf 3 1 2\nf 2 3 1\n").triangles.size(), 1u);
  EXPECT_EQ(mesh_of(square + "f 1 2 3\nf 5 2 3\n").triangles.size(), 1u);  // another vertex in the same place
  EXPECT_EQ(mesh_of(square + "f 1 2 3\nf 3 2 1\n").triangles.size(), 2u);  // the other side
  const auto mesh = build_mesh(file_of(square + "usemtl a\nf 1 2 3\nusemtl b\nf 1 2 3 4\n"),
                               NormalsMode::kFile, {}, {7, 9});
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->triangle_materials, (std::vector<std::uint32_t>{7, 9}));  // the first counts
}

TEST(BuildMesh, KeepsTheMaterialsOfTrianglesThatStay) {
  const ObjFile file =
      file_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nv 1 1 0\nusemtl a\nf 1 2 3\nf 1 1 1\nusemtl b\nf 2 4 3\n");
  const auto mesh = build_mesh(file, NormalsMode::kFile, {}, {7, 9});
  ASSERT_TRUE(mesh.has_value());
  EXPECT_EQ(mesh->triangle_materials, (std::vector<std::uint32_t>{7, 9}));
}

TEST(BuildMesh, UsesTheNormalsOfTheFile) {
  const std::string text = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 5\nvn 0 3 4\nf 1//1 2//2 3//1\n";
  const MeshDescription mesh = mesh_of(text, NormalsMode::kFile);
  expect_near(mesh.normals[0], {0, 0, 1}, 1e-6f);
  expect_near(mesh.normals[1], {0, 0.6f, 0.8f}, 1e-6f);
  EXPECT_TRUE(mesh_of(text, NormalsMode::kFlat).normals.empty());
  expect_near(mesh_of(text, NormalsMode::kSmooth).normals[1], {0, 0, 1}, 1e-6f);
}

TEST(BuildMesh, ComputesNormalsWhereTheFileHasNoneOrZero) {
  const MeshDescription mesh =
      mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 1 0\nvn 0 0 0\nf 1//1 2//2 3\n", NormalsMode::kFile);
  expect_near(mesh.normals[0], {0, 1, 0}, 1e-6f);
  expect_near(mesh.normals[1], {0, 0, 1}, 1e-6f);
  expect_near(mesh.normals[2], {0, 0, 1}, 1e-6f);
}

TEST(BuildMesh, KeepsTheEdgesOfACubeUnlessAskedToSmoothThem) {
  const MeshDescription sharp = mesh_of(kCube, NormalsMode::kFile);
  EXPECT_EQ(sharp.positions.size(), 24u);
  for (std::size_t t = 0; t < sharp.triangles.size(); ++t)
    for (const auto v : sharp.triangles[t]) expect_near(sharp.normals[v], face_normal(sharp, t), 1e-6f);
  const MeshDescription smooth = mesh_of(kCube, NormalsMode::kSmooth);
  EXPECT_EQ(smooth.positions.size(), 8u);
  // The diagonals of the quads give faces different weights at a corner, so the mean is near the diagonal
  // only.
  for (std::size_t v = 0; v < 8; ++v) EXPECT_GT(dot(smooth.normals[v], normalize(smooth.positions[v])), 0.9f);
}

TEST(BuildMesh, SmoothsGentleEdges) {
  EXPECT_EQ(mesh_of(folded_sheet(39), NormalsMode::kFile).positions.size(), 6u);
  EXPECT_EQ(mesh_of(folded_sheet(41), NormalsMode::kFile).positions.size(), 8u);
}

TEST(BuildMesh, FollowsSmoothingGroups) {
  const std::string sharp = folded_sheet(80), flat = folded_sheet(10);
  const auto grouped = [](std::string sheet, const std::string& first, const std::string& second) {
    sheet.insert(sheet.find("f 1 2"), first);
    sheet.insert(sheet.find("f 2 5"), second);
    return sheet;
  };
  const auto vertices = [](const std::string& text) {
    return mesh_of(text, NormalsMode::kFile).positions.size();
  };
  EXPECT_EQ(vertices(grouped(sharp, "s 1\n", "")), 6u);
  EXPECT_EQ(vertices(grouped(sharp, "s 1\n", "g b\ns 1\n")), 6u);
  EXPECT_EQ(vertices(grouped(flat, "s 1\n", "s 2\n")), 8u);
  EXPECT_EQ(vertices(grouped(flat, "s 1\n", "s off\n")), 8u);
  EXPECT_EQ(vertices(grouped(flat, "", "s 1\n")), 8u);
  EXPECT_EQ(mesh_of(grouped(flat, "s 1\n", "s 2\n"), NormalsMode::kSmooth).positions.size(), 6u);
}

TEST(BuildMesh, ShadesFacesWithoutSmoothingFlat) {
  const MeshDescription all = mesh_of("s off\n" + kCube, NormalsMode::kFile);
  EXPECT_TRUE(all.normals.empty());
  EXPECT_EQ(all.positions.size(), 8u);
  const MeshDescription some = mesh_of(kCube + "s 0\nf 1 2 7\ns 1\nf 2 7 8\n", NormalsMode::kFile);
  for (const auto v : some.triangles[12]) expect_near(some.normals[v], face_normal(some, 12), 1e-6f);
}

TEST(BuildMesh, GivesFileNormalsPrecedenceOverSmoothingGroups) {
  const MeshDescription mesh =
      mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0.6 0.8\ns off\nf 1//1 2//1 3\n", NormalsMode::kFile);
  expect_near(mesh.normals[0], {0, 0.6f, 0.8f}, 1e-6f);
  expect_near(mesh.normals[2], {0, 0, 1}, 1e-6f);
}

// Pairs of faces back to back around one vertex: everything cancels out there, and each face keeps a normal
// of its own. Comparing them all with each other would take hours.
TEST(BuildMesh, ShadesFansOfVeryManyFaces) {
  constexpr int kRim = 200000 / tessera::test::kEffortDivisor;
  std::string text = "v 0 0 0\n";
  for (int i = 0; i < kRim; ++i)
    text += "v " + std::to_string(std::cos(i * 2 * M_PI / kRim)) + " " +
            std::to_string(std::sin(i * 2 * M_PI / kRim)) + " " + std::to_string(i % 7) + "\n";
  for (int i = 2; i <= kRim; ++i) {
    const std::string a = std::to_string(i), b = std::to_string(i + 1);
    text += "f 1 " + a + " " + b + "\nf 1 " + b + " " + a + "\n";
  }
  const MeshDescription mesh = mesh_of(text, NormalsMode::kFile);
  ASSERT_EQ(mesh.triangles.size(), 2u * (kRim - 1));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    ASSERT_GT(dot(mesh.normals[mesh.triangles[t][0]], face_normal(mesh, t)), 0.999f) << t;
}

TEST(BuildMesh, SmoothsFansOfVeryManyFaces) {
  constexpr int kRim = 100000 / tessera::test::kEffortDivisor;
  std::string text = "v 0 0 1\n";
  for (int i = 0; i < kRim; ++i)
    text += "v " + std::to_string(10 * std::cos(i * 2 * M_PI / kRim)) + " " +
            std::to_string(10 * std::sin(i * 2 * M_PI / kRim)) + " 0\n";
  for (int i = 0; i < kRim; ++i)
    text += "f 1 " + std::to_string(i + 2) + " " + std::to_string((i + 1) % kRim + 2) + "\n";
  const MeshDescription mesh = mesh_of(text, NormalsMode::kFile);
  EXPECT_EQ(mesh.positions.size(), kRim + 1u);  // one vertex in the middle
  expect_near(mesh.normals[0], {0, 0, 1}, 1e-3f);
}

TEST(BuildMesh, WeighsNormalsByArea) {
  // Around the first vertex a triangle of area 1.5 facing z and one of area 0.5 facing x.
  const MeshDescription mesh =
      mesh_of("v 0 0 0\nv 3 0 0\nv 0 1 0\nv 0 0 1\nf 1 2 3\nf 1 3 4\n", NormalsMode::kSmooth);
  expect_near(mesh.normals[0], normalize({1, 0, 3}), 1e-6f);
  expect_near(mesh.normals[1], {0, 0, 1}, 1e-6f);
}

TEST(BuildMesh, GivesUnitNormalsAtAnyScale) {
  for (const float scale : {1e-12f, 1.0f, 1e12f}) {
    const MeshDescription mesh = mesh_of(kCube, NormalsMode::kSmooth, scaling({scale, scale, scale}));
    for (const Vec3 n : mesh.normals) EXPECT_NEAR(length(n), 1, 1e-6f) << scale;
  }
}

TEST(BuildMesh, GivesNormalsToSheetsWithTwoSides) {
  const MeshDescription mesh = mesh_of("v 0 0 0\nv 1 0 0\nv 0 1 0\nf 1 2 3\nf 3 2 1\n", NormalsMode::kSmooth);
  for (const Vec3 n : mesh.normals) EXPECT_NEAR(length(n), 1, 1e-6f);
  EXPECT_EQ(mesh.triangles.size(), 2u);
}

// A square whose diagonal normal shows whether normals follow the inverse transpose.
const std::string kSlope = "v 0 0 0\nv 1 0 -1\nv 1 1 -1\nv 0 1 0\nvn 1 0 1\nf 1//1 2//1 3//1 4//1\n";

TEST(BuildMesh, TransformsNormalsWithTheirSurfaces) {
  const Transform transforms[] = {scaling({2, 1, 1}),
                                  scaling({-1, 1, 1}),
                                  scaling({-3, -2, -0.5f}),
                                  rotation({1, 2, 3}, 77),
                                  compose(scaling({1, 5, 1}), rotation({0, 1, 0}, 30)),
                                  compose(translation({1, 2, 3}), scaling({1, 1, -1}))};
  for (const Transform& transform : transforms) {
    const MeshDescription mesh = mesh_of(kSlope, NormalsMode::kFile, transform);
    for (std::size_t t = 0; t < 2; ++t) expect_near(mesh.normals[0], face_normal(mesh, t), 1e-5f);
    EXPECT_NEAR(length(mesh.normals[0]), 1, 1e-6f);
  }
}

TEST(BuildMesh, KeepsTheOutsideOfMirroredSolidsOutside) {
  const MeshDescription mesh = mesh_of(kCube, NormalsMode::kFlat, scaling({-1, 2, 3}));
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    EXPECT_GT(dot(face_normal(mesh, t), mesh.positions[mesh.triangles[t][0]]), 0);
}

TEST(BuildMesh, RefusesCoordinatesThatOverflow) {
  const auto mesh = build_mesh(file_of("v 0 0 0\nv 1e30 0 0\nv 0 1e30 0\nf 1 2 3\n"), NormalsMode::kFile,
                               scaling({1e10f, 1e10f, 1e10f}), {0});
  ASSERT_FALSE(mesh.has_value());
  EXPECT_EQ(mesh.error().message, "reaches farther than can be computed after its transform");
}

}  // namespace
}  // namespace tessera::core
