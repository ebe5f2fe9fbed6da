// SPDX-License-Identifier: Apache-2.0
#include "core/scene/validate_textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <string_view>

#include "core/scene/tables/check.hpp"
#include "core/scene/tables/texture_tables.hpp"

namespace tessera::core {
namespace {

// The number of textures that one evaluates, with itself. `weights` are those of the textures before it.
int weight_of(const Pattern& pattern, const std::vector<int>& weights) {
  int weight = 1;
  visit_inputs(pattern, [&](const auto& input) {
    if (input.texture >= 0)
      weight = std::min(kMaxTextureWeight + 1, weight + weights[static_cast<std::size_t>(input.texture)]);
  });
  return weight;
}

bool is_finite_map(const Transform& t) {
  return is_finite(t.x_axis) && is_finite(t.y_axis) && is_finite(t.z_axis) && is_finite(t.origin);
}

// The layers of a grid fill an image of whole layers.
Status check_grid(const GridPattern& grid, const std::vector<Texture>& textures) {
  if (grid.layers.texture < 0) return {};
  if (!is_image(grid.layers.texture, textures))
    return fail(ErrorCode::kInvalidArgument, "layers: the texture must be an image");
  const TextureImage& image = *textures[static_cast<std::size_t>(grid.layers.texture)].image;
  if (image.width() % grid.columns != 0 || image.height() % grid.rows() != 0)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("layers: an image of {} x {} cannot be divided into {} columns and {} rows",
                            image.width(), image.height(), grid.columns, grid.rows()));
  return {};
}

// Inputs are counted by those that stand before the texture.
Status check_procedural(const ProceduralTexture& texture, const std::vector<int>& weights,
                        const std::vector<Texture>& textures) {
  const NameCounts counts{.textures = weights.size()};
  auto mistake = find_mistake(kKeys<ProceduralTexture>, texture, counts);
  if (!mistake)
    mistake =
        std::visit([&]<typename P>(const P& pattern) { return find_mistake(kKeys<P>, pattern, counts); },
                   texture.pattern);
  if (mistake) return fail(ErrorCode::kInvalidArgument, mistake->text());
  if (!is_finite_map(texture.transform))
    return fail(ErrorCode::kInvalidArgument, "the transform must be finite");
  if (weight_of(texture.pattern, weights) > kMaxTextureWeight)
    return fail(ErrorCode::kInvalidArgument,
                fmt::format("it refers to more than {} textures", kMaxTextureWeight));
  const auto* grid = std::get_if<GridPattern>(&texture.pattern);
  return grid == nullptr ? Status() : check_grid(*grid, textures);
}

}  // namespace

Status check_textures(const std::vector<Texture>& textures) {
  std::vector<int> weights;
  for (const Texture& texture : textures) {
    const auto within = fmt::format("textures[{}]", weights.size());
    if (texture.procedural.has_value() == (texture.image != nullptr))
      return fail(ErrorCode::kInvalidArgument, within + ": must be an image or a procedural texture");
    if (!texture.procedural) {
      weights.push_back(1);
      continue;
    }
    if (auto ok = check_procedural(*texture.procedural, weights, textures); !ok)
      return fail(ok.error().within(within));
    weights.push_back(weight_of(texture.procedural->pattern, weights));
  }
  return {};
}

bool is_image(int texture, const std::vector<Texture>& textures) {
  return texture < 0 || texture >= static_cast<int>(textures.size()) ||
         !textures[static_cast<std::size_t>(texture)].procedural;
}

}  // namespace tessera::core
