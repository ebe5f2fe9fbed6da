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

// The path of a file that another one names, as in "models/house.obj" naming "house.mtl".
std::string path_beside(const std::string& file, const std::string& name);

class AssetCache {
 public:
  // All must outlive this object.
  AssetCache(AssetSource& assets, const SceneLimits& limits, SceneWarnings& warnings)
      : assets_(assets), limits_(limits), warnings_(warnings) {}

  // Without a colour space, PNG and JPEG are sRGB and HDR is linear. Alpha is an image of its own, so that
  // it takes memory only where it is asked for, and is linear; a file without alpha has 1.
  Result<std::shared_ptr<const TextureImage>> image(const std::string& path,
                                                    std::optional<ColorSpace> color_space,
                                                    TextureChannel channel = TextureChannel::kColor);
  Result<std::shared_ptr<const ObjFile>> obj(const std::string& path);
  Result<std::shared_ptr<const MtlFile>> mtl(const std::string& path);

  // The name by which read() finds a file that another program's file calls `written`: the name as it is
  // written, with '/' for '\', or its last part, beside one of `files`; with another case of letters if
  // nothing has the case that is written, and one file alone fits. nullopt if there is none.
  std::optional<std::string> find(const std::string& written, const std::vector<std::string>& files);

 private:
  // Adds them to those of the scene, if the limits allow it.
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
