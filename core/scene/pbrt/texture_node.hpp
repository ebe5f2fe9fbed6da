// SPDX-License-Identifier: Apache-2.0
// Textures as functions of texture coordinates, and of points in space. Those of texture coordinates are
// evaluated when the scene is read: into an image (texture_baker.hpp), unless they are a plain image. Those
// with patterns become procedural textures. Immutable; thread-safe.
#pragma once

#include <functional>
#include <memory>
#include <variant>

#include "core/math/rgb.hpp"
#include "core/math/transform.hpp"
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

// From (u, v, 0) to (s, t, 0). A scale of 0 becomes a small one, so that it has an inverse.
Transform map_of(const UvMapping& mapping);

// The image in a border of black texels, one wide, and its mapping where that of `image` is `mapping`.
TextureImage with_black_border(const TextureImage& image);
UvMapping inside_of_border(const UvMapping& mapping, const TextureImage& image);

struct ConstantNode {
  Rgb value;
};

struct ImageNode {
  std::shared_ptr<const TextureImage> image;
  Wrap wrap = Wrap::kRepeat;
  UvMapping mapping{};
  TextureFilter filter = TextureFilter::kLinear;
};

// base * scale + offset.
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

// function(c) for each channel c. Patterns cannot be a part of `base`.
struct ChannelNode {
  TexturePtr base;
  std::function<float(float)> function;
};

// The mean of the channels, in all of them.
struct MeanNode {
  TexturePtr base;
};

// A pattern that is computed where a surface is hit. Its inputs are `a` and `b`, or null: those of a
// checkerboard in space, or the outside and the inside of dots.
struct PatternNode {
  Pattern pattern;
  PatternSpace space = PatternSpace::kPosition;
  Transform transform{};  // from that space to the pattern's
  TexturePtr a{}, b{};
};

// `base` by other texture coordinates.
struct ProjectedNode {
  TexturePtr base;
  Projection projection = Projection::kPlanar;
  Transform transform{};  // from the world to the space of the projection
};

struct TextureNode {
  std::variant<ConstantNode, ImageNode, AffineNode, ProductNode, BlendNode, CheckerNode, BilinearNode,
               PowerNode, ChannelNode, MeanNode, PatternNode, ProjectedNode>
      node;
  int weight = 1;             // the number of nodes that an evaluation visits
  bool has_patterns = false;  // in itself or its children
  bool is_unknown = false;    // it, or one of its children, cannot be read
};

TexturePtr constant_texture(Rgb value);
TexturePtr unknown_texture();  // gray
// Adds up the weights, and evaluates nodes of constants at once. nullptr beyond kMaxTextureWeight, so that
// evaluations are cheap and not deeply recursive.
TexturePtr make_texture(const decltype(TextureNode::node)& node);

// The value of a constant; nullptr for other textures.
const Rgb* constant_of(const TexturePtr& texture);

// Whether a constant or a factor in it is negative, and it is not raised to 0 or more after that.
bool may_be_negative(const TextureNode& texture);

// Bilinear in images, of any sign. The texture must have no patterns.
Rgb evaluate(const TextureNode& texture, Vec2 uv);

// Calls visit(child) for each texture that `texture` refers to.
template <typename Visit>
void visit_children(const TextureNode& texture, const Visit& visit) {
  std::visit(
      [&](const auto& n) {
        if constexpr (requires { n.base; }) visit(n.base);
        if constexpr (requires { n.a; })
          for (const TexturePtr& child : {n.a, n.b})
            if (child) visit(child);
        if constexpr (requires { n.amount; }) visit(n.amount);
      },
      texture.node);
}

}  // namespace tessera::core::pbrt
