// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/texture_node.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/overloaded.hpp"
#include "core/math/elementary.hpp"

namespace tessera::core::pbrt {
namespace {

Rgb lerp(Rgb a, Rgb b, Rgb t) {
  return a * (Rgb::gray(1) - t) + b * t;
}

float power(float base, float exponent) {
  return static_cast<float>(pow(static_cast<double>(std::max(base, 0.0f)), static_cast<double>(exponent)));
}

Rgb image_at(const ImageNode& n, Vec2 st) {
  if (n.filter == TextureFilter::kLinear) return n.image->bilinear(st, n.wrap, n.wrap);
  return Texture{.image = n.image, .wrap = n.wrap, .filter = n.filter}.evaluate(st);
}

// Whether the square at (s, t) is one of the second texture.
bool is_second(Vec2 st) {
  const float sum = std::floor(st.x) + std::floor(st.y);
  return sum - 2 * std::floor(sum / 2) >= 1;
}

Rgb bilinear_at(const BilinearNode& n, Vec2 st) {
  const Rgb s = Rgb::gray(st.x), t = Rgb::gray(st.y);
  return lerp(lerp(n.v00, n.v10, s), lerp(n.v01, n.v11, s), t);
}

bool is_negative(Rgb c) {
  return c.r < 0 || c.g < 0 || c.b < 0;
}

float not_0(float scale) {
  constexpr float kFlat = 1e-6f;
  return scale == 0 ? kFlat : scale;
}

}  // namespace

Transform map_of(const UvMapping& mapping) {
  return {{not_0(mapping.scale.x), 0, 0},
          {0, not_0(mapping.scale.y), 0},
          {0, 0, 1},
          {mapping.offset.x, mapping.offset.y, 0}};
}

TextureImage with_black_border(const TextureImage& image) {
  const int width = image.width() + 2, height = image.height() + 2;
  std::vector<float> values(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) * 3);
  for (int y = 1; y + 1 < height; ++y)
    for (int x = 1; x + 1 < width; ++x) {
      const Rgb c = image.texel(x - 1, y - 1);
      const std::size_t first =
          3 * (static_cast<std::size_t>(y) * static_cast<std::size_t>(width) + static_cast<std::size_t>(x));
      values[first] = c.r, values[first + 1] = c.g, values[first + 2] = c.b;
    }
  return TextureImage(width, height, std::move(values));
}

UvMapping inside_of_border(const UvMapping& mapping, const TextureImage& image) {
  const auto width = static_cast<float>(image.width()), height = static_cast<float>(image.height());
  return {{mapping.scale.x * width / (width + 2), mapping.scale.y * height / (height + 2)},
          {(mapping.offset.x * width + 1) / (width + 2), (mapping.offset.y * height + 1) / (height + 2)}};
}

TexturePtr constant_texture(Rgb value) {
  return std::make_shared<const TextureNode>(TextureNode{ConstantNode{value}, 1});
}

TexturePtr unknown_texture() {
  TextureNode gray{ConstantNode{Rgb::gray(0.5f)}};
  gray.is_unknown = true;
  return std::make_shared<const TextureNode>(std::move(gray));
}

TexturePtr make_texture(const decltype(TextureNode::node)& node) {
  TextureNode made{node, 1};
  made.has_patterns =
      std::holds_alternative<PatternNode>(node) || std::holds_alternative<ProjectedNode>(node);
  bool is_constant = !made.has_patterns && !std::holds_alternative<ImageNode>(node) &&
                     !std::holds_alternative<BilinearNode>(node);
  visit_children(made, [&](const TexturePtr& child) {
    made.weight += child->weight;
    made.has_patterns |= child->has_patterns;
    made.is_unknown |= child->is_unknown;
    is_constant &= constant_of(child) != nullptr;
  });
  if (const auto* checker = std::get_if<CheckerNode>(&node))
    is_constant &= evaluate(*checker->a, {}) == evaluate(*checker->b, {});
  if (made.weight > kMaxTextureWeight) return nullptr;
  if (is_constant) {
    made.node = ConstantNode{evaluate(made, {})};
    made.weight = 1;
  }
  return std::make_shared<const TextureNode>(std::move(made));
}

const Rgb* constant_of(const TexturePtr& texture) {
  const auto* constant = std::get_if<ConstantNode>(&texture->node);
  return constant == nullptr ? nullptr : &constant->value;
}

bool may_be_negative(const TextureNode& texture) {
  if (std::holds_alternative<ChannelNode>(texture.node) || std::holds_alternative<PowerNode>(texture.node))
    return false;
  bool found = std::visit(
      Overloaded{
          [](const ConstantNode& n) { return is_negative(n.value); },
          [](const AffineNode& n) { return is_negative(n.scale) || is_negative(n.offset); },
          [](const BilinearNode& n) {
            return is_negative(n.v00) || is_negative(n.v01) || is_negative(n.v10) || is_negative(n.v11);
          },
          [](const auto&) { return false; },
      },
      texture.node);
  visit_children(texture, [&](const TexturePtr& child) { found |= may_be_negative(*child); });
  return found;
}

Rgb evaluate(const TextureNode& texture, Vec2 uv) {
  return std::visit(
      Overloaded{
          [&](const ConstantNode& n) { return n.value; },
          [&](const ImageNode& n) { return image_at(n, n.mapping(uv)); },
          [&](const AffineNode& n) { return evaluate(*n.base, uv) * n.scale + n.offset; },
          [&](const ProductNode& n) { return evaluate(*n.a, uv) * evaluate(*n.b, uv); },
          [&](const BlendNode& n) {
            return lerp(evaluate(*n.a, uv), evaluate(*n.b, uv), evaluate(*n.amount, uv));
          },
          [&](const CheckerNode& n) { return evaluate(is_second(n.mapping(uv)) ? *n.b : *n.a, uv); },
          [&](const BilinearNode& n) { return bilinear_at(n, n.mapping(uv)); },
          [&](const PowerNode& n) {
            const Rgb c = evaluate(*n.base, uv);
            return Rgb{power(c.r, n.exponent), power(c.g, n.exponent), power(c.b, n.exponent)};
          },
          [&](const ChannelNode& n) {
            const Rgb c = evaluate(*n.base, uv);
            return Rgb{n.function(c.r), n.function(c.g), n.function(c.b)};
          },
          [&](const MeanNode& n) { return Rgb::gray(mean(evaluate(*n.base, uv))); },
          [](const PatternNode&) { return Rgb{}; },
          [](const ProjectedNode&) { return Rgb{}; },
      },
      texture.node);
}

}  // namespace tessera::core::pbrt
