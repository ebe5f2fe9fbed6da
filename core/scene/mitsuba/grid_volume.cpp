// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/grid_volume.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <string_view>
#include <utility>
#include <vector>

#include "core/base/suggestion.hpp"
#include "core/geometry/placement.hpp"
#include "core/scene/loader/volume_reader.hpp"

namespace tessera::core::mitsuba {
namespace {

// The box in a file of a grid, as a map from the unit cube.
Transform box_of(std::string_view bytes) {
  constexpr std::size_t kOffset = 24;
  std::array<float, 6> box{};
  if (bytes.size() < kOffset + sizeof(box)) return {};
  std::memcpy(box.data(), bytes.data() + kOffset, sizeof(box));
  const Vec3 lower{box[0], box[1], box[2]}, upper{box[3], box[4], box[5]};
  return compose(translation(lower), scaling(upper - lower));
}

std::optional<Transform> inverse(const Transform& map) {
  if (!Placement::can_place(map)) return std::nullopt;
  const Placement placement(map);
  const auto point = [&](Vec3 p) { return placement.object_point(Vec3d(p)); };
  const auto axis = [&](Vec3 along) { return (point(along) - point({})).rounded(); };
  return Transform{axis({1, 0, 0}), axis({0, 1, 0}), axis({0, 0, 1}), point({}).rounded()};
}

// About as many columns of layers as make the image a square.
int columns_for(const VoxelGrid& grid) {
  const double rows_of_texels = double{1} * grid.size[1] * grid.size[2];
  const auto columns = static_cast<std::uint32_t>(std::ceil(std::sqrt(rows_of_texels / grid.size[0])));
  return static_cast<int>(std::clamp(columns, 1u, grid.size[2]));
}

// Layers that the grid lacks are black.
TextureImage image_of_layers(const VoxelGrid& grid, const GridPattern& pattern) {
  const std::size_t width = grid.size[0], height = grid.size[1], channels = grid.channels,
                    columns = static_cast<std::size_t>(pattern.columns);
  const std::size_t rows = static_cast<std::size_t>(pattern.rows()) * height,
                    row_length = columns * width * 3;
  std::vector<float> texels(rows * row_length, 0.0f);
  for (std::size_t i = 0; i < grid.voxel_count(); ++i) {
    const std::size_t x = i % width, y = i / width % height, z = i / width / height;
    float* texel = &texels[(z / columns * height + y) * row_length + (z % columns * width + x) * 3];
    for (std::size_t channel = 0; channel < 3; ++channel)
      texel[channel] = grid.values[i * channels + (channels == 3 ? channel : 0)];
  }
  return TextureImage(static_cast<int>(columns * width), static_cast<int>(rows), std::move(texels));
}

}  // namespace

Wrap wrap_of(const Plugin& plugin, Wrap otherwise) {
  constexpr std::array<std::pair<std::string_view, Wrap>, 3> kModes{
      {{"repeat", Wrap::kRepeat}, {"clamp", Wrap::kClamp}, {"mirror", Wrap::kMirror}}};
  const auto mode = plugin.text("wrap_mode");
  if (!mode) return otherwise;
  for (const auto& [word, wrap] : kModes)
    if (*mode == word) return wrap;
  plugin.warn(fmt::format("the wrap_mode {} is not known; the default is used", in_quotes(*mode)));
  return otherwise;
}

std::optional<PlacedGrid> read_grid_volume(Conversion& conversion, const Plugin& volume) {
  volume.ignore({"raw", "accel"});
  const std::string written = volume.text("filename").value_or("");
  const auto path = conversion.find_file(written);
  const auto bytes =
      path ? conversion.builder.read(*path)
           : Result<std::string>(fail(ErrorCode::kNotFound, in_quotes(written) + " does not exist"));
  if (!bytes) {
    volume.warn(bytes.error().message);
    return std::nullopt;
  }
  auto grid = conversion.builder.files().grid(*path);
  if (!grid) {
    if (grid.error().code == ErrorCode::kResourceExhausted) conversion.check(fail(grid.error()));
    volume.warn(grid.error().message);
    return std::nullopt;
  }
  if (volume.text("filter_type").value_or("trilinear") == "nearest") grid->filter = GridFilter::kNearest;
  Transform to_world = volume.transform("to_world");
  if (volume.flag("use_grid_bbox", false)) to_world = compose(to_world, box_of(*bytes));
  return PlacedGrid{std::move(*grid), to_world, wrap_of(volume, Wrap::kClamp)};
}

std::optional<Texture> grid_texture(Conversion& conversion, const Plugin& volume, const PlacedGrid& placed) {
  const auto from_world = inverse(placed.to_world);
  if (!from_world) {
    volume.warn("'to_world' has no inverse; the grid is left out");
    return std::nullopt;
  }
  static_assert(kMaxGridSide <= kMaxGridLayers);
  const VoxelGrid& grid = placed.grid;
  GridPattern pattern{
      .depth = static_cast<int>(grid.size[2]), .columns = columns_for(grid), .wrap = placed.wrap};
  if (grid.filter == GridFilter::kNearest) pattern.filter = TextureFilter::kNearest;
  const TextureSize size{static_cast<int>(grid.size[0]) * pattern.columns,
                         static_cast<int>(grid.size[1]) * pattern.rows()};
  auto image = conversion.builder.image_pixels("layers of " + volume.shown(), size,
                                               [&] { return image_of_layers(grid, pattern); });
  if (!image) {
    conversion.check(fail(image.error()));
    return std::nullopt;
  }
  ProceduralTexture texture{.transform = *from_world};
  texture.max = std::clamp(max_component((*image)->largest()), 1e-6f, kMaxPatternValue);
  pattern.layers.texture = conversion.builder.add_texture({.image = std::move(*image)});
  texture.pattern = pattern;
  return Texture{.image = nullptr, .procedural = texture};
}

}  // namespace tessera::core::mitsuba
