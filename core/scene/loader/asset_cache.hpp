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
#include "core/media/voxel_grid.hpp"
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

// What a colour space means for a file of floats, which is always linear.
enum class FloatFiles { kRefuseSrgb, kAlwaysLinear };

class AssetCache {
 public:
  // The arguments must outlive this object.
  AssetCache(AssetSource& assets, const SceneLimits& limits, SceneWarnings& warnings)
      : assets_(assets), limits_(limits), warnings_(warnings) {}

  // Without a colour space, PNG and JPEG are sRGB and HDR is linear. Alpha is a separate image, so that it
  // takes memory only if requested; it is linear, and 1 if the file has none. `layer` is that of OpenEXR
  // files (DecodeOptions).
  Result<std::shared_ptr<const TextureImage>> image(const std::string& path,
                                                    std::optional<ColorSpace> color_space,
                                                    TextureChannel channel = TextureChannel::kColor,
                                                    FloatFiles floats = FloatFiles::kRefuseSrgb,
                                                    const std::string& layer = {});
  // The same for an image file in memory. `name` identifies it, and is its name in messages.
  Result<std::shared_ptr<const TextureImage>> image_in_memory(const std::string& name, std::string_view bytes,
                                                              ColorSpace color_space, TextureChannel channel);
  // A grid of a medium (volume_reader.hpp), not shared. Its voxels count as pixels of textures.
  Result<VoxelGrid> grid(const std::string& path);
  Result<std::shared_ptr<const ObjFile>> obj(const std::string& path);
  Result<std::shared_ptr<const MtlFile>> mtl(const std::string& path);

  // The path under which read() finds a file that another program's file calls `written`. Tries the name as
  // written, with %XX as bytes and from Windows-1252, with '/' for '\', then its last component, beside each
  // of `files`; then in any spelling if exactly one file matches. nullopt if there is none.
  std::optional<std::string> find(const std::string& written, const std::vector<std::string>& files);
  // Adds the pixels of an image to the scene's total, if the limits allow it.
  Status count_pixels(const std::string& path, TextureSize size);

 private:
  using ImageKey = std::tuple<std::string, ColorSpace, TextureChannel, std::string>;  // with the layer

  static ImageKey key_of(const std::string& name, std::optional<ColorSpace> color_space,
                         TextureChannel channel, const std::string& layer = {});
  Result<std::shared_ptr<const TextureImage>> add_image(const ImageKey& key, std::string_view bytes);
  Result<TextureImage> decode(const ImageKey& key, std::string_view bytes);

  AssetSource& assets_;
  const SceneLimits& limits_;
  SceneWarnings& warnings_;
  std::uint64_t texture_pixels_ = 0;  // of images_
  const std::shared_ptr<const TextureImage> opaque_ = std::make_shared<const TextureImage>(
      1, 1, std::vector<std::uint8_t>{255, 255, 255}, ColorSpace::kLinear);
  std::map<ImageKey, std::shared_ptr<const TextureImage>> images_;
  std::map<std::string, std::shared_ptr<const ObjFile>> objs_;
  std::map<std::string, std::shared_ptr<const MtlFile>> mtls_;
};

}  // namespace tessera::core
