// SPDX-License-Identifier: Apache-2.0
#include "client/image_layers.hpp"

#include <algorithm>
#include <bit>
#include <utility>

#include "core/film/develop.hpp"
#include "core/film/layers.hpp"
#include "core/image/codecs.hpp"
#include "core/image/decode.hpp"
#include "core/image/file_io.hpp"

namespace tessera::client {
namespace {

// As the files of tessera name this layer: "Normal" for "normal", "Combined_key" for "group.key". Other names
// stay.
std::string name_in_files(const std::string& layer) {
  const auto set = core::parse_layers(layer);
  if (!set || set->light_groups || std::popcount(set->bits) + set->groups.size() != 1) return layer;
  const std::string channel = core::image_channels(*set).at(core::image_channels({}).size());
  return channel.substr(0, std::min(channel.rfind('.'), channel.size()));
}

core::Error of_file(const std::string& path, const core::Error& error) {
  return {error.code, "'" + path + "' " + error.message, error.details};
}

}  // namespace

core::Result<ImageFile> ImageFile::read(const std::string& path) {
  auto bytes = core::read_file(path);
  if (!bytes) return core::fail(bytes.error());
  auto layers = core::image_layers(*bytes);
  if (!layers) return core::fail(of_file(path, layers.error()));
  ImageFile file;
  file.path_ = path;
  file.bytes_ = *std::move(bytes);
  file.layers_ = *std::move(layers);
  return file;
}

core::Result<core::Image> ImageFile::decode(const std::string& layer) const {
  const auto has = [&](const std::string& name) { return std::ranges::count(layers_, name) > 0; };
  const std::string other_name = name_in_files(layer);
  auto image = core::decode_image(bytes_, has(other_name) && !has(layer) ? other_name : layer);
  if (!image) return core::fail(of_file(path_, image.error()));
  return image;
}

}  // namespace tessera::client
