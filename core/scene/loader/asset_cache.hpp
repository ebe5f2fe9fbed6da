// Reads a scene's assets through an AssetSource, each picture and each OBJ file once. Not thread-safe.
#pragma once

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/base/error.hpp"
#include "core/scene/loader/asset_source.hpp"
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
  // Both must stay until this is destroyed.
  AssetCache(AssetSource& assets, const SceneLimits& limits) : assets_(assets), limits_(limits) {}

  // Without a colour space, PNG and JPEG are sRGB and HDR is linear.
  Result<std::shared_ptr<const TextureImage>> image(const std::string& path,
                                                    std::optional<ColorSpace> color_space);
  Result<std::shared_ptr<const ObjFile>> obj(const std::string& path);
  // The materials of an OBJ file's "mtllib" line. The line is one name with spaces in it, or several names.
  struct Library {
    std::string path;
    std::vector<MtlMaterial> materials;
  };
  Result<std::vector<Library>> libraries(const std::string& obj_path, const std::string& line);

 private:
  Result<Library> library(const std::string& path);
  // Adds them to those of the scene, if the limits allow it.
  Status count_pixels(const std::string& path, TextureSize size);

  AssetSource& assets_;
  const SceneLimits& limits_;
  std::uint64_t texture_pixels_ = 0;  // of images_
  std::map<std::pair<std::string, ColorSpace>, std::shared_ptr<const TextureImage>> images_;
  std::map<std::string, std::shared_ptr<const ObjFile>> objs_;
};

}  // namespace tessera::core
