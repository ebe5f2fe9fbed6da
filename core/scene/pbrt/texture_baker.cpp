// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/texture_baker.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cassert>
#include <cmath>
#include <optional>
#include <vector>

#include "core/base/overloaded.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr ValueRange kPatternRange{-kMaxPatternValue, kMaxPatternValue};

float clamped(float value, const ValueRange& range) {
  return std::isfinite(value) ? std::clamp(value, range.min, range.max) : 0.0f;
}
Rgb clamped(Rgb color, const ValueRange& range) {
  return {clamped(color.r, range), clamped(color.g, range), clamped(color.b, range)};
}

constexpr int kMaxBakedSide = 4096, kMaxCellTexels = 64, kMaxPeriods = 32;

// Along one axis of the texture coordinates: after which distance a texture repeats, and how many texels the
// distance needs. Constant along the axis where `period` is 0.
struct AxisNeed {
  double period = 0;
  int texels = 1;
  int cells = 1;  // edges lie at multiples of period / cells
};

// The parts of a texture that depend on the texture coordinates.
struct Needs {
  std::vector<AxisNeed> u, v;
  std::vector<UvMapping> mappings;
  bool clamps = false;     // an image that does not repeat
  bool has_cells = false;  // a checkerboard
};

AxisNeed image_need(float scale, int texels) {
  if (scale == 0) return {};
  return {1 / static_cast<double>(std::fabs(scale)), texels, 1};
}

AxisNeed checker_need(float scale) {
  if (scale == 0) return {};
  return {2 / static_cast<double>(std::fabs(scale)), 2 * kMaxCellTexels, 2};
}

void collect(const TextureNode& texture, Needs& needs) {
  if (const auto* image = std::get_if<ImageNode>(&texture.node)) {
    needs.u.push_back(image_need(image->mapping.scale.x, image->image->width()));
    needs.v.push_back(image_need(image->mapping.scale.y, image->image->height()));
    needs.mappings.push_back(image->mapping);
    needs.clamps |= image->wrap == Wrap::kClamp;
  } else if (const auto* checker = std::get_if<CheckerNode>(&texture.node)) {
    needs.u.push_back(checker_need(checker->mapping.scale.x));
    needs.v.push_back(checker_need(checker->mapping.scale.y));
    needs.mappings.push_back(checker->mapping);
    needs.has_cells = true;
  } else if (const auto* ramp = std::get_if<BilinearNode>(&texture.node)) {
    needs.u.push_back(image_need(ramp->mapping.scale.x, kMaxCellTexels));
    needs.v.push_back(image_need(ramp->mapping.scale.y, kMaxCellTexels));
    needs.mappings.push_back(ramp->mapping);
    needs.clamps = true;
  }
  visit_children(texture, [&](const TexturePtr& child) { collect(*child, needs); });
}

bool is_whole(double ratio) {
  return std::fabs(ratio - std::nearbyint(ratio)) < 1e-4 * std::max(1.0, ratio) && ratio > 0.5;
}

// The least multiple of `period` that is one of `other`, too.
std::optional<double> common_period(double period, double other) {
  for (int n = 1; n <= kMaxPeriods; ++n)
    if (is_whole(n * period / other)) return n * period;
  return std::nullopt;
}

struct Axis {
  double period = 1;
  int texels = 1;
  bool is_exact = true;
};

int limited_texels(double wanted, int cells) {
  const int whole_cells = std::max(1, static_cast<int>(std::ceil(std::min(wanted, 1e6) / cells)));
  return cells >= kMaxBakedSide ? kMaxBakedSide : std::min(whole_cells, kMaxBakedSide / cells) * cells;
}

// An image of this axis shows all needs, with whole texels in each cell of a checkerboard.
Axis merged(const std::vector<AxisNeed>& needs) {
  Axis axis;
  bool is_first = true;
  for (const AxisNeed& need : needs) {
    if (need.period == 0) continue;
    const auto common = is_first ? std::optional(need.period) : common_period(axis.period, need.period);
    axis.is_exact &= common.has_value();
    axis.period = common.value_or(axis.period);
    is_first = false;
  }
  double texels = 1;
  int cells = 1;
  for (const AxisNeed& need : needs) {
    if (need.period == 0) continue;
    const double periods = axis.period / need.period;
    texels = std::max(texels, periods * need.texels);
    if (need.cells > 1) cells = std::max(cells, static_cast<int>(std::min(periods * need.cells + 0.5, 1e5)));
  }
  axis.texels = limited_texels(texels, cells);
  return axis;
}

// The part of the texture coordinates that becomes an image: uv = origin + size * (s, t).
struct Domain {
  Vec2 origin{0, 0}, size{1, 1};
  int width = 1, height = 1;
  Wrap wrap = Wrap::kRepeat;
  bool is_exact = true;
};

Domain periodic_domain(const Needs& needs) {
  const Axis u = merged(needs.u), v = merged(needs.v);
  return {{0, 0},        {static_cast<float>(u.period), static_cast<float>(v.period)},
          u.texels,      v.texels,
          Wrap::kRepeat, u.is_exact && v.is_exact};
}

// Where all images have one mapping, the texels of the new image are theirs. Images that do not repeat are
// evaluated over the part that they cover.
Domain domain_of(const Needs& needs) {
  Domain domain = periodic_domain(needs);
  const UvMapping mapping = needs.mappings.front();
  const bool is_one_mapping = std::all_of(needs.mappings.begin(), needs.mappings.end(),
                                          [&](const UvMapping& other) { return other == mapping; });
  if (!needs.clamps && (!is_one_mapping || needs.has_cells)) return domain;
  domain.wrap = needs.clamps ? Wrap::kClamp : Wrap::kRepeat;
  domain.is_exact = is_one_mapping && !needs.has_cells;
  if (mapping.scale.x == 0 || mapping.scale.y == 0) return domain;
  domain.size = {1 / mapping.scale.x, 1 / mapping.scale.y};
  domain.origin = {-mapping.offset.x / mapping.scale.x, -mapping.offset.y / mapping.scale.y};
  return domain;
}

// Images have no negative values: the least one becomes 0.
void raise_to_0(std::vector<float>& values) {
  const float least = *std::min_element(values.begin(), values.end());
  if (least < 0)
    for (float& value : values) value -= least;
}

TextureImage evaluated(const TextureNode& texture, const Domain& domain, const ValueRange& range) {
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(domain.width) * static_cast<std::size_t>(domain.height) * 3);
  for (int row = 0; row < domain.height; ++row)
    for (int column = 0; column < domain.width; ++column) {
      const float s = (static_cast<float>(column) + 0.5f) / static_cast<float>(domain.width);
      const float t = 1 - (static_cast<float>(row) + 0.5f) / static_cast<float>(domain.height);
      const Rgb c =
          evaluate(texture, {domain.origin.x + domain.size.x * s, domain.origin.y + domain.size.y * t});
      for (int channel = 0; channel < 3; ++channel) values.push_back(clamped(c[channel], range));
    }
  raise_to_0(values);
  return TextureImage(domain.width, domain.height, std::move(values));
}

Texture placed(std::shared_ptr<const TextureImage> image, Wrap wrap, const UvMapping& mapping) {
  Texture texture;
  texture.image = std::move(image);
  texture.wrap = wrap;
  texture.scale = mapping.scale;
  texture.offset = mapping.offset;
  return texture;
}

// The image of a texture that is a plain one, times a factor.
struct PlainImage {
  const ImageNode* image;
  Rgb factor;
};

std::optional<PlainImage> plain_image(const TextureNode& texture, const ValueRange& range) {
  Rgb factor = Rgb::gray(1);
  const TextureNode* inner = &texture;
  if (const auto* affine = std::get_if<AffineNode>(&texture.node);
      affine != nullptr && is_black(affine->offset)) {
    factor = affine->scale;
    inner = affine->base.get();
  }
  const auto* image = std::get_if<ImageNode>(&inner->node);
  if (image == nullptr) return std::nullopt;
  const Rgb farthest = image->image->largest() * factor;  // from 0, on either side
  const bool has_sign = range.min < 0 || (factor.r >= 0 && factor.g >= 0 && factor.b >= 0);
  return has_sign && clamped(farthest, range) == farthest ? std::optional(PlainImage{image, factor})
                                                          : std::nullopt;
}

}  // namespace

Result<ColorParameter> TextureBaker::color(const TexturePtr& texture, float limit, const Place& place) {
  return converted(texture, {0, limit}, place);
}

Result<ColorParameter> TextureBaker::converted(const TexturePtr& texture, const ValueRange& range,
                                               const Place& place) {
  const std::pair key(texture.get(), range);
  const auto known = converted_.find(key);
  if (known != converted_.end()) return known->second.parameter;
  auto parameter = convert(texture, range, place);
  if (parameter) converted_.emplace(key, Converted{texture, *parameter});
  return parameter;
}

Result<ScalarParameter> TextureBaker::scalar(const TexturePtr& texture, float limit, const Place& place) {
  const auto parameter = color(texture, limit, place);
  if (!parameter) return fail(parameter.error());
  return ScalarParameter(parameter->value.r, parameter->texture);
}

Result<ScalarParameter> TextureBaker::height(const TexturePtr& texture, const Place& place) {
  constexpr float kMaxHeight = 1e30f;
  const auto parameter = converted(texture, {-kMaxHeight, kMaxHeight}, place);
  if (!parameter) return fail(parameter.error());
  return ScalarParameter(parameter->value.r, parameter->texture);
}

Result<ColorParameter> TextureBaker::convert(const TexturePtr& texture, const ValueRange& range,
                                             const Place& place) {
  if (const Rgb* constant = constant_of(texture)) return ColorParameter{clamped(*constant, range), -1};
  if (const auto plain = plain_image(*texture, range)) {
    const auto& [image, factor] = *plain;
    Texture made = placed(image->image, image->wrap, image->mapping);
    made.filter = image->filter;
    return ColorParameter{factor, builder_.add_texture(made)};
  }
  return texture->has_patterns ? procedural(*texture, range.max, place) : bake(texture, range, place);
}

Result<ColorParameter> TextureBaker::procedural(const TextureNode& texture, float max, const Place& place) {
  auto pattern = pattern_of(texture, place);
  if (!pattern) return fail(pattern.error());
  pattern->max = std::min(max, kMaxPatternValue);
  return ColorParameter{Rgb::gray(1), builder_.add_texture({.image = nullptr, .procedural = *pattern})};
}

// An input of a pattern, which may be of any sign. The values of images are not negative.
Result<ColorParameter> TextureBaker::input(const TexturePtr& texture, const Place& place) {
  if (const Rgb* constant = constant_of(texture))
    return ColorParameter{clamped(*constant, kPatternRange), -1};
  const bool is_ramp = std::holds_alternative<BilinearNode>(texture->node);
  if (may_be_negative(*texture) && !is_ramp) return procedural(*texture, kMaxPatternValue, place);
  return color(texture, kMaxPatternValue, place);
}

namespace {

ScalarParameter red_of(const ColorParameter& color) {
  return {color.value.r, color.texture};
}

// Sets the inputs of a pattern; the others have none.
void set_inputs(Pattern& pattern, const ColorParameter& a, const ColorParameter& b) {
  if (auto* board = std::get_if<CheckerboardPattern>(&pattern)) board->even = a, board->odd = b;
  if (auto* dots = std::get_if<DotsPattern>(&pattern)) dots->outside = a, dots->inside = b;
}

}  // namespace

// Nodes of images alone do not come here: they have no patterns among their children.
Result<ProceduralTexture> TextureBaker::pattern_of(const TextureNode& texture, const Place& place) {
  std::vector<ColorParameter> inputs;
  std::optional<Error> error;
  visit_children(texture, [&](const TexturePtr& child) {
    auto made = input(child, place);
    if (made) inputs.push_back(*made);
    if (!made && !error) error = made.error();
  });
  if (error) return fail(*error);
  ProceduralTexture made;
  std::visit(Overloaded{
                 [&](const PatternNode& n) {
                   made = {n.pattern, n.space, n.transform};
                   if (n.a) set_inputs(made.pattern, inputs[0], inputs[1]);
                 },
                 [&](const CheckerNode& n) {
                   made = {CheckerboardPattern{inputs[0], inputs[1]}, PatternSpace::kUv, map_of(n.mapping)};
                 },
                 [&](const BlendNode&) {
                   made.pattern = MixPattern{inputs[0], inputs[1], red_of(inputs[2])};
                 },
                 [&](const ProductNode&) {
                   made.pattern = ProductPattern{inputs[0], inputs[1]};
                 },
                 [&](const AffineNode& n) {
                   assert(is_black(n.offset));
                   made.pattern = ProductPattern{inputs[0], {clamped(n.scale, kPatternRange), -1}};
                 },
                 [&](const PowerNode& n) {
                   made.pattern = PowerPattern{inputs[0], n.exponent};
                 },
                 [&](const ProjectedNode& n) {
                   made = {ProjectedPattern{inputs[0], n.projection}, PatternSpace::kPosition, n.transform};
                 },
                 [](const auto&) { assert(false); },
             },
             texture.node);
  return made;
}

Result<ColorParameter> TextureBaker::bake(const TexturePtr& texture, const ValueRange& range,
                                          const Place& place) {
  Needs needs;
  collect(*texture, needs);
  const Domain domain = domain_of(needs);
  if (!domain.is_exact)
    report_.warn(place, "a texture combines images that repeat differently; their seams are in other places");
  auto image =
      builder_.image_pixels(fmt::format("texture {}", converted_.size() + 1), {domain.width, domain.height},
                            [&] { return evaluated(*texture, domain, range); });
  if (!image) return fail(image.error());
  const UvMapping mapping{{1 / domain.size.x, 1 / domain.size.y},
                          {-domain.origin.x / domain.size.x, -domain.origin.y / domain.size.y}};
  return ColorParameter{Rgb::gray(1), builder_.add_texture(placed(std::move(*image), domain.wrap, mapping))};
}

}  // namespace tessera::core::pbrt
