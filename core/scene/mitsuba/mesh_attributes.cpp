// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/mesh_attributes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <utility>

namespace tessera::core::mitsuba {
namespace {

// The channels of an attribute; one channel is a gray.
struct Attribute {
  bool of_triangles = false;
  std::vector<std::pair<std::size_t, const std::vector<float>*>> channels{};  // by their order
  const std::vector<Rgb>* colors = nullptr;                                   // instead of channels

  Rgb value(std::size_t i) const {
    const auto usable = [](float number) { return std::isfinite(number) ? std::max(number, 0.0f) : 0.0f; };
    if (colors != nullptr) return {usable((*colors)[i].r), usable((*colors)[i].g), usable((*colors)[i].b)};
    const auto of = [&](std::size_t c) {
      return usable((*channels[std::min(c, channels.size() - 1)].second)[i]);
    };
    return {of(0), of(1), of(2)};
  }
  std::size_t size() const { return colors != nullptr ? colors->size() : channels.front().second->size(); }
};

using NamedAttributes = std::map<std::string, Attribute, std::less<>>;

// The attribute of Mitsuba's to which a property of a PLY file belongs, and the order among its channels.
struct Channel {
  std::string attribute;
  std::size_t order;
};

// nullopt for properties that are none of an attribute.
std::optional<Channel> channel_of(const MeshAttribute& column) {
  constexpr std::string_view kEnds = "rgbaxyzw0123456789", kColorEnds = "rgba";
  const std::string owner = column.of_triangles ? "face_" : "vertex_";
  for (const std::string_view color : {"red", "green", "blue", "r", "g", "b"})
    if (column.name == color) return Channel{owner + "color", kEnds.find(color.front())};
  const std::size_t cut = column.name.rfind('_');
  if (cut == std::string::npos || cut + 2 != column.name.size()) return std::nullopt;
  const std::size_t order = kEnds.find(column.name.back());
  if (order == std::string_view::npos) return std::nullopt;
  const std::string color = order < kColorEnds.size() ? "_color" : "";
  return Channel{owner + column.name.substr(0, cut) + color, order};
}

// Attributes by Mitsuba's names. Those of a wrong length are left out.
NamedAttributes attributes_of(const ShapeMesh& mesh) {
  NamedAttributes all;
  const std::size_t vertices = mesh.mesh.positions.size(), triangles = mesh.mesh.triangles.size();
  if (mesh.mesh.colors.size() == vertices && vertices > 0) all["vertex_color"].colors = &mesh.mesh.colors;
  for (const MeshAttribute& column : mesh.attributes) {
    const auto channel = channel_of(column);
    if (!channel || column.values.size() != (column.of_triangles ? triangles : vertices)) continue;
    Attribute& attribute = all[channel->attribute];
    if (attribute.colors != nullptr) continue;
    attribute.of_triangles = column.of_triangles;
    attribute.channels.emplace_back(channel->order, &column.values);
  }
  const auto by_order = [](const auto& a, const auto& b) { return a.first < b.first; };
  for (auto& [name, attribute] : all)
    std::stable_sort(attribute.channels.begin(), attribute.channels.end(), by_order);
  return all;
}

Rgb largest_of(const Attribute& attribute) {
  Rgb largest;
  for (std::size_t i = 0; i < attribute.size(); ++i) {
    const Rgb value = attribute.value(i);
    largest = {std::max(largest.r, value.r), std::max(largest.g, value.g), std::max(largest.b, value.b)};
  }
  return largest;
}

// Blocks of two by two texels in rows, as many as there are triangles.
struct Atlas {
  std::size_t columns, rows;

  explicit Atlas(std::size_t triangles) : columns(1), rows(1) {
    while (columns * columns < triangles) ++columns;
    rows = std::max<std::size_t>((triangles + columns - 1) / columns, 1);
  }
  std::size_t width() const { return 2 * columns; }
  std::size_t height() const { return 2 * rows; }
  // The centre of a texel of a triangle's block.
  Vec2 uv(std::size_t triangle, std::size_t x, std::size_t y) const {
    const auto column = static_cast<float>(2 * (triangle % columns) + x) + 0.5f;
    const auto row = static_cast<float>(2 * (triangle / columns) + y) + 0.5f;
    return {column / static_cast<float>(width()), 1 - row / static_cast<float>(height())};
  }
};

// The values at a triangle's corners, in the texels of its block: a bilinear lookup is linear if the fourth
// value is on the plane of the others.
std::array<Rgb, 4> block_of(const Attribute& attribute, const MeshDescription& mesh, std::size_t triangle) {
  if (attribute.of_triangles) {
    const Rgb value = attribute.value(triangle);
    return {value, value, value, value};
  }
  const auto [a, b, c] = mesh.triangles[triangle];
  const Rgb at_a = attribute.value(a), at_b = attribute.value(b), at_c = attribute.value(c);
  const Rgb fourth = at_b + at_c - at_a;
  const auto texel = [](float v) { return std::clamp(v, 0.0f, std::numeric_limits<float>::max()); };
  return {at_a, at_b, at_c, {texel(fourth.r), texel(fourth.g), texel(fourth.b)}};
}

TextureImage atlas_image(const Attribute& attribute, const MeshDescription& mesh, const Atlas& atlas) {
  std::vector<float> floats(atlas.width() * atlas.height() * 3);
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto block = block_of(attribute, mesh, t);
    for (std::size_t i = 0; i < block.size(); ++i) {
      const std::size_t x = 2 * (t % atlas.columns) + i % 2, y = 2 * (t / atlas.columns) + i / 2;
      const std::size_t texel = 3 * (y * atlas.width() + x);
      floats[texel] = block[i].r;
      floats[texel + 1] = block[i].g;
      floats[texel + 2] = block[i].b;
    }
  }
  return TextureImage(static_cast<int>(atlas.width()), static_cast<int>(atlas.height()), std::move(floats));
}

void give_own_vertices(MeshDescription& mesh, const Atlas& atlas) {
  MeshDescription split;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto first = static_cast<std::uint32_t>(split.positions.size());
    for (std::size_t k = 0; k < 3; ++k) {
      const std::uint32_t vertex = mesh.triangles[t][k];
      split.positions.push_back(mesh.positions[vertex]);
      if (!mesh.normals.empty()) split.normals.push_back(mesh.normals[vertex]);
      split.uvs.push_back(atlas.uv(t, k == 1 ? 1 : 0, k == 2 ? 1 : 0));
    }
    split.triangles.push_back({first, first + 1, first + 2});
  }
  mesh = std::move(split);
}

// Null beyond a limit.
Texture texture_of(Conversion& conversion, TextureImage image) {
  Texture texture;
  texture.wrap = Wrap::kClamp;
  auto counted = conversion.builder.image_pixels("mesh attribute", std::move(image));
  if (counted)
    texture.image = *counted;
  else
    conversion.check(fail(counted.error()));
  return texture;
}

}  // namespace

AttributeTextures make_attribute_textures(Conversion& conversion, const Plugin& shape, ShapeMesh& mesh) {
  constexpr std::size_t kMaxTriangles = std::size_t{1} << 26;  // images have at most 2^28 texels
  if (mesh.mesh.triangles.size() > kMaxTriangles || !names_only_vertices(mesh.mesh)) {
    shape.warn("the means replace its attributes, because it has too many or broken triangles");
    return mean_attributes(conversion, mesh);
  }
  AttributeTextures textures;
  const Atlas atlas(mesh.mesh.triangles.size());
  for (const auto& [name, attribute] : attributes_of(mesh)) {
    Texture texture = texture_of(conversion, atlas_image(attribute, mesh.mesh, atlas));
    if (texture.image) textures[name] = {std::move(texture), largest_of(attribute)};
  }
  give_own_vertices(mesh.mesh, atlas);
  return textures;
}

AttributeTextures mean_attributes(Conversion& conversion, const ShapeMesh& mesh) {
  AttributeTextures textures;
  for (const auto& [name, attribute] : attributes_of(mesh)) {
    double r = 0, g = 0, b = 0;
    for (std::size_t i = 0; i < attribute.size(); ++i) {
      const Rgb value = attribute.value(i);
      r += static_cast<double>(value.r), g += static_cast<double>(value.g), b += static_cast<double>(value.b);
    }
    const double count = std::max<double>(static_cast<double>(attribute.size()), 1);
    const std::vector<float> mean{static_cast<float>(r / count), static_cast<float>(g / count),
                                  static_cast<float>(b / count)};
    Texture texture = texture_of(conversion, TextureImage(1, 1, mean));
    if (texture.image) textures[name] = {std::move(texture), largest_of(attribute)};
  }
  return textures;
}

}  // namespace tessera::core::mitsuba
