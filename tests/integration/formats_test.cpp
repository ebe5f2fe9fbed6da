// SPDX-License-Identifier: Apache-2.0
// Scenes of other programs on a farm: the image has the bytes of a local render, and the files that a scene
// names travel by their digests.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <filesystem>
#include <map>
#include <ostream>
#include <string>
#include <vector>

#include "proto/blob.hpp"
#include "tests/integration/farm_processes.hpp"

namespace tessera::test {
namespace {

namespace fs = std::filesystem;

struct ForeignScene {
  std::string name;                 // of the scene's file
  std::string text;                 // of it
  std::vector<std::string> assets;  // that it reads
};

void PrintTo(const ForeignScene& scene, std::ostream* out) {
  *out << scene.name;
}

// A triangle with a texture, in each format.
const ForeignScene kGltfScene{"scene.gltf",
                              R"({
  "asset": {"version": "2.0"},
  "buffers": [{"uri": "triangle.bin", "byteLength": 60}],
  "bufferViews": [{"buffer": 0, "byteLength": 36}, {"buffer": 0, "byteOffset": 36, "byteLength": 24}],
  "accessors": [{"bufferView": 0, "componentType": 5126, "type": "VEC3", "count": 3,
                 "min": [-1, -1, 0], "max": [1, 1, 0]},
                {"bufferView": 1, "componentType": 5126, "type": "VEC2", "count": 3}],
  "images": [{"uri": "checks.png"}],
  "textures": [{"source": 0}],
  "materials": [{"pbrMetallicRoughness": {"baseColorTexture": {"index": 0}, "metallicFactor": 0}}],
  "meshes": [{"primitives": [{"attributes": {"POSITION": 0, "TEXCOORD_0": 1}, "material": 0}]}],
  "nodes": [{"mesh": 0}]})",
                              {"triangle.bin", "checks.png"}};
const ForeignScene kPbrtScene{"scene.pbrt",
                              R"(LookAt 0 0 4  0 0 0  0 1 0
Camera "perspective"
WorldBegin
LightSource "infinite"
Include "surfaces.pbrt"
)",
                              {"surfaces.pbrt", "triangle.ply", "checks.png"}};
const ForeignScene kMitsubaScene{"scene.xml",
                                 R"(<scene version="3.0.0">
  <sensor type="perspective"><float name="fov" value="40"/><transform name="to_world">
    <lookat origin="0, 0, 4" target="0, 0, 0" up="0, 1, 0"/></transform></sensor>
  <emitter type="constant"/>
  <shape type="obj"><string name="filename" value="triangle.obj"/><bsdf type="diffuse">
    <texture type="bitmap" name="reflectance"><string name="filename" value="checks.png"/></texture></bsdf></shape>
</scene>
)",
                                 {"triangle.obj", "checks.png"}};
const ForeignScene kBareMesh{"scene.obj",
                             "mtllib paint.mtl\nv -1 -1 0\nv 1 -1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\n"
                             "usemtl paint\nf 1/1 2/2 3/3\n",
                             {"paint.mtl", "checks.png"}};

void write_assets(const fs::path& folder) {
  constexpr std::array<float, 15> kTriangle{-1, -1, 0, 1, -1, 0, -1, 1, 0, 0, 0, 1, 0, 0, 1};
  std::string bytes(sizeof kTriangle, '\0');
  std::memcpy(bytes.data(), kTriangle.data(), sizeof kTriangle);
  write_file(folder / "triangle.bin", bytes);
  write_file(folder / "triangle.obj",
             "v -1 -1 0\nv 1 -1 0\nv -1 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n");
  write_file(folder / "triangle.ply",
             "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\nproperty float y\nproperty float z\n"
             "property float u\nproperty float v\nelement face 1\nproperty list uchar int vertex_indices\n"
             "end_header\n-1 -1 0 0 0\n1 -1 0 1 0\n-1 1 0 0 1\n3 0 1 2\n");
  write_file(folder / "surfaces.pbrt",
             R"(Texture "checks" "spectrum" "imagemap" "string filename" "checks.png"
Material "diffuse" "texture reflectance" "checks"
Shape "plymesh" "string filename" "triangle.ply"
)");
  write_file(folder / "paint.mtl", "newmtl paint\nmap_Kd checks.png\n");
  fs::copy_file(TESSERA_SOURCE_DIR "/tests/twins/checks.png", folder / "checks.png");
}

class Formats : public FarmTest, public ::testing::WithParamInterface<ForeignScene> {
 protected:
  Formats() {
    fs::create_directories(scenes_);
    write_assets(scenes_);
    write_file(scenes_ / GetParam().name, GetParam().text);
  }
  // The digests of the scene's files, in hexadecimal, by name.
  std::map<std::string, std::string> digests() const {
    std::map<std::string, std::string> all;
    const auto add = [&](const std::string& name) {
      all[name] = proto::digest_of(read_file(scenes_ / name)).hex();
    };
    add(GetParam().name);
    for (const std::string& name : GetParam().assets) add(name);
    return all;
  }

  const fs::path scenes_ = folder_ / "scenes";
};

std::map<std::string, std::string> digests_of(const v1::Job& job) {
  std::map<std::string, std::string> all;
  for (const v1::Bundle::Asset& asset : job.bundle().assets())
    all[asset.path()] = proto::from_proto(asset.digest())->hex();
  return all;
}

// The worker starts when the files are gone from this machine.
TEST_P(Formats, HaveTheBytesOfALocalRender) {
  const std::string scene = (scenes_ / GetParam().name).string();
  const std::vector<std::string> size{"--size", "60x44", "--spp", "3"};
  const auto with_size = [&](std::vector<std::string> arguments) {
    arguments.insert(arguments.end(), size.begin(), size.end());
    return arguments;
  };
  const fs::path here = folder_ / "here.exr";
  const Outcome rendered = tessera(with_size({"render", scene, "-o", here.string()}));
  ASSERT_EQ(rendered.exit_code, 0) << rendered.err;

  start_coordinator();
  const Outcome submitted = tessera(with_size({"submit", scene}));
  ASSERT_EQ(submitted.exit_code, 0) << submitted.err;
  const std::string id = submitted.out.substr(0, submitted.out.find('\n'));
  const auto sent = digests();
  fs::remove_all(scenes_);
  start_worker("worker", 1);
  ASSERT_TRUE(wait_for_state(id, v1::JOB_STATE_DONE)) << job(id).failure();
  EXPECT_EQ(digests_of(job(id)), sent);
  const std::string local = read_file(here);
  EXPECT_FALSE(local.empty());
  EXPECT_TRUE(image(id, ".exr") == local);
}

INSTANTIATE_TEST_SUITE_P(All, Formats, ::testing::Values(kGltfScene, kPbrtScene, kMitsubaScene, kBareMesh),
                         [](const auto& scene) {
                           return fs::path(scene.param.name).extension().string().substr(1);
                         });

}  // namespace
}  // namespace tessera::test
