// SPDX-License-Identifier: Apache-2.0
#include "core/scene/mitsuba/textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/base/printable.hpp"
#include "core/base/suggestion.hpp"
#include "core/scene/mitsuba/grid_volume.hpp"
#include "core/scene/mitsuba/spectra.hpp"

namespace tessera::core::mitsuba {
namespace {

constexpr float kNoTexture = 0.5f;  // what replaces a texture that cannot be had

// Calls map(texel) for each texel, row by row from the top left.
template <typename Map>
TextureImage image_of(const TextureImage& image, const Map& map) {
  std::vector<float> floats;
  floats.reserve(std::size_t{3} * static_cast<std::size_t>(image.width()) *
                 static_cast<std::size_t>(image.height()));
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Rgb texel = map(image.texel(x, y));
      floats.insert(floats.end(), {texel.r, texel.g, texel.b});
    }
  return TextureImage(image.width(), image.height(), std::move(floats));
}

bool is_gray(Rgb c) {
  return c.r == c.g && c.g == c.b;
}
bool is_gray(const TextureImage& image) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x)
      if (!is_gray(image.texel(x, y))) return false;
  return true;
}

// A colour where a number is wanted.
float as_number(Rgb c) {
  return is_gray(c) ? c.r : luminance(c);
}

// Two by two fields, as large as the sharpness of the edges between them needs: lookups interpolate.
TextureImage checkerboard_image(Rgb first, Rgb second) {
  constexpr int kSide = 256;
  std::vector<float> floats;
  floats.reserve(std::size_t{3} * kSide * kSide);
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Rgb color = (x < kSide / 2) == (y < kSide / 2) ? first : second;
      floats.insert(floats.end(), {color.r, color.g, color.b});
    }
  return TextureImage(kSide, kSide, std::move(floats));
}

// A linear map of texture coordinates, and an offset.
struct UvMap {
  Vec2 u_column, v_column, offset;
};

// From a shape's texture coordinates to those of an image whose first row is at v = 1, for a `to_uv` that
// leads to coordinates where it is at v = 0.
UvMap uv_map(const Transform& to_uv, UvLayout layout) {
  // A matrix of 3 x 3 has the offset in its third column.
  const Vec2 offset{to_uv.origin.x + to_uv.z_axis.x, to_uv.origin.y + to_uv.z_axis.y};
  const Vec2 u{to_uv.x_axis.x, -to_uv.x_axis.y}, v{to_uv.y_axis.x, -to_uv.y_axis.y};
  const Vec2 start{offset.x, 1 - offset.y};
  switch (layout) {
    case UvLayout::kSame:
      break;
    case UvLayout::kReversedV:
      return {u, v * -1.0f, start + v};
    case UvLayout::kDisk:
      return {v, u * -1.0f, start + u};
  }
  return {u, v, start};
}

}  // namespace

ColorParameter TextureConverter::color(const Plugin& owner, std::string_view name, Rgb otherwise,
                                       const TextureSite& site, float largest) {
  auto found = value(owner, name, site);
  if (!found) return {otherwise, -1};
  if (found->texture) {
    const Rgb brightest = found->largest.value_or(found->texture->largest());
    const bool exceeds = max_component(brightest * found->factor) > largest;
    if (limit(*found, largest))
      owner.warn(exceeds ? fmt::format("the texture of '{}' is clamped to at most {}", name, largest)
                         : fmt::format("the colours of '{}' between vertices are not exact", name));
    return {found->factor, conversion_.builder.add_texture(*found->texture)};
  }
  const Rgb c = found->factor;
  const auto bounded = [&](float channel) { return std::clamp(channel, 0.0f, largest); };
  const Rgb clamped{bounded(c.r), bounded(c.g), bounded(c.b)};
  if (clamped != c) owner.warn(fmt::format("'{}' is clamped to between 0 and {}", name, largest));
  return {clamped, -1};
}

ScalarParameter TextureConverter::scalar(const Plugin& owner, std::string_view name, float otherwise,
                                         const TextureSite& site, TexelMap map) {
  const auto apply = [&](float number) {
    return map == TexelMap::kSquareRoot ? std::sqrt(std::max(number, 0.0f)) : number;
  };
  auto found = value(owner, name, site);
  if (!found) return apply(otherwise);
  if (!found->texture) return apply(as_number(found->factor));
  // Mitsuba exchanges the fields of checkerboards that are looked up as numbers.
  if (const auto child = owner.child(name); child && child->type() == "checkerboard")
    found->texture->offset.x += 0.5f;
  return {apply(as_number(found->factor)), conversion_.builder.add_texture(mapped(*found->texture, map))};
}

ScalarParameter TextureConverter::opacity(const Plugin& mask, const TextureSite& site) {
  const auto found = value(mask, "opacity", site);
  if (!found) return 0.5f;
  if (!found->is_substitute) return scalar(mask, "opacity", 0.5f, site);
  mask.warn("the texture of 'opacity' is left out; the surface is opaque");
  return 1;
}

int TextureConverter::normal_map(const Plugin& plugin, const TextureSite& site) {
  Value normals = texture(plugin, site);
  if (!normals.texture || normals.texture->procedural) {
    plugin.warn("is no image; the normal map is left out");
    return -1;
  }
  if (normals.factor != Rgb::gray(1)) plugin.warn("its factor has no effect on a normal map");
  Texture& map = *normals.texture;
  map.image = with_signs(map.image, map.scale.x < 0, map.scale.y < 0);
  return conversion_.builder.add_texture(map);
}

BumpMap TextureConverter::bump_map(const Plugin& plugin, const TextureSite& site) {
  Value heights = texture(plugin, site);
  if (!heights.texture) return {};
  return {conversion_.builder.add_texture(mapped(*heights.texture, TexelMap::kLuminance)),
          as_number(heights.factor)};
}

namespace {

// Larger images differ by less than a tenth of a degree, and are kept as they are.
constexpr int kMaxResampledRows = 1024;

// Mitsuba's rows are at equal angles from one pole to the other, where the first and the last one lie; ours
// are in the middle of strips. Several of ours lie between its rows, with their sums; the more there are, the
// less they blur.
int rows_between_poles(const TextureImage& image) {
  constexpr int kMaxRows = 2 * kMaxResampledRows, kMaxBetween = 8;
  return std::min(kMaxRows / (image.height() - 1), kMaxBetween);
}
TextureImage with_rows_between_poles(const TextureImage& image) {
  const int gaps = image.height() - 1, between = rows_between_poles(image);
  std::vector<float> values;
  values.reserve(3 * static_cast<std::size_t>(between * gaps) * static_cast<std::size_t>(image.width()));
  for (int row = 0; row < between * gaps; ++row)
    for (int x = 0; x < image.width(); ++x) {
      const float share = (static_cast<float>(row % between) + 0.5f) / static_cast<float>(between);
      const int above = row / between;
      const Rgb c = image.texel(x, above) * (1 - share) + image.texel(x, above + 1) * share;
      values.insert(values.end(), {c.r, c.g, c.b});
    }
  return TextureImage(image.width(), between * gaps, std::move(values));
}

}  // namespace

std::optional<Texture> TextureConverter::environment_image(const Plugin& emitter) {
  Texture texture;
  texture.image = load(emitter, ColorSpace::kSrgb);
  if (!texture.image) return std::nullopt;
  const TextureImage& image = *texture.image;
  if (image.height() < 2 || image.height() > kMaxResampledRows) return texture;
  const TextureSize size{image.width(), rows_between_poles(image) * (image.height() - 1)};
  auto resampled =
      conversion_.builder.image_pixels("environment", size, [&] { return with_rows_between_poles(image); });
  if (resampled)
    texture.image = std::move(*resampled);
  else
    emitter.warn(resampled.error().message);
  return texture;
}

std::optional<TextureConverter::Value> TextureConverter::value(const Plugin& owner, std::string_view name,
                                                               const TextureSite& site) {
  const Property* property = owner.property(name);
  if (property == nullptr) return std::nullopt;
  if (const auto constant = constant_color(*property)) return Value{*constant, {}};
  if (const auto child = owner.child(name); child && child->kind() == Kind::kTexture)
    return texture(*child, site);
  owner.warn(fmt::format("'{}' is no colour, number or texture; its default is used", name));
  return std::nullopt;
}

TextureConverter::Value TextureConverter::texture(const Plugin& plugin, const TextureSite& site) {
  const std::tuple key(plugin.id(), site.layout, site.attributes);
  if (const auto known = known_.find(key); known != known_.end()) return known->second;
  Value made = convert(plugin, site);
  return known_.emplace(key, std::move(made)).first->second;
}

TextureConverter::Value TextureConverter::convert(const Plugin& plugin, const TextureSite& site) {
  const std::string& type = plugin.type();
  if (type == "bitmap") return bitmap(plugin, site);
  if (type == "checkerboard") return checkerboard(plugin, site);
  if (type == "mesh_attribute") return attribute(plugin, site);
  if (type == "uniform" || type == "srgb" || type == "rgb" || type == "rawconstant") {
    const auto constant = value(plugin, plugin.has("color") ? "color" : "value", site);
    return constant.value_or(Value{});
  }
  if (type == "volume") return volume(plugin, site);
  if (type == "scale") return scaled(plugin, site);
  if (type == "d65") {
    auto constant = value(plugin, "color", site).value_or(Value{});
    constant.factor *= plugin.real("scale", 1);
    return constant;
  }
  if (is_spectrum_type(type)) {
    const auto samples = samples_of(plugin);
    return {samples ? sampled_color(*samples, plugin.in_emitter()) : Rgb::gray(kNoTexture), {}};
  }
  if (const auto inner = plugin.first_child(Kind::kTexture)) {
    plugin.warn("this texture is not supported; the one inside of it replaces it");
    plugin.ignore_all();
    return texture(*inner, site);
  }
  plugin.warn(fmt::format("this texture is not supported; the constant {} replaces it", kNoTexture));
  return {Rgb::gray(kNoTexture), {}, true};
}

// Of Mitsuba 0.x.
TextureConverter::Value TextureConverter::scaled(const Plugin& plugin, const TextureSite& site) {
  const auto inner = plugin.first_child(Kind::kTexture);
  if (!inner) {
    plugin.warn(fmt::format("lacks a texture inside of it; the constant {} replaces it", kNoTexture));
    plugin.ignore_all();
    return {Rgb::gray(kNoTexture), {}, true};
  }
  Value result = texture(*inner, site);
  const Property* factor = plugin.property(plugin.has("value") ? "value" : "scale");
  if (factor == nullptr) return result;
  if (const auto constant = constant_color(*factor))
    result.factor *= *constant;
  else
    plugin.warn("its factor is no number or colour; 1 replaces it");
  return result;
}

TextureConverter::Value TextureConverter::volume(const Plugin& plugin, const TextureSite& site) {
  const auto child = plugin.child("volume");
  if (!child) return value(plugin, "volume", site).value_or(Value{Rgb::gray(1), {}});
  if (child->type() == "constvolume") return value(*child, "value", site).value_or(Value{Rgb::gray(1), {}});
  if (child->type() == "gridvolume") {
    if (const auto grid = this->grid(*child)) return {Rgb::gray(1), grid};
  } else {
    child->warn("is not supported");
    child->ignore_all();
  }
  plugin.warn(fmt::format("the constant {} replaces it", kNoTexture));
  return {Rgb::gray(kNoTexture), {}, true};
}

std::optional<Texture> TextureConverter::grid(const Plugin& plugin) {
  const auto [known, is_new] = grids_.try_emplace(plugin.id());
  if (is_new)
    if (const auto placed = read_grid_volume(conversion_, plugin))
      known->second = grid_texture(conversion_, plugin, *placed);
  return known->second;
}

TextureConverter::Value TextureConverter::bitmap(const Plugin& plugin, const TextureSite& site) {
  Texture result;
  result.wrap = wrap_of(plugin, Wrap::kRepeat);
  const bool raw = plugin.flag("raw", false);
  const std::string filter = plugin.text("filter_type").value_or("bilinear");
  if (filter == "nearest")
    result.filter = TextureFilter::kNearest;
  else if (filter != "bilinear")
    plugin.warn("the filter_type is 'bilinear' instead of the one given");
  plugin.ignore({"format", "accel"});
  result.image = load(plugin, raw ? ColorSpace::kLinear : ColorSpace::kSrgb);
  place(plugin, site.layout, result);
  if (!result.image) return {Rgb::gray(kNoTexture), {}, true};
  return {Rgb::gray(1), std::move(result)};
}

TextureConverter::Value TextureConverter::checkerboard(const Plugin& plugin, const TextureSite& site) {
  const auto field = [&](std::string_view name, float otherwise) {
    const Value color = value(plugin, name, site).value_or(Value{Rgb::gray(otherwise), {}});
    if (!color.texture) return color.factor;
    plugin.warn("the mean replaces a texture inside of a checkerboard");
    return color.factor * color.texture->mean(conversion_.builder.scene().textures);
  };
  const Rgb first = field("color0", 0.4f), second = field("color1", 0.2f);
  Texture result;
  Image& board = boards_[{first.r, first.g, first.b, second.r, second.g, second.b}];
  if (!board) {
    auto counted = conversion_.builder.image_pixels("checkerboard", checkerboard_image(first, second));
    if (!counted) {
      conversion_.check(fail(counted.error()));
      return {first, {}};
    }
    board = *counted;
  }
  result.image = board;
  place(plugin, site.layout, result);
  return {Rgb::gray(1), std::move(result)};
}

TextureConverter::Value TextureConverter::attribute(const Plugin& plugin, const TextureSite& site) {
  const std::string name = plugin.text("name").value_or("");
  const Rgb factor = Rgb::gray(plugin.real("scale", 1));
  if (site.attributes != nullptr) {
    const auto found = site.attributes->find(name);
    if (found != site.attributes->end()) return {factor, found->second.texture, false, found->second.largest};
  }
  plugin.warn(
      fmt::format("the shape has no attribute {}; the constant {} replaces it", in_quotes(name), kNoTexture));
  return {Rgb::gray(kNoTexture), {}, true};
}

void TextureConverter::place(const Plugin& plugin, UvLayout layout, Texture& texture) {
  const UvMap map = uv_map(plugin.transform("to_uv"), layout);
  texture.scale = {map.u_column.x, map.v_column.y};
  texture.shear = {map.v_column.x, map.u_column.y};
  texture.offset = map.offset;
}

TextureConverter::Image TextureConverter::load(const Plugin& plugin, ColorSpace color_space) {
  const std::string written = plugin.text("filename").value_or("");
  if (written.empty()) {
    plugin.warn("lacks a 'filename'; it is left out");
    return nullptr;
  }
  const auto path = conversion_.find_file(written);
  if (!path) {
    plugin.warn(fmt::format("{} does not exist; it is left out", in_quotes(written)));
    return nullptr;
  }
  auto image =
      conversion_.builder.image_file(*path, use_of_channel(color_space, plugin.text("channel").value_or("")));
  if (image) return *image;
  if (image.error().code == ErrorCode::kResourceExhausted)
    conversion_.check(fail(image.error()));
  else
    plugin.warn(image.error().message + "; it is left out");
  return nullptr;
}

template <typename Make>
TextureConverter::Image TextureConverter::derived(const Image& image, const std::string& name,
                                                  const Make& make) {
  auto& [original, made] = derived_[{image.get(), name}];
  if (made) return made;
  original = made = image;
  auto counted = conversion_.builder.image_pixels("derived image", {image->width(), image->height()}, make);
  if (counted)
    made = *counted;
  else
    conversion_.check(fail(counted.error()));
  return made;
}

TextureConverter::Image TextureConverter::mapped(const Image& image, TexelMap map) {
  if (map == TexelMap::kLuminance && is_gray(*image)) return image;
  return derived(image, map == TexelMap::kSquareRoot ? "square root" : "luminance", [&] {
    return image_of(*image, [&](Rgb texel) {
      const float value = as_number(texel);
      return Rgb::gray(map == TexelMap::kSquareRoot ? std::sqrt(value) : value);
    });
  });
}

// Of grids, the layers are mapped to numbers, and the root is that of what is interpolated between them.
Texture TextureConverter::mapped(Texture texture, TexelMap map) {
  if (!texture.procedural) {
    texture.image = mapped(texture.image, map);
    return texture;
  }
  auto& builder = conversion_.builder;
  int& index = std::get<GridPattern>(texture.procedural->pattern).layers.texture;
  Texture layers = builder.scene().textures[static_cast<std::size_t>(index)];
  layers.image = mapped(layers.image, TexelMap::kLuminance);
  index = builder.add_texture(layers);
  if (map != TexelMap::kSquareRoot) return texture;
  ProceduralTexture root{.pattern = PowerPattern{{Rgb::gray(1), builder.add_texture(texture)}, 0.5f}};
  root.max = std::sqrt(texture.procedural->max);
  return {.image = nullptr, .procedural = root};
}

bool TextureConverter::limit(Value& value, float largest) {
  Texture& texture = *value.texture;
  const Rgb factor = value.factor;
  if (!(max_component(texture.largest() * factor) > largest)) return false;
  if (texture.procedural) {
    texture.procedural->max = largest / max_component(factor);
    return true;
  }
  const std::string name = fmt::format("at most {} / ({}, {}, {})", largest, factor.r, factor.g, factor.b);
  texture.image = derived(texture.image, name, [&image = *texture.image, &factor, largest] {
    const auto limited = [largest](float c, float by) { return c * by > largest ? largest / by : c; };
    return image_of(image, [&](Rgb c) {
      return Rgb{limited(c.r, factor.r), limited(c.g, factor.g), limited(c.b, factor.b)};
    });
  });
  return true;
}

TextureConverter::Image TextureConverter::with_signs(const Image& image, bool flip_red, bool flip_green) {
  if (!flip_red && !flip_green) return image;
  return derived(image, fmt::format("flipped {} {}", flip_red, flip_green), [&] {
    return image_of(*image, [&](Rgb texel) {
      const auto flipped = [](float channel) { return std::max(1 - channel, 0.0f); };
      return Rgb{flip_red ? flipped(texel.r) : texel.r, flip_green ? flipped(texel.g) : texel.g, texel.b};
    });
  });
}

}  // namespace tessera::core::mitsuba
