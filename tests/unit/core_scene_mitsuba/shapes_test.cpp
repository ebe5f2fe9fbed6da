// SPDX-License-Identifier: Apache-2.0
// The shapes of Mitsuba scenes.
#include <fmt/format.h>
#include <gmock/gmock.h>

#include "tests/unit/core_scene_mitsuba/mitsuba_scene.hpp"

namespace tessera::core::test {
namespace {

using testing::HasSubstr;

template <typename Shape>
Shape only_shape(const std::string& xml, const MemoryAssets::Files& files = {}) {
  const auto scene = load_xml(xml_scene(xml, false), files);
  EXPECT_TRUE(scene) << scene.error().message;
  if (!scene || scene->shapes.empty()) return {};
  const auto* shape = std::get_if<Shape>(&scene->shapes.front());
  EXPECT_NE(shape, nullptr);
  return shape == nullptr ? Shape{} : *shape;
}

Vec3 face_normal(const MeshDescription& mesh, std::size_t triangle) {
  const auto [a, b, c] = mesh.triangles.at(triangle);
  return normalize(cross(mesh.positions[b] - mesh.positions[a], mesh.positions[c] - mesh.positions[a]));
}

TEST(MitsubaShape, RectanglesFaceAlongZ) {
  const auto square = only_shape<MeshDescription>("<shape type=\"rectangle\"/>");
  EXPECT_EQ(face_normal(square, 0), (Vec3{0, 0, 1}));
  EXPECT_EQ(face_normal(square, 1), (Vec3{0, 0, 1}));
  for (std::size_t i = 0; i < square.positions.size(); ++i)
    EXPECT_EQ(square.positions[i], (Vec3{2 * square.uvs[i].x - 1, 2 * square.uvs[i].y - 1, 0}));
}

TEST(MitsubaShape, MirroringAndFlippingTurnNormals) {
  const auto mirrored = only_shape<MeshDescription>(
      "<shape type=\"rectangle\"><transform name=\"to_world\"><scale x=\"-1\"/></transform></shape>");
  EXPECT_EQ(face_normal(mirrored, 0), (Vec3{0, 0, 1}));
  const auto flipped = only_shape<MeshDescription>(
      "<shape type=\"rectangle\"><boolean name=\"flip_normals\" value=\"true\"/></shape>");
  EXPECT_EQ(face_normal(flipped, 0), (Vec3{0, 0, -1}));
}

// Of meshes and rectangles it does not.
TEST(MitsubaShape, MirroringTurnsSpheresAndCylindersInsideOut) {
  const std::string mirrored = "<transform name='to_world'><scale x='-1'/></transform></shape>";
  const auto sphere = only_shape<MeshDescription>("<shape type='sphere'>" + mirrored);
  const Vec3 corner = sphere.positions[sphere.triangles[0][0]];
  EXPECT_LT(dot(face_normal(sphere, 0), corner), 0);
  EXPECT_TRUE(only_shape<CylinderDescription>("<shape type='cylinder'>" + mirrored).flipped);
  EXPECT_FALSE(only_shape<CylinderDescription>("<shape type='cylinder'><boolean name='flip_normals' "
                                               "value='true'/>" +
                                               mirrored)
                   .flipped);
}

TEST(MitsubaShape, CubesFaceOutwards) {
  const auto cube = only_shape<MeshDescription>("<shape type=\"cube\"/>");
  ASSERT_EQ(cube.triangles.size(), 12u);
  for (std::size_t t = 0; t < 12; ++t) {
    Vec3 center{};
    for (const std::uint32_t corner : cube.triangles[t]) center += cube.positions[corner] / 3.0f;
    EXPECT_GT(dot(face_normal(cube, t), center), 0.9f);
  }
}

TEST(MitsubaShape, MeshesWithoutNormalsGetMeansWeightedByAngle) {
  // Two triangles that share an edge at a right angle.
  const std::string roof = "v 0 0 0\nv 0 0 1\nv 1 0 0\nv 0 -1 0\nf 1 2 3\nf 1 4 2\n";
  const std::string shape = "<shape type=\"obj\"><string name=\"filename\" value=\"roof.obj\"/>";
  const auto smooth = only_shape<MeshDescription>(shape + "</shape>", {{"roof.obj", roof}});
  ASSERT_EQ(smooth.normals.size(), smooth.positions.size());
  bool found = false;
  for (std::size_t i = 0; i < smooth.positions.size(); ++i) {
    if (smooth.positions[i] != Vec3{0, 0, 0}) continue;
    found = true;
    const Vec3 n = normalize(smooth.normals[i]);
    EXPECT_NEAR(n.x, -std::sqrt(0.5f), 1e-5);
    EXPECT_NEAR(n.y, std::sqrt(0.5f), 1e-5);
  }
  EXPECT_TRUE(found);
  const auto flat = only_shape<MeshDescription>(
      shape + "<boolean name=\"face_normals\" value=\"true\"/></shape>", {{"roof.obj", roof}});
  EXPECT_TRUE(flat.normals.empty());
}

// (b1, b2), whatever `flip_tex_coords` says of those of files; images of other shapes do not split vertices.
TEST(MitsubaShape, ImagesOnMeshesWithoutCoordinatesHaveBarycentricOnes) {
  const MemoryAssets::Files files{{"a.obj", "v 0 0 0\nv 1 0 0\nv 1 1 0\nv 0 1 0\nf 1 2 3\nf 1 3 4\n"}};
  const std::string obj = "<shape type='obj'><string name='filename' value='a.obj'/>";
  const SceneDescription scene =
      scene_of(obj + "<bsdf type='diffuse'><texture type='checkerboard' name='reflectance'/></bsdf></shape>" +
                   obj + "<bsdf type='diffuse'/></shape>",
               files);
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const std::vector<Vec2> uvs{{0, 0}, {1, 0}, {0, 1}, {0, 0}, {1, 0}, {0, 1}};
  EXPECT_EQ(mesh.uvs, uvs);
  EXPECT_EQ(mesh.positions.at(5), (Vec3{0, 1, 0}));
  EXPECT_EQ(mesh.normals.size(), 6u);
  const auto& texture = scene.textures.at(0);
  EXPECT_EQ(texture.scale.y, -1) << "the first row is at v = 0";
  const auto& plain = std::get<MeshDescription>(scene.shapes.at(1));
  EXPECT_EQ(plain.positions.size(), 4u);
  EXPECT_TRUE(plain.uvs.empty());
}

TEST(MitsubaShape, TrianglesFaceWhereTheirNormalsPoint) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float nx\nproperty float ny\nproperty float nz\nelement face 1\nproperty list uchar int "
      "vertex_indices\n"
      "end_header\n0 0 0 0 0 -1\n1 0 0 0 0 -1\n0 1 0 0 0 -1\n3 0 1 2\n";
  const auto mesh = only_shape<MeshDescription>(
      "<shape type=\"ply\"><string name=\"filename\" value=\"t.ply\"/></shape>", {{"t.ply", ply}});
  EXPECT_EQ(face_normal(mesh, 0), (Vec3{0, 0, -1}));
}

TEST(MitsubaShape, DisksAndCylinders) {
  const auto disk = only_shape<DiskDescription>(
      "<shape type=\"disk\"><transform name=\"to_world\"><scale value=\"2\"/><translate "
      "z=\"1\"/></transform></shape>");
  EXPECT_EQ(disk.center, (Vec3{0, 0, 1}));
  EXPECT_EQ(disk.radius_u, (Vec3{2, 0, 0}));
  EXPECT_FALSE(disk.flipped);
  const auto cylinder = only_shape<CylinderDescription>(
      "<shape type=\"cylinder\"><point name=\"p0\" x=\"0\" y=\"1\" z=\"0\"/><point name=\"p1\" x=\"0\" "
      "y=\"4\" z=\"0\"/>"
      "<float name=\"radius\" value=\"0.5\"/></shape>");
  EXPECT_EQ(cylinder.start, (Vec3{0, 1, 0}));
  EXPECT_EQ(cylinder.axis, (Vec3{0, 3, 0}));
  EXPECT_NEAR(length(cylinder.radius_u), 0.5, 1e-6);
  EXPECT_NEAR(dot(cross(cylinder.radius_u, cylinder.radius_v), cylinder.axis), 0.75, 1e-5);
}

TEST(MitsubaShape, TexturesOfCurvesAreTold) {
  const SceneDescription scene = scene_of(
      "<shape type='linearcurve'><string name='filename' value='a.txt'/><bsdf type='diffuse'>"
      "<texture name='reflectance' type='checkerboard'/></bsdf></shape>",
      {{"a.txt", "0 0 0 1\n0 1 0 1\n"}});
  EXPECT_THAT(warnings_of(scene), testing::HasSubstr("texture coordinates are u along each strand"));
}

TEST(MitsubaShape, Curves) {
  const std::string hair =
      "0 0 0 0.1\n0 1 0 0.1\r\n0 2 0 0.1\n+0 3 0 0.1\n\n  \n1 0 0 .2\n1 1 0 .2\n1 2 0 .2\n1 3 0 .2\n1 4 0 .3";
  const std::string file = "<string name=\"filename\" value=\"hair.txt\"/>";
  const auto splines = only_shape<CurvesDescription>(
      "<shape type=\"bsplinecurve\">" + file +
          "<transform name=\"to_world\"><scale value=\"2\"/></transform></shape>",
      {{"hair.txt", hair}});
  EXPECT_EQ(splines.strands.basis, CurveBasis::kBSpline);
  EXPECT_EQ(splines.strands.shape, CurveShape::kRound);
  EXPECT_EQ(splines.strands.counts, (std::vector<std::uint32_t>{4, 5}));
  EXPECT_EQ(splines.strands.points.at(1), (Vec3{0, 2, 0}));
  EXPECT_EQ(splines.strands.radii.at(8), 0.3f) << "transforms keep radii";
  const auto lines =
      only_shape<CurvesDescription>("<shape type=\"linearcurve\">" + file + "</shape>", {{"hair.txt", hair}});
  EXPECT_EQ(lines.strands.basis, CurveBasis::kLinear);
  for (const std::string& broken : {std::string("0 0 0\n"), std::string("0 0 0 1\n"), std::string("\n"),
                                    std::string("0 0 nan 1\n0 0 0 1\n0 0 0 1\n0 0 0 1\n")}) {
    const auto scene = load_xml(
        xml_scene("<shape type=\"sphere\"/><shape type=\"bsplinecurve\">" + file + "</shape>", false),
        {{"hair.txt", broken}});
    ASSERT_TRUE(scene);
    EXPECT_EQ(scene->shapes.size(), 1u);
    EXPECT_THAT(scene->warnings.back(), HasSubstr("the shape is left out"));
  }
}

TEST(MitsubaShape, GroupsAreStoredOnce) {
  const auto scene = load_xml(
      xml_scene("<shape type=\"shapegroup\" id=\"g\"><shape type=\"sphere\"/><shape type=\"cube\"/></shape>\n"
                "<shape type=\"instance\"><ref id=\"g\"/></shape>\n"
                "<shape type=\"instance\"><ref id=\"g\"/><transform name=\"to_world\"><translate "
                "x=\"5\"/></transform></shape>",
                false));
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->objects.size(), 1u);
  EXPECT_EQ(scene->objects[0].shapes.size(), 2u);
  ASSERT_EQ(scene->shapes.size(), 2u);
  EXPECT_EQ(std::get<InstanceDescription>(scene->shapes[1]).to_world.origin, (Vec3{5, 0, 0}));
}

constexpr const char* kAttributePly =
    "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
    "property float heat_0\nelement face 2\nproperty list uchar int vertex_indices\nproperty float weight_0\n"
    "end_header\n0 0 0 0\n1 0 0 1\n1 1 0 0.5\n0 1 0 0.25\n3 0 1 2 0.75\n3 0 2 3 0.125\n";

// The blend weight at the centre of each of two triangles.
std::array<float, 2> weights(const std::string& attribute) {
  const SceneDescription scene = scene_of(
      "<shape type=\"ply\"><string name=\"filename\" value=\"a.ply\"/><bsdf type=\"blendbsdf\">"
      "<texture type=\"mesh_attribute\" name=\"weight\"><string name=\"name\" value=\"" +
          attribute +
          "\"/></texture>"
          "<bsdf type=\"diffuse\"/><bsdf type=\"null\"/></bsdf></shape>",
      {{"a.ply", kAttributePly}});
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const auto& blend = std::get<Blend>(scene.materials.at(mesh.triangle_materials.at(0)).model);
  std::array<float, 2> found{};
  for (std::size_t t = 0; t < 2; ++t) {
    Vec2 center{};
    for (const std::uint32_t corner : mesh.triangles.at(t)) center = center + mesh.uvs[corner] * (1 / 3.0f);
    found[t] = blend.weight.evaluate(scene.textures, center);
  }
  return found;
}

TEST(MitsubaShape, AttributesOfFacesAndVerticesAreExact) {
  const auto of_faces = weights("face_weight");
  EXPECT_NEAR(of_faces[0], 0.75, 1e-5);
  EXPECT_NEAR(of_faces[1], 0.125, 1e-5);
  const auto of_vertices = weights("vertex_heat");
  EXPECT_NEAR(of_vertices[0], 0.5, 1e-5);
  EXPECT_NEAR(of_vertices[1], 0.25, 1e-5);
}

// The reflectance of a triangle with these properties, which have the values 0.25, 0.5 and 0.75.
std::string reflectance_by(const std::string& attribute, const std::array<std::string, 3>& properties,
                           bool of_faces) {
  std::string declared;
  for (const std::string& name : properties) declared += "property float " + name + "\n";
  const std::string values = " 0.25 0.5 0.75\n", of_vertex = of_faces ? "\n" : values;
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n" +
      (of_faces ? "" : declared) + "element face 1\nproperty list uchar int vertex_indices\n" +
      (of_faces ? declared : "") + "end_header\n0 0 0" + of_vertex + "1 0 0" + of_vertex + "1 1 0" +
      of_vertex + "3 0 1 2" + (of_faces ? values : "\n");
  const SceneDescription scene = scene_of(
      "<shape type='ply'><string name='filename' value='a.ply'/><bsdf type='diffuse'><texture "
      "type='mesh_attribute' name='reflectance'><string name='name' value='" +
          attribute + "'/></texture></bsdf></shape>",
      {{"a.ply", ply}});
  const auto& mesh = std::get<MeshDescription>(scene.shapes.at(0));
  const auto& diffuse = std::get<Lambert>(scene.materials.at(mesh.triangle_materials.at(0)).model);
  if (diffuse.albedo.texture < 0) return warnings_of(scene);
  const Rgb color = diffuse.albedo.evaluate(scene.textures, mesh.uvs.at(0));
  return fmt::format("{:.2f} {:.2f} {:.2f}", color.r, color.g, color.b);
}

TEST(MitsubaShape, AttributesHaveMitsubasNames) {
  const std::string values = "0.25 0.50 0.75";
  for (const bool of_faces : {false, true}) {
    const std::string owner = of_faces ? "face_" : "vertex_";
    EXPECT_EQ(reflectance_by(owner + "color", {"r", "g", "b"}, of_faces), values);
    EXPECT_EQ(reflectance_by(owner + "color", {"red", "green", "blue"}, of_faces), values);
    EXPECT_EQ(reflectance_by(owner + "albedo_color", {"albedo_r", "albedo_g", "albedo_b"}, of_faces), values);
    EXPECT_EQ(reflectance_by(owner + "my_tint", {"my_tint_x", "my_tint_y", "my_tint_z"}, of_faces), values);
    EXPECT_EQ(reflectance_by(owner + "tint", {"tint_1", "tint_2", "tint_3"}, of_faces), values);
    EXPECT_THAT(reflectance_by(owner + "tint", {"tint_red", "tint_green", "tint_blue"}, of_faces),
                HasSubstr("the shape has no attribute '" + owner + "tint'"));
  }
}

// Of a mesh whose vertices have reflectances, the first one with this red.
std::string warnings_of_color(const std::string& red) {
  const std::string ply =
      "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
      "property float r\nproperty float g\nproperty float b\nelement face 1\n"
      "property list uchar int vertex_indices\nend_header\n0 0 0 " +
      red + " 0 0\n1 0 0 0 0 1\n1 1 0 1 1 1\n3 0 1 2\n";
  return warnings_of(scene_of(
      "<shape type='ply'><string name='filename' value='a.ply'/><bsdf type='diffuse'><texture "
      "type='mesh_attribute' name='reflectance'><string name='name' value='vertex_color'/></texture></bsdf>"
      "</shape>",
      {{"a.ply", ply}}));
}

TEST(MitsubaShape, ColorsOfVerticesThatAreNotExactAreTold) {
  EXPECT_THAT(warnings_of_color("1"),
              HasSubstr("the colours of 'reflectance' between vertices are not exact"));
  EXPECT_THAT(warnings_of_color("3"), HasSubstr("the texture of 'reflectance' is clamped to at most 1"));
}

TEST(MitsubaShape, MissingFilesCostTheShapeOnly) {
  const SceneDescription scene =
      scene_of("<shape type=\"obj\"><string name=\"filename\" value=\"gone.obj\"/></shape>");
  EXPECT_EQ(scene.shapes.size(), 1u);
  EXPECT_THAT(warnings_of(scene), HasSubstr("'gone.obj' does not exist; the shape is left out"));
}

TEST(MitsubaShape, TellsWhatIsBrokenInItsFileOnce) {
  const std::string shape = "<shape type=\"obj\"><string name=\"filename\" value=\"a.obj\"/></shape>";
  const SceneDescription scene = scene_of(shape + shape, {{"a.obj", std::string(kTriangleObj) + "f 1 2\n"}});
  EXPECT_EQ(warnings_of(scene),
            "a.obj:8: a face must have at least 3 corners, got 2; the face is left out\n");
}

}  // namespace
}  // namespace tessera::core::test
