// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/core_scene/memory_assets.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <array>
#include <utility>

#include "core/image/encode.hpp"

namespace tessera::core::test {

Result<std::string> MemoryAssets::read(const std::string& path) {
  ++reads_[path];
  const auto found = files_.find(path);
  if (found == files_.end()) return fail(ErrorCode::kNotFound, "'" + path + "' does not exist");
  return found->second;
}

Result<SceneDescription> load(const std::string& scene, const MemoryAssets::Files& files) {
  MemoryAssets::Files all = files;
  all.emplace("scene.json", scene);
  all.emplace("triangle.obj", kTriangleObj);
  all.emplace("gray.png", png(one_color(2, 2, Rgb::gray(0.5f))));
  MemoryAssets assets(std::move(all));
  return load_scene(assets, "scene.json", "scene.json");
}

SceneDescription load_valid(const std::string& scene, const MemoryAssets::Files& files) {
  auto loaded = load(scene, files);
  EXPECT_TRUE(loaded.has_value()) << loaded.error().message;
  return loaded ? std::move(*loaded) : SceneDescription{};
}

std::string mistakes_in(const std::string& scene, const MemoryAssets::Files& files) {
  const auto loaded = load(scene, files);
  return loaded ? "no mistake" : loaded.error().message;
}

std::string scene_with(const std::string& keys, const std::string& materials, const std::string& shapes) {
  const auto comma = [](const std::string& text) { return text.empty() ? "" : text + ","; };
  return fmt::format(
      "{{\"camera\": {{\"position\": [0, 0, 5], \"look_at\": [0, 0, 0]}},\n{}\n"
      "\"materials\": {{{} \"light\": {{\"type\": \"lambert\", \"emission\": 1}}}},\n"
      "\"shapes\": [{} {{\"type\": \"sphere\", \"radius\": 1, \"material\": \"light\"}}]}}\n",
      comma(keys), comma(materials), comma(shapes));
}

std::string png(const Image& image) {
  return *encode_image(image, ImageFormat::kPng);
}
std::string layered_exr() {
  static constexpr std::array kValues{0.125f, 0.25f, 0.375f, 0.5f, 0.625f, 0.75f, 0.875f};
  ChannelRows source;
  source.width = source.height = 1;
  source.channels = {"R", "G", "B", "Depth.Z", "Tint.R", "Tint.G", "Tint.B"};
  source.row = [](int) -> Result<const float*> { return kValues.data(); };
  return encode_channels(source, ImageFormat::kExr, {}).value_or("");
}
std::string hdr(const Image& image) {
  return *encode_image(image, ImageFormat::kHdr);
}

Image one_color(int width, int height, Rgb color) {
  Image image(width, height);
  for (Rgb& pixel : image.pixels) pixel = color;
  return image;
}

}  // namespace tessera::core::test
