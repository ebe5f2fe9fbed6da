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
#include "core/textures/texture.hpp"

namespace tessera::core {

// The path of a file that another one names, as in "models/house.obj" naming "house.mtl".
std::string path_beside(const std::string& file, const std::string& name);

class AssetCache {
 public:
  explicit AssetCache(AssetSource& assets) : assets_(assets) {}

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

  AssetSource& assets_;
  std::map<std::pair<std::string, ColorSpace>, std::shared_ptr<const TextureImage>> images_;
  std::map<std::string, std::shared_ptr<const ObjFile>> objs_;
};

}  // namespace tessera::core
