#include "core/scene/loader/asset_cache.hpp"

#include <fmt/format.h>

#include <new>

#include "core/image/hdr_check.hpp"
#include "core/scene/loader/text_lines.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core {

std::string path_beside(const std::string& file, const std::string& name) {
  const std::size_t slash = file.rfind('/');
  return slash == std::string::npos || name.starts_with('/') ? name : file.substr(0, slash + 1) + name;
}

Result<std::shared_ptr<const TextureImage>> AssetCache::image(const std::string& path,
                                                              std::optional<ColorSpace> color_space) {
  const ColorSpace space = color_space.value_or(ColorSpace::kSrgb);
  const auto known = images_.find({path, space});
  if (known != images_.end()) return known->second;
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  if (color_space == ColorSpace::kSrgb && is_hdr_picture(*bytes))
    return fail(ErrorCode::kInvalidArgument,
                in_quotes(path) + " is an HDR picture, which is linear; leave 'color_space' out");
  if (const auto size = texture_size(*bytes))
    if (auto counted = count_pixels(path, *size); !counted) return fail(counted.error());
  auto decoded = decode_texture_image(*bytes, space);
  if (!decoded)
    return fail(decoded.error().code, fmt::format("{} {}", in_quotes(path), decoded.error().message));
  auto shared = std::make_shared<const TextureImage>(std::move(*decoded));
  images_.emplace(std::pair(path, space), shared);
  return shared;
}

// Before anything is decompressed. What decoding makes has the same size.
Status AssetCache::count_pixels(const std::string& path, TextureSize size) {
  const auto& [triangles, of_one, of_all] = limits_;
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

Result<std::shared_ptr<const ObjFile>> AssetCache::obj(const std::string& path) {
  const auto known = objs_.find(path);
  if (known != objs_.end()) return known->second;
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  auto file = read_obj(*bytes, path, limits_.triangles);
  if (!file) return fail(file.error());
  auto shared = std::make_shared<const ObjFile>(std::move(*file));
  objs_.emplace(path, shared);
  return shared;
}

Result<std::vector<AssetCache::Library>> AssetCache::libraries(const std::string& obj_path,
                                                               const std::string& line) {
  auto whole = library(path_beside(obj_path, line));
  if (whole) return std::vector{std::move(*whole)};
  const bool several = line.find_first_of(" \t") != std::string::npos;
  if (whole.error().code != ErrorCode::kNotFound || !several) return fail(whole.error());
  std::vector<Library> all;
  std::string_view rest = name_without_comment(line);
  if (rest.size() < line.size()) return libraries(obj_path, std::string(rest));
  for (auto word = take_word(rest); !word.empty(); word = take_word(rest)) {
    auto one = library(path_beside(obj_path, std::string(word)));
    if (!one) return fail(one.error());
    all.push_back(std::move(*one));
  }
  return all;
}

Result<AssetCache::Library> AssetCache::library(const std::string& path) {
  const auto bytes = assets_.read(path);
  if (!bytes) return fail(bytes.error());
  auto materials = read_mtl(*bytes, path);
  if (!materials) return fail(materials.error());
  return Library{path, std::move(*materials)};
}

}  // namespace tessera::core
