// SPDX-License-Identifier: Apache-2.0
// Textures as functions of texture coordinates. They are evaluated when the scene is read: into an image
// (texture_baker.hpp), unless they are a plain image. Immutable; thread-safe.
#pragma once

#include <memory>
#include <variant>

#include "core/math/rgb.hpp"
#include "core/math/vec3.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core::pbrt {

struct TextureNode;
using TexturePtr = std::shared_ptr<const TextureNode>;

// (s, t) = uv * scale + offset.
struct UvMapping {
  Vec2 scale{1, 1}, offset{0, 0};

  Vec2 operator()(Vec2 uv) const { return {uv.x * scale.x + offset.x, uv.y * scale.y + offset.y}; }
  bool operator==(const UvMapping&) const = default;
};

struct ConstantNode {
  Rgb value;
};

struct ImageNode {
  std::shared_ptr<const TextureImage> image;
  Wrap wrap = Wrap::kRepeat;
  UvMapping mapping{};
  bool black_outside = false;  // outside of the unit square, instead of `wrap`
  TextureFilter filter = TextureFilter::kLinear;
};

// base * scale + offset, at least 0.
struct AffineNode {
  TexturePtr base;
  Rgb scale = Rgb::gray(1), offset{};
};

struct ProductNode {
  TexturePtr a, b;
};

// a where `amount` is 0, b where it is 1.
struct BlendNode {
  TexturePtr a, b, amount;
};

// Squares of size 1 in (s, t), a at the origin.
struct CheckerNode {
  TexturePtr a, b;
  UvMapping mapping{};
};

// Bilinear in (s, t) between the values at the corners of the unit square; `v01` is at (0, 1).
struct BilinearNode {
  Rgb v00, v01, v10, v11;
  UvMapping mapping{};
};

// base ^ exponent in each channel.
struct PowerNode {
  TexturePtr base;
  float exponent = 1;
};

// The mean of the channels, in all of them.
struct MeanNode {
  TexturePtr base;
};

struct TextureNode {
  std::variant<ConstantNode, ImageNode, AffineNode, ProductNode, BlendNode, CheckerNode, BilinearNode,
               PowerNode, MeanNode>
      node;
  int weight = 1;  // the number of nodes that an evaluation visits
};

// Textures that refer to more others are refused, so that evaluations are cheap and not deeply recursive.
inline constexpr int kMaxTextureWeight = 500;

TexturePtr constant_texture(Rgb value);
// Adds up the weights, and evaluates nodes of constants at once. nullptr beyond kMaxTextureWeight.
TexturePtr make_texture(const decltype(TextureNode::node)& node);

// The value of a constant; nullptr for other textures.
const Rgb* constant_of(const TexturePtr& texture);

// Bilinear in images.
Rgb evaluate(const TextureNode& texture, Vec2 uv);

// Calls visit(child) for each texture that `texture` refers to.
template <typename Visit>
void visit_children(const TextureNode& texture, const Visit& visit) {
  std::visit(
      [&](const auto& n) {
        if constexpr (requires { n.base; }) visit(n.base);
        if constexpr (requires { n.a; }) visit(n.a), visit(n.b);
        if constexpr (requires { n.amount; }) visit(n.amount);
      },
      texture.node);
}

}  // namespace tessera::core::pbrt
