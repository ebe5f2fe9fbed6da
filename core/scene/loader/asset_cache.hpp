// SPDX-License-Identifier: Apache-2.0
// Reads a scene's assets through an AssetSource, each image and each OBJ file once, and collects the warnings
// of image decoders. Not thread-safe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <string_view>
#include <tuple>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/asset_source.hpp"
#include "core/scene/loader/file_warnings.hpp"
#include "core/scene/loader/mtl_reader.hpp"
#include "core/scene/loader/obj_reader.hpp"
#include "core/scene/loader/scene_limits.hpp"
#include "core/textures/image_decoder.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

// The path of a file named by another file: "house.mtl" in "models/house.obj" is "models/house.mtl".
std::string path_beside(const std::string& file, const std::string& name);

class AssetCache {
 public:
  // The arguments must outlive this object.
  AssetCache(AssetSource& assets, const SceneLimits& limits, SceneWarnings& warnings)
      : assets_(assets), limits_(limits), warnings_(warnings) {}

  // Without a colour space, PNG and JPEG are sRGB and HDR is linear. Alpha is a separate image, so that it
  // takes memory only if requested; it is linear, and 1 if the file has none.
  Result<std::shared_ptr<const TextureImage>> image(const std::string& path,
                                                    std::optional<ColorSpace> color_space,
                                                    TextureChannel channel = TextureChannel::kColor);
  Result<std::shared_ptr<const ObjFile>> obj(const std::string& path);
  Result<std::shared_ptr<const MtlFile>> mtl(const std::string& path);

  // The path under which read() finds a file that another program's file calls `written`. Tries the name as
  // written, with '/' for '\', then its last component, beside each of `files`; then ignoring case if
  // exactly one file matches. nullopt if there is none.
  std::optional<std::string> find(const std::string& written, const std::vector<std::string>& files);

 private:
  // Adds the pixels to the scene's total, if the limits allow it.
  Status count_pixels(const std::string& path, TextureSize size);
  Result<TextureImage> decode(const std::string& path, std::string_view bytes, ColorSpace color_space,
                              TextureChannel channel);

  AssetSource& assets_;
  const SceneLimits& limits_;
  SceneWarnings& warnings_;
  std::uint64_t texture_pixels_ = 0;  // of images_
  const std::shared_ptr<const TextureImage> opaque_ = std::make_shared<const TextureImage>(
      1, 1, std::vector<std::uint8_t>{255, 255, 255}, ColorSpace::kLinear);
  using ImageKey = std::tuple<std::string, ColorSpace, TextureChannel>;
  std::map<ImageKey, std::shared_ptr<const TextureImage>> images_;
  std::map<std::string, std::shared_ptr<const ObjFile>> objs_;
  std::map<std::string, std::shared_ptr<const MtlFile>> mtls_;
};

}  // namespace tessera::core
