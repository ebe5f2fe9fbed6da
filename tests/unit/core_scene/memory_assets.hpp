// SPDX-License-Identifier: Apache-2.0
// A scene and its files in memory, for tests.
#pragma once

#include <map>
#include <string>

#include "core/image/image.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::core::test {

class MemoryAssets : public AssetSource {
 public:
  using Files = std::map<std::string, std::string>;
  explicit MemoryAssets(Files files) : files_(std::move(files)) {}

  bool exists(const std::string& path) override { return files_.contains(path); }
  Result<std::string> read(const std::string& path) override;

  // How often each file was read.
  const std::map<std::string, int>& reads() const { return reads_; }

 private:
  Files files_;
  std::map<std::string, int> reads_;
};

// A triangle with a texture coordinate at each corner.
inline constexpr const char* kTriangleObj =
    "v 0 0 0\nv 1 0 0\nv 0 1 0\nvt 0 0\nvt 1 0\nvt 0 1\nf 1/1 2/2 3/3\n";

// Loads `scene`, called "scene.json", with other files beside it: those given, triangle.obj, and a small
// gray.png.
Result<SceneDescription> load(const std::string& scene, const MemoryAssets::Files& files = {});

// load() of a scene without mistakes.
SceneDescription load_valid(const std::string& scene, const MemoryAssets::Files& files = {});

// The error's message of load(), or "no mistake".
std::string mistakes_in(const std::string& scene, const MemoryAssets::Files& files = {});

// A scene with a camera and a light and the given further keys of the top level ("\"textures\": {...}"),
// materials and shapes, each in a line of its own: keys in line 2, materials in line 3, shapes in line 4.
std::string scene_with(const std::string& keys, const std::string& materials, const std::string& shapes);

std::string png(const Image& image);
std::string hdr(const Image& image);
// One pixel of the channels R, G, B, Depth.Z, Tint.R, Tint.G and Tint.B with the values 1/8 to 7/8.
std::string layered_exr();
Image one_color(int width, int height, Rgb color);

}  // namespace tessera::core::test
