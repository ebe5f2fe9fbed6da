// SPDX-License-Identifier: Apache-2.0
// Layers of image files by the names that the file has ("Normal", "Depth.Z") or by those of scene files
// ("normal"), which jobs have as well. Blocks for the disk.
#pragma once

#include <string>
#include <vector>

#include "core/base/error.hpp"
#include "core/image/image.hpp"

namespace tessera::client {

// An image file in memory. Error messages begin with the file's name.
class ImageFile {
 public:
  static core::Result<ImageFile> read(const std::string& path);

  const std::string& path() const { return path_; }
  // As core::image_layers().
  const std::vector<std::string>& layers() const { return layers_; }
  // The image, or the layer of this name. The error for an unknown one says which there are.
  core::Result<core::Image> decode(const std::string& layer) const;

 private:
  std::string path_, bytes_;
  std::vector<std::string> layers_;
};

}  // namespace tessera::client
