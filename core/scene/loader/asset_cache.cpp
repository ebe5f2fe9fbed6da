// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/asset_cache.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <string_view>

#include "core/image/codecs.hpp"
#include "core/scene/loader/file_names.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/volume_reader.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {
namespace {

// Candidate paths for a file that another program's file names as `written`, the most likely first.
std::vector<std::string> possible_paths(const std::string& written, const std::vector<std::string>& files) {
  std::vector<std::string> names{written};
  const auto add = [](std::vector<std::string>& list, std::string one) {
    if (!one.empty() && std::find(list.begin(), list.end(), one) == list.end())
      list.push_back(std::move(one));
  };
  add(names, std::string(name_without_comment(written)));
  add(names, written.substr(0, written.find(" -")));  // options after the name
  add(names, decode_percent(written));
  add(names, windows_1252_as_utf8(written).value_or(""));
  std::vector<std::string> paths;
  for (const std::string& name : names)
    for (const std::string& file : files) add(paths, path_beside(file, name));
  for (std::string name : names) {
    std::replace(name.begin(), name.end(), '\\', '/');
    for (const std::string& file : files) add(paths, path_beside(file, name));
    for (const std::string& file : files) add(paths, path_beside(file, name.substr(name.rfind('/') + 1)));
  }
  return paths;
}

// Checks without decoding. Unknown formats may have alpha.
bool may_have_alpha(std::string_view bytes) {
  if (bytes.starts_with("\xff\xd8") || is_linear_format(bytes)) return false;
  constexpr std::size_t kColorTypeAt = 25;
  if (!bytes.starts_with("\x89PNG") || bytes.size() <= kColorTypeAt) return true;
  const char color_type = bytes[kColorTypeAt];
  return color_type == 4 || color_type == 6 || bytes.substr(0, bytes.find("IDAT")).find("tRNS") != bytes.npos;
}

}  // namespace

std::string path_beside(const std::string& file, const std::string& name) {
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos || name.starts_with('/') ? name : file.substr(0, slash + 1) + name;
}

// Numbers are not encoded.
AssetCache::ImageKey AssetCache::key_of(const std::string& name, std::optional<ColorSpace> color_space,
                                        TextureChannel channel, const std::string& layer) {
  const bool is_alpha = channel == TextureChannel::kAlpha;
  return {name, is_alpha ? ColorSpace::kLinear : color_space.value_or(ColorSpace::kSrgb), channel, layer};
}

Result<std::shared_ptr<const TextureImage>> AssetCache::image(const std::string& path,
                                                              std::optional<ColorSpace> color_space,
                                                              TextureChannel channel, FloatFiles floats,
                                                              const std::string& layer) {
  const ImageKey key = key_of(path, color_space, channel, layer);
  const auto known = images_.find(key);
  if (known != images_.end()) return known->second;
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  if (floats == FloatFiles::kRefuseSrgb && color_space == ColorSpace::kSrgb && is_linear_format(*bytes))
    return fail(
        ErrorCode::kInvalidArgument,
        in_quotes(path) + " has linear values, as all HDR, EXR and PFM images; leave 'color_space' out");
  return add_image(key, *bytes);
}

Result<std::shared_ptr<const TextureImage>> AssetCache::image_in_memory(const std::string& name,
                                                                        std::string_view bytes,
                                                                        ColorSpace color_space,
                                                                        TextureChannel channel) {
  const ImageKey key = key_of(name, color_space, channel);
  const auto known = images_.find(key);
  return known != images_.end() ? known->second : add_image(key, bytes);
}

Result<std::shared_ptr<const TextureImage>> AssetCache::add_image(const ImageKey& key,
                                                                  std::string_view bytes) {
  const auto& [name, color_space, channel, layer] = key;
  if (channel == TextureChannel::kAlpha && !may_have_alpha(bytes) && layer.empty()) return opaque_;
  if (const auto size = texture_size(bytes))
    if (auto counted = count_pixels(name, *size); !counted) return fail(counted.error());
  auto decoded = decode(key, bytes);
  if (!decoded) return fail(decoded.error());
  auto shared = std::make_shared<const TextureImage>(std::move(*decoded));
  images_.emplace(key, shared);
  return shared;
}

// Called before decompression. The decoded image has the same size.
Status AssetCache::count_pixels(const std::string& path, TextureSize size) {
  const SceneLimit& of_one = limits_.texture_pixels;
  const SceneLimit& of_all = limits_.scene_texture_pixels;
  if (size.pixels() > of_one.most)
    return fail(
        ErrorCode::kResourceExhausted,
        fmt::format("{} has {} x {} = {} pixels, more than the {} that a texture may have here ({})",
                    in_quotes(path), size.width, size.height, size.pixels(), of_one.most, of_one.option));
  if (size.pixels() > of_all.most - texture_pixels_)
    return fail(ErrorCode::kResourceExhausted,
                fmt::format("with {} the scene's textures have {} pixels, more than the {} that a scene's "
                            "may have here ({})",
                            in_quotes(path), texture_pixels_ + size.pixels(), of_all.most, of_all.option));
  texture_pixels_ += size.pixels();
  return {};
}

// A file that is decoded more than once, as for its alpha, warns the first time.
Result<TextureImage> AssetCache::decode(const ImageKey& key, std::string_view bytes) {
  const auto& [path, color_space, channel, layer] = key;
  std::vector<std::string> oddities;
  auto decoded = decode_texture_image(bytes, color_space, channel, &oddities, layer);
  if (!decoded)
    return fail(decoded.error().code, fmt::format("{} {}", in_quotes(path), decoded.error().message));
  if (!oddities.empty() && !warnings_.knows(path))
    for (const std::string& oddity : oddities) warnings_.of(path).add(oddity, 0, [&] { return oddity; });
  return decoded;
}

Result<VoxelGrid> AssetCache::grid(const std::string& path) {
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  auto grid = read_volume(*bytes);
  if (!grid) return fail(grid.error().code, fmt::format("{} {}", in_quotes(path), grid.error().message));
  const auto rows = static_cast<int>(
      std::min<std::size_t>(grid->voxel_count() / grid->size[0], std::numeric_limits<int>::max()));
  if (auto counted = count_pixels(path, {static_cast<int>(grid->size[0]), rows}); !counted)
    return fail(counted.error());
  return grid;
}

Result<std::shared_ptr<const ObjFile>> AssetCache::obj(const std::string& path) {
  const auto known = objs_.find(path);
  if (known != objs_.end()) return known->second;
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  auto file = read_obj(*bytes, path, limits_.triangles, limits_.warnings);
  if (!file) return fail(file.error());
  auto shared = std::make_shared<const ObjFile>(std::move(*file));
  objs_.emplace(path, shared);
  return shared;
}

Result<std::shared_ptr<const MtlFile>> AssetCache::mtl(const std::string& path) {
  const auto known = mtls_.find(path);
  if (known != mtls_.end()) return known->second;
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  return mtls_.emplace(path, std::make_shared<const MtlFile>(read_mtl(*bytes, limits_.warnings)))
      .first->second;
}

std::optional<std::string> AssetCache::find(const std::string& written,
                                            const std::vector<std::string>& files) {
  const std::vector<std::string> paths = possible_paths(written, files);
  for (const std::string& path : paths)
    if (assets_.exists(path)) return path;
  for (const std::string& path : paths)
    if (auto found = assets_.find_in_any_spelling(path); found.size() == 1) return std::move(found.front());
  if (!paths.empty()) assets_.miss(paths.front());
  return std::nullopt;
}

}  // namespace tessera::core
