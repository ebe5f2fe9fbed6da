// SPDX-License-Identifier: Apache-2.0
// Cameras, lights and compression of glTF files, and those that are refused.
#include <draco/compression/encode.h>
#include <draco/mesh/triangle_soup_mesh_builder.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <meshoptimizer.h>

#include "tests/unit/core_gltf/gltf_file.hpp"

namespace tessera::core::test {
namespace {

using nlohmann::json;
using testing::ElementsAre;
using testing::HasSubstr;

GltfFile with_triangle() {
  GltfFile file;
  file.node({{"mesh", file.triangle()}});
  return file;
}

TEST(GltfCameras, LookAlongTheirNodes) {
  GltfFile file = with_triangle();
  file.json["cameras"] = {
      {{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"aspectRatio", 2}, {"znear", 0.1}}}},
      {{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}, {"znear", 0}, {"zfar", 9}}}}};
  file.node({{"camera", 0}, {"translation", {0, 0, 5}}});
  file.node({{"camera", 1}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  const CameraDescription& camera = scene->camera;
  EXPECT_EQ(camera.position, (Vec3{0, 0, 5}));
  EXPECT_EQ(camera.look_at, (Vec3{0, 0, 0}));
  EXPECT_NEAR(camera.vertical_fov_degrees, 57.29578f, 1e-4f);
  EXPECT_EQ(scene->settings.width_px, 2 * scene->settings.height_px);
  EXPECT_THAT(warnings_of(*scene), HasSubstr("cameras[1]: the scene is seen by its first camera"));
}

TEST(GltfCameras, MayBeMirrored) {
  GltfFile file = with_triangle();
  file.json["cameras"] = {{{"type", "perspective"}, {"perspective", {{"yfov", 1.0}, {"znear", 0.1}}}}};
  file.node({{"camera", 0}, {"scale", {-1, 1, 1}}});
  const auto mirrored = load_gltf(file.text());
  ASSERT_TRUE(mirrored) << mirrored.error().message;
  EXPECT_TRUE(mirrored->camera.mirrored);
  file.json["nodes"].back()["scale"] = {-1, -1, 1};
  const auto turned = load_gltf(file.text());
  ASSERT_TRUE(turned) << turned.error().message;
  EXPECT_FALSE(turned->camera.mirrored);
  EXPECT_EQ(turned->camera.up, (Vec3{0, -1, 0}));
  EXPECT_THAT(warnings_of(*turned), testing::Not(HasSubstr("stretched")));
  file.json["nodes"].back()["scale"] = {2, 1, 1};
  const auto stretched = load_gltf(file.text());
  ASSERT_TRUE(stretched) << stretched.error().message;
  EXPECT_THAT(warnings_of(*stretched), HasSubstr("but not stretched or sheared with the node"));
}

TEST(GltfCameras, AreReportedIfNoNodeUsesThem) {
  GltfFile file = with_triangle();
  file.json["cameras"] = {{{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}}}}};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene), HasSubstr("cameras[0]: the camera is left out: no node uses it"));
}

TEST(GltfCameras, CanBeOrthographic) {
  GltfFile file = with_triangle();
  file.json["cameras"] = {{{"type", "orthographic"}, {"orthographic", {{"xmag", 3}, {"ymag", 2}}}}};
  file.node({{"camera", 0}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->camera.type, CameraType::kOrthographic);
  EXPECT_EQ(scene->camera.view_height, 4);
}

TEST(GltfLights, HaveTheirUnits) {
  GltfFile file = with_triangle();
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {
      {{"type", "point"}, {"color", {1, 0.5, 0}}, {"intensity", 10}},
      {{"type", "directional"}, {"intensity", 3}},
      {{"type", "spot"}, {"spot", {{"innerConeAngle", 0.25}, {"outerConeAngle", 0.5}}}}};
  for (int i = 0; i < 3; ++i)
    file.node({{"translation", {0, 2, 0}}, {"extensions", {{"KHR_lights_punctual", {{"light", i}}}}}});
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  ASSERT_EQ(scene->lights.size(), 3u);
  EXPECT_FALSE(scene->environment);  // no studio
  const auto& point = std::get<PointLightDescription>(scene->lights[0]);
  EXPECT_EQ(point.position, (Vec3{0, 2, 0}));
  EXPECT_EQ(point.intensity, (Rgb{10, 5, 0}));
  const auto& sun = std::get<DirectionalLightDescription>(scene->lights[1]);
  EXPECT_EQ(sun.direction, (Vec3{0, 0, -1}));
  EXPECT_EQ(sun.irradiance, Rgb::gray(3));
  const auto& spot = std::get<SpotLightDescription>(scene->lights[2]);
  EXPECT_NEAR(spot.angle_degrees, 57.29578f, 1e-4f);
  EXPECT_EQ(spot.softness, 0.5f);
  EXPECT_EQ(spot.falloff, lights::SpotFalloff::kSquared);
  EXPECT_EQ(spot.look_at - spot.position, (Vec3{0, 0, -2}));
}

// A triangle compressed by this extension; the first byte of its vertices tells the version of the codec.
GltfFile compressed_by(const char* name, unsigned char version = 0xa0) {
  GltfFile file = with_triangle();
  const std::vector<float> positions{0, 0, 0, 3, 0, 0, 0, 4, 0};
  const std::vector<unsigned> corners{0, 1, 2};
  std::vector<unsigned char> vertices(meshopt_encodeVertexBufferBound(3, 12));
  vertices.resize(meshopt_encodeVertexBuffer(vertices.data(), vertices.size(), positions.data(), 3, 12));
  vertices[0] = version;
  std::vector<unsigned char> indices(meshopt_encodeIndexBufferBound(3, 3));
  indices.resize(meshopt_encodeIndexBuffer(indices.data(), indices.size(), corners.data(), 3));
  const auto compressed = [&](const std::vector<unsigned char>& bytes, const char* mode, int stride) {
    const int view = file.view(std::string(bytes.begin(), bytes.end()));
    json extension = file.json["bufferViews"][static_cast<std::size_t>(view)];
    extension["mode"] = mode;
    extension["byteStride"] = stride;
    extension["count"] = 3;
    // The buffer of a reader without the extension, which has no bytes here.
    file.json["bufferViews"].push_back(
        {{"buffer", 1}, {"byteLength", 3 * stride}, {"extensions", {{name, extension}}}});
    return view + 1;
  };
  const int position = file.accessor(compressed(vertices, "ATTRIBUTES", 12), 5126, "VEC3", 3);
  const int index = file.accessor(compressed(indices, "TRIANGLES", 4), 5125, "SCALAR", 3);
  file.json["extensionsRequired"] = {name};
  file.json["meshes"][0]["primitives"] = {{{"attributes", {{"POSITION", position}}}, {"indices", index}}};
  return file;
}

TEST(GltfCompression, OfMeshoptIsUndone) {
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto scene = load_gltf(compressed_by(name).text());
    ASSERT_TRUE(scene) << scene.error().message;
    EXPECT_THAT(mesh_of(*scene).positions, ElementsAre(Vec3{0, 0, 0}, Vec3{3, 0, 0}, Vec3{0, 4, 0}));
  }
}

TEST(GltfCompression, OfMeshoptIsRefusedIfItIsDamagedOrNewer) {
  GltfFile file = compressed_by("EXT_meshopt_compression");
  auto& extension = file.json["bufferViews"].back()["extensions"]["EXT_meshopt_compression"];
  extension["count"] = 3000000;
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr("3000000 elements cannot be in"));
  extension["count"] = 3;
  extension["byteStride"] = 3;
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr("byteStride cannot be 3 for the mode TRIANGLES"));
  extension["byteStride"] = 4;
  extension["byteLength"] = 2;
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr("its compressed bytes are damaged"));
  EXPECT_THAT(
      gltf_mistake(compressed_by("KHR_meshopt_compression", 0xa1).text()),
      HasSubstr("its vertices are compressed by version 1 of the codec; only version 0 is supported"));
}

TEST(GltfCompression, OfDracoIsUndone) {
  const float corners[3][3] = {{0, 0, 0}, {3, 0, 0}, {0, 4, 0}};
  draco::TriangleSoupMeshBuilder builder;
  builder.Start(1);
  const int attribute = builder.AddAttribute(draco::GeometryAttribute::POSITION, 3, draco::DT_FLOAT32);
  builder.SetAttributeValuesForFace(attribute, draco::FaceIndex(0), corners[0], corners[1], corners[2]);
  const auto mesh = builder.Finalize();
  draco::EncoderBuffer encoded;
  ASSERT_TRUE(draco::Encoder().EncodeMeshToBuffer(*mesh, &encoded).ok());
  GltfFile file = with_triangle();
  const int view = file.view(std::string(encoded.data(), encoded.size()));
  file.json["accessors"].push_back({{"componentType", 5126}, {"type", "VEC3"}, {"count", 3}});
  json& primitive = file.json["meshes"][0]["primitives"][0];
  primitive["attributes"] = {{"POSITION", file.json["accessors"].size() - 1}};
  primitive["extensions"]["KHR_draco_mesh_compression"] = {
      {"bufferView", view}, {"attributes", {{"POSITION", mesh->attribute(attribute)->unique_id()}}}};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  auto positions = mesh_of(*scene).positions;
  ASSERT_EQ(positions.size(), 3u);
  const auto [a, b, c] = mesh_of(*scene).triangles[0];
  const Vec3 normal = cross(positions[b] - positions[a], positions[c] - positions[a]);
  EXPECT_EQ(normal, (Vec3{0, 0, 12}));

  file.json["bufferViews"][static_cast<std::size_t>(view)]["byteLength"] = 11;
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr("its compressed bytes are damaged"));
}

TEST(GltfExtensions, ThatAreUnknownAreRefusedOrTold) {
  GltfFile file = with_triangle();
  file.json["extensionsUsed"] = {"EXT_lights_ies", "KHR_lights_punctual"};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene), HasSubstr("the optional extension 'EXT_lights_ies' is not supported"));
  file.json["extensionsRequired"] = {"EXT_lights_ies"};
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr("needs the extension 'EXT_lights_ies'"));
}

TEST(GltfExtensions, OfImagesThatCannotBeReadCostTheTextures) {
  GltfFile file;
  file.json["images"] = {{{"uri", "a.ktx2"}}};
  file.json["textures"] = {{{"extensions", {{"KHR_texture_basisu", {{"source", 0}}}}}}};
  file.json["materials"] = {
      {{"pbrMetallicRoughness", {{"baseColorFactor", {1, 0, 0, 1}}, {"baseColorTexture", {{"index", 0}}}}}}};
  file.node({{"mesh", file.triangle(0)}});
  file.json["extensionsUsed"] = file.json["extensionsRequired"] = {"KHR_texture_basisu"};
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->textures.size(), 1u) << "that of the studio";
  EXPECT_THAT(warnings_of(*scene),
              HasSubstr("extensionsRequired: the images of 'KHR_texture_basisu' cannot be "
                        "read; textures that have no other are ignored: convert them to "
                        "PNG or JPEG\n"));
  EXPECT_THAT(warnings_of(*scene), HasSubstr("textures[0]: has no image that can be read; the texture is "
                                             "ignored"));
}

TEST(GltfUris, OfFilesElsewhereAreSoughtBesideTheScene) {
  GltfFile file;
  file.json["images"] = {{{"uri", "file:///C:/My%20Maps/a%20b.png"}}};
  file.json["textures"] = {{{"source", 0}}};
  file.json["materials"] = {{{"pbrMetallicRoughness", {{"baseColorTexture", {{"index", 0}}}}}}};
  file.node({{"mesh", file.triangle(0)}});
  const auto scene = load_gltf(file.text(), {{"a b.png", test::png(test::one_color(1, 1, Rgb::gray(1)))}});
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_EQ(scene->textures.size(), 2u) << "with that of the studio";
  EXPECT_THAT(warnings_of(*scene),
              HasSubstr("'file:///C:/My Maps/a b.png' does not exist; 'a b.png' is used"));
  file.json["images"] = {{{"uri", "https://example.org/a b.png"}}};
  EXPECT_THAT(warnings_of(*load_gltf(file.text())), HasSubstr("it names no file; the texture is ignored"));
}

TEST(GltfVersion, MayBeShort) {
  GltfFile file = with_triangle();
  file.json["asset"]["version"] = "2";
  const auto scene = load_gltf(file.text());
  ASSERT_TRUE(scene) << scene.error().message;
  EXPECT_THAT(warnings_of(*scene), HasSubstr("asset: has the version 2; it is read as glTF 2.0"));
}

// Changes a file with a triangle, and expects the message.
void expect_mistake(const char* pointer, const json& value, const std::string& message) {
  GltfFile file = with_triangle();
  file.json[json::json_pointer(pointer)] = value;
  EXPECT_THAT(gltf_mistake(file.text()), HasSubstr(message)) << pointer;
}

TEST(GltfRefusals, NameThePlace) {
  expect_mistake("/asset/version", "1.0", "asset: is glTF 1.0; only 2.0 can be read");
  expect_mistake("/nodes/0/mesh", 7,
                 "nodes[0].mesh: the node shows no mesh: there is no meshes[7]; the file has 1");
  expect_mistake("/nodes/0/mesh", -1,
                 "nodes[0].mesh: the node shows no mesh: must be a whole number from 0, got -1");
  expect_mistake("/meshes/0/primitives/0/mode", 9, "there is no mode 9");
  expect_mistake("/meshes/0/primitives/0/attributes/POSITION", 1,
                 "attributes.POSITION: must be an accessor of 3 components, and accessors[1] has 2");
  expect_mistake("/meshes/0/primitives/0/indices", 0, "indices: must be an accessor of 1 components");
  expect_mistake("/accessors/0/count", 4, "accessors[0]: 4 elements of 12 bytes, 12 apart, reach beyond");
  expect_mistake("/accessors/0/count", 1ull << 62, "reach beyond the bufferView");
  expect_mistake("/accessors/0/byteOffset", 1ull << 62, "byteOffset lies beyond the bufferView");
  expect_mistake("/accessors/0/componentType", 5124, "there is no componentType 5124");
  expect_mistake("/accessors/0/type", "VEC9", "the type 'VEC9' cannot be used here");
  expect_mistake("/bufferViews/0/byteLength", 1ull << 62, "reach beyond the buffer, which has");
  expect_mistake("/bufferViews/0/byteStride", 4, "elements of 12 bytes are 4 apart");
  expect_mistake("/bufferViews/0/buffer", 1, "there is no buffers[1]");
  expect_mistake("/accessors/0", {{"componentType", 5126}, {"type", "VEC3"}, {"count", 1u << 30}},
                 "and no bufferView; at most");
}

TEST(GltfRefusals, NameTheLineOfTextFiles) {
  EXPECT_EQ(gltf_mistake("{\"asset\": {\"version\": \"2.0\"},\n\"nodes\": [\n{\"mesh\": 3}]}"),
            "model.gltf: has no shape that can be rendered\n"
            "model.gltf:3: nodes[0].mesh: the node shows no mesh: there is no meshes[3]; the file has 0");
  EXPECT_THAT(gltf_mistake("{\"asset\": }"), HasSubstr("model.gltf:1:11: not valid JSON"));
  EXPECT_THAT(gltf_mistake("{\"asset\": {\"version\": \"2.0\"}}"),
              HasSubstr("no shape that can be rendered"));
  EXPECT_THAT(gltf_mistake("[]"), HasSubstr("model.gltf: is not glTF"));
}

TEST(GltfRefusals, OfIndicesBeyondTheVertices) {
  GltfFile file = with_triangle();
  file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 3});
  EXPECT_THAT(gltf_mistake(file.text()),
              HasSubstr("primitives[0].indices: triangles left out because they name vertices beyond the 3"));
}

// Every truncated file is refused, or renders the same.
TEST(GltfRefusals, OfTruncatedBinaryFiles) {
  const std::string whole = with_triangle().binary();
  EXPECT_EQ(gltf_mistake(whole), "no mistake");
  for (std::size_t size = 0; size < whole.size(); ++size)
    EXPECT_THAT(gltf_mistake(whole.substr(0, size)), HasSubstr("model.gltf")) << size;
  std::string chunk_too_long = whole;
  chunk_too_long[14] = '\x7f';
  EXPECT_THAT(gltf_mistake(chunk_too_long), HasSubstr("has a chunk that reaches beyond its end"));
}

// Bytes changed: whatever that gives, it is an answer.
TEST(GltfRefusals, OrAnAnswerForAnyChangedByte) {
  GltfFile file = with_triangle();
  file.json["meshes"][0]["primitives"][0]["indices"] = file.indices({0, 1, 2});
  file.json["extensions"]["KHR_lights_punctual"]["lights"] = {{{"type", "point"}}};
  file.node({{"extensions", {{"KHR_lights_punctual", {{"light", 0}}}}}});
  const std::string whole = file.binary();
  for (std::size_t i = 0; i < whole.size(); i += 3)
    for (const char byte : {'\0', '9', '\xff', '{'}) {
      std::string changed = whole;
      changed[i] = byte;
      const auto scene = load_gltf(changed);
      EXPECT_TRUE(scene || !scene.error().message.empty());
    }
}

}  // namespace
}  // namespace tessera::core::test
