// SPDX-License-Identifier: Apache-2.0
// Shapes of pbrt files, and which of their sides is the front.
#include <gmock/gmock.h>

#include <cmath>
#include <numbers>

#include "core/scene/pbrt/loop_subdivision.hpp"
#include "tests/unit/core_scene_pbrt/pbrt_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

MeshDescription mesh_of(const std::string& world, const MemoryAssets::Files& files = {}) {
  const SceneDescription scene = pbrt_world(world, files);
  const auto* mesh = scene.shapes.empty() ? nullptr : std::get_if<MeshDescription>(&scene.shapes.front());
  EXPECT_NE(mesh, nullptr) << world;
  return mesh == nullptr ? MeshDescription{} : *mesh;
}

Vec3 front_of(const MeshDescription& mesh, std::size_t triangle = 0) {
  const auto& t = mesh.triangles.at(triangle);
  const Vec3 a = mesh.positions[t[0]];
  return normalize(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a));
}

double area_of(const MeshDescription& mesh) {
  double sum = 0;
  for (const auto& t : mesh.triangles) {
    const Vec3 a = mesh.positions[t[0]];
    sum += static_cast<double>(length(cross(mesh.positions[t[1]] - a, mesh.positions[t[2]] - a))) / 2;
  }
  return sum;
}

TEST(PbrtShapes, FrontsOfTrianglesWithoutNormals) {
  EXPECT_EQ(front_of(mesh_of(kPbrtTriangle)), (Vec3{0, 0, 1}));
  EXPECT_EQ(front_of(mesh_of("ReverseOrientation " + kPbrtTriangle)), (Vec3{0, 0, -1}));
  // A reflection keeps the front, which is here towards +z.
  EXPECT_EQ(front_of(mesh_of("Scale -1 1 1 " + kPbrtTriangle)), (Vec3{0, 0, 1}));
  EXPECT_EQ(front_of(mesh_of("Scale 1 1 -1 " + kPbrtTriangle)), (Vec3{0, 0, -1}));
}

TEST(PbrtShapes, NormalsSayWhichSideIsTheFront) {
  const std::string triangle =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"normal N\" [0 0 -1 0 0 -1 0 0 -1]\n";
  EXPECT_EQ(front_of(mesh_of(triangle)), (Vec3{0, 0, -1}));
  EXPECT_EQ(mesh_of(triangle).normals.at(0), (Vec3{0, 0, -1}));
  const MeshDescription reversed = mesh_of("ReverseOrientation " + triangle);
  EXPECT_EQ(front_of(reversed), (Vec3{0, 0, 1}));
  EXPECT_EQ(reversed.normals.at(0), (Vec3{0, 0, 1}));
  const MeshDescription reflected = mesh_of("Scale 1 1 -1 " + triangle);
  EXPECT_EQ(front_of(reflected), (Vec3{0, 0, 1}));
  EXPECT_EQ(reflected.normals.at(0), (Vec3{0, 0, 1}));
}

// pbrt's bitangent is the normal x the tangent, also under reflections.
TEST(PbrtShapes, HaveTangents) {
  const std::string triangle =
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"vector3 S\" [0 2 0 0 2 0 0 2 0]\n";
  EXPECT_EQ(mesh_of(triangle).tangents.at(2), (VertexTangent{{0, 1, 0}, 1}));
  EXPECT_EQ(mesh_of("Scale 1 -1 1 " + triangle).tangents.at(2), (VertexTangent{{0, -1, 0}, 1}));
}

TEST(PbrtShapes, MeshesOfPlyFiles) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n1 0 0\n0 1 0\n3 0 1 2\n";
  const MeshDescription mesh =
      mesh_of("Translate 0 0 2 Shape \"plymesh\" \"string filename\" \"a.ply\"", {{"a.ply", ply}});
  ASSERT_EQ(mesh.triangles.size(), 1u);
  EXPECT_EQ(mesh.positions.at(1), (Vec3{1, 0, 2}));
  const SceneDescription without = pbrt_world(
      "Shape \"plymesh\" \"string filename\" \"gone.ply\"\nShape \"plymesh\" \"string filename\" "
      "\"b.ply\"\n" +
          kPbrtTriangle,
      {{"b.ply", "no ply"}});
  EXPECT_THAT(warnings_of(without), HasSubstr("scene.pbrt:2: the mesh 'gone.ply' does not exist"));
  EXPECT_THAT(warnings_of(without), HasSubstr("scene.pbrt:3: 'b.ply' is no PLY file"));
}

TEST(PbrtShapes, WholeQuadricsStayWhole) {
  const SceneDescription scene = pbrt_world(
      "Scale 2 2 2 Shape \"disk\" \"float height\" 1 \"float radius\" 3 \"float innerradius\" 1.5\n"
      "Shape \"cylinder\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 5\n"
      "Scale 1 1 -1 Shape \"disk\"\n");
  const auto& disk = std::get<DiskDescription>(scene.shapes.at(0));
  EXPECT_EQ(disk.center, (Vec3{0, 0, 2}));
  EXPECT_EQ(disk.radius_u, (Vec3{6, 0, 0}));
  EXPECT_EQ(disk.inner, 0.5f);
  EXPECT_FALSE(disk.flipped);
  const auto& cylinder = std::get<CylinderDescription>(scene.shapes.at(1));
  EXPECT_EQ(cylinder.axis, (Vec3{0, 0, 10}));
  EXPECT_FALSE(cylinder.flipped);
  // Under the reflection its normal is -z.
  EXPECT_TRUE(std::get<DiskDescription>(scene.shapes.at(2)).flipped);
  EXPECT_EQ(warnings_of(scene), "");
}

TEST(PbrtShapes, Curves) {
  const std::string points = "\"point3 P\" [ 0 0 0  1 0 0  2 0 0  3 0 0  4 0 0 ]";
  const SceneDescription scene = pbrt_world(
      "Scale 2 2 2\nShape \"curve\" \"string type\" \"cylinder\" \"string basis\" \"bspline\" " + points +
      " \"float width0\" 0.4 \"float width1\" 0\n"
      "Shape \"curve\" \"string type\" \"cylinder\" \"integer degree\" 2 " +
      points +
      "\n"
      "Shape \"curve\" \"string type\" \"ribbon\" \"integer degree\" 2 " +
      points + " \"normal N\" [ 0 0 1  0 1 0  0 0 1 ]\n");
  ASSERT_EQ(scene.shapes.size(), 2u) << "curves that agree are one shape";
  const CurveStrands& round = std::get<CurvesDescription>(scene.shapes[0]).strands;
  EXPECT_EQ(round.basis, CurveBasis::kBezier);
  EXPECT_EQ(round.shape, CurveShape::kRound);
  EXPECT_EQ(round.counts, (std::vector<std::uint32_t>{4, 4, 4, 4}));
  EXPECT_NEAR(length(round.points.at(0) - Vec3{2, 0, 0}), 0, 1e-5f);  // the spline's start
  EXPECT_NEAR(length(round.points.at(7) - Vec3{6, 0, 0}), 0, 1e-5f);  // and its end
  EXPECT_FLOAT_EQ(round.radii.at(0), 0.4f);
  EXPECT_FLOAT_EQ(round.radii.at(3), 0.2f);
  EXPECT_FLOAT_EQ(round.radii.at(7), 0);
  EXPECT_NEAR(length(round.points.at(9) - Vec3{4.0f / 3, 0, 0}), 0, 1e-5f);  // an elevated quadratic curve
  EXPECT_FLOAT_EQ(round.radii.at(8), 1);
  const CurveStrands& ribbon = std::get<CurvesDescription>(scene.shapes[1]).strands;
  EXPECT_EQ(ribbon.shape, CurveShape::kRibbon);
  EXPECT_EQ(ribbon.normals.size(), 4u);
  EXPECT_EQ(warnings_of(scene), "");
  const SceneDescription without =
      pbrt_world("Shape \"curve\" \"point3 P\" [ 0 0 0 ]\nShape \"sphere\"\nShape \"curve\" " + points +
                 " \"string basis\" \"bspline\" \"float width\" 0\n");
  EXPECT_EQ(without.shapes.size(), 1u);
  EXPECT_THAT(warnings_of(without), HasSubstr("scene.pbrt:2: a curve of a number of points"));
  EXPECT_THAT(warnings_of(without), HasSubstr("scene.pbrt:4: a curve without a width"));
}

TEST(PbrtShapes, PartsOfQuadricsBecomeTriangles) {
  const double pi = std::numbers::pi;
  EXPECT_NEAR(area_of(mesh_of("Shape \"sphere\" \"float radius\" 2 \"float zmin\" 0 \"float zmax\" 2")),
              8 * pi, 0.02);
  EXPECT_NEAR(area_of(mesh_of("Shape \"disk\" \"float radius\" 2 \"float phimax\" 90")), pi, 0.005);
  EXPECT_NEAR(area_of(mesh_of("Shape \"cylinder\" \"float phimax\" 180")), 2 * pi, 0.005);
  const MeshDescription cap = mesh_of("Shape \"sphere\" \"float zmin\" 0.5");
  for (std::size_t v = 0; v < cap.positions.size(); ++v)
    EXPECT_GT(dot(cap.positions[v], cap.normals[v]), 0.99f);
  EXPECT_GT(dot(front_of(cap, 100), cap.normals.at(cap.triangles.at(100)[0])), 0.9f);
}

TEST(PbrtShapes, ReversedSpheresEmitInwards) {
  const MeshDescription mesh = mesh_of("AreaLightSource \"diffuse\" ReverseOrientation Shape \"sphere\"");
  EXPECT_LT(dot(front_of(mesh, 300), mesh.positions.at(mesh.triangles.at(300)[0])), 0);
}

TEST(PbrtShapes, StretchedSpheresAreInstances) {
  const SceneDescription scene = pbrt_world("Scale 1 2 3 Shape \"sphere\" \"float radius\" 2");
  const auto& instance = std::get<InstanceDescription>(scene.shapes.at(0));
  EXPECT_EQ(std::get<SphereDescription>(scene.objects.at(instance.object).shapes.at(0)).radius, 2);
  // Our pole +y is that of pbrt, +z.
  EXPECT_LT(length(instance.to_world.point({0, 2, 0}) - Vec3{0, 0, 6}), 1e-5f);
  EXPECT_LT(length(instance.to_world.point({2, 0, 0}) - Vec3{2, 0, 0}), 1e-5f);
}

TEST(PbrtShapes, StretchedSpheresOfObjects) {
  const SceneDescription scene = pbrt_world(
      "ObjectBegin \"egg\" Scale 1 2 1 Shape \"sphere\" ObjectEnd Translate 5 0 0 ObjectInstance \"egg\"");
  ASSERT_EQ(scene.shapes.size(), 1u);
  const auto& placed = std::get<InstanceDescription>(scene.shapes[0]);
  EXPECT_LT(length(placed.to_world.point({0, 0, 0}) - Vec3{5, 0, 0}), 1e-5f);
}

TEST(PbrtShapes, BilinearPatches) {
  const MeshDescription flat =
      mesh_of("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 1 0 2 1 0] \"integer indices\" [0 1 2 3]");
  EXPECT_EQ(flat.triangles.size(), 2u);
  EXPECT_EQ(front_of(flat), (Vec3{0, 0, 1}));
  const MeshDescription saddle = mesh_of("Shape \"bilinearmesh\" \"point3 P\" [0 0 0 1 0 1 0 1 1 1 1 0]");
  EXPECT_GT(saddle.triangles.size(), 100u);
  bool has_centre = false;
  for (const Vec3 p : saddle.positions) has_centre |= length(p - Vec3{0.5f, 0.5f, 0.5f}) < 1e-5f;
  EXPECT_TRUE(has_centre);
}

TEST(PbrtShapes, SubdivisionSurfacesApproachTheirLimit) {
  MeshDescription octahedron;
  octahedron.positions = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
  octahedron.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4},
                          {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
  const MeshDescription coarse = pbrt::subdivide(octahedron, 0), fine = pbrt::subdivide(octahedron, 3);
  EXPECT_EQ(fine.triangles.size(), 8u * 64);
  // The vertices lie on the limit surface at every level.
  for (std::size_t v = 0; v < coarse.positions.size(); ++v)
    EXPECT_LT(length(coarse.positions[v] - fine.positions[v]), 1e-5f);
  for (std::size_t v = 0; v < fine.positions.size(); ++v)
    EXPECT_GT(dot(fine.positions[v], fine.normals[v]), 0);
}

TEST(PbrtShapes, BoundariesOfSubdivisionSurfacesStayInTheirPlane) {
  MeshDescription square;
  square.positions = {{0, 0, 0}, {1, 0, 0}, {1, 1, 0}, {0, 1, 0}};
  square.triangles = {{0, 1, 2}, {0, 2, 3}};
  const MeshDescription fine = pbrt::subdivide(square, 2);
  EXPECT_EQ(fine.triangles.size(), 32u);
  for (const Vec3 n : fine.normals) EXPECT_GT(n.z, 0);
  for (const Vec3 p : fine.positions) {
    EXPECT_GE(p.x, 0);
    EXPECT_LE(p.x, 1);
  }
}

TEST(PbrtShapes, BrokenMeshesAreRepaired) {
  const SceneDescription scene = pbrt_world(
      "Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 2 0 1 7 -1 0 1]\n"
      "Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] \"integer indices\" [0 1 9]\n"
      "Shape \"bilinearmesh\" \"point3 P\" [0 0 0] \"integer indices\" [0 1 2 3]\n"
      "Shape \"sphere\" \"float radius\" 0 Shape \"disk\" \"float radius\" 0\n");
  ASSERT_EQ(scene.shapes.size(), 1u);
  EXPECT_EQ(std::get<MeshDescription>(scene.shapes[0]).triangles.size(), 1u);
  EXPECT_THAT(warnings_of(scene),
              HasSubstr("scene.pbrt:2: triangles with a corner that is no vertex are left out"));
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:3: a subdivision surface"));
  EXPECT_THAT(warnings_of(scene), HasSubstr("scene.pbrt:4: a bilinear patch"));
}

TEST(PbrtShapes, LimitsOnTrianglesHold) {
  MemoryAssets assets(MemoryAssets::Files{{"scene.pbrt",
                                           "WorldBegin Shape \"loopsubdiv\" \"point3 P\" [0 0 0 1 0 0 0 1 0] "
                                           "\"integer indices\" [0 1 2] \"integer levels\" 8"}});
  SceneLimits limits;
  limits.triangles = {1000, "--max-triangles"};
  const auto loaded = load_scene(assets, "scene.pbrt", "scene.pbrt", limits);
  ASSERT_FALSE(loaded);
  EXPECT_EQ(loaded.error().code, ErrorCode::kResourceExhausted);
}

// pbrt gives its power to each triangle.
TEST(PbrtShapes, PowerOfUnequalTrianglesIsTold) {
  const auto told = [](const std::string& last_corner) {
    return warnings_of(pbrt_world(
        "AreaLightSource \"diffuse\" \"float power\" 10 Shape \"trianglemesh\" \"point3 P\" [0 0 0 1 0 0 "
        "0 1 0 " +
        last_corner + "] \"integer indices\" [0 1 2 1 3 2]"));
  };
  EXPECT_EQ(told("1 1 0"), "");
  EXPECT_THAT(told("2 2 0"), testing::HasSubstr("the power of each part of an area light"));
}

TEST(PbrtShapes, PowerIsThatOfAWholeQuadricOrPatch) {
  const auto emitted = [](const std::string& shape) {
    const SceneDescription scene =
        pbrt_world("AreaLightSource \"diffuse\" \"float power\" 10 Shape " + shape);
    EXPECT_EQ(warnings_of(scene), "");
    return scene.materials.at(0).emission.value.g;
  };
  const float pi = std::numbers::pi_v<float>;
  EXPECT_NEAR(emitted("\"bilinearmesh\" \"point3 P\" [0 0 0 2 0 0 0 2 0 2 2 0]"), 10 / (pi * 4), 1e-4f);
  EXPECT_NEAR(emitted("\"disk\" \"float phimax\" 180"), 10 / (pi * pi / 2), 0.01f);
}

}  // namespace
}  // namespace tessera::core::test
