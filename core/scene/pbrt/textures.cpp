// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/textures.hpp"

#include <fmt/format.h>

#include <algorithm>

#include "core/base/letter_case.hpp"
#include "core/image/srgb.hpp"
#include "core/math/frame.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/scene/pbrt/files.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr float kMaxTiling = 1e6f;

bool is_color_type(std::string_view type) {
  return type == "rgb" || type == "color" || type == "xyz" || type == "spectrum" || type == "blackbody";
}

// How the bytes of an image file become linear values. Only PNG files obey the parameter "encoding".
struct Encoding {
  ColorSpace color_space = ColorSpace::kSrgb;
  float gamma = 1;  // the exponent that makes values linear, after color_space
};

Encoding encoding_of(const Parameters& p, std::string_view file) {
  const std::string name = p.text("encoding", "sRGB");
  if (!ends_with_ignoring_case(file, ".png")) return {};
  if (name == "linear") return {ColorSpace::kLinear, 1};
  constexpr std::string_view kGamma = "gamma ";
  if (!std::string_view(name).starts_with(kGamma)) {
    p.choice("encoding", "sRGB", {"sRGB", "linear"});
    return {};
  }
  constexpr float kDefaultGamma = 2.2f, kMinGamma = 0.1f, kMaxGamma = 10;
  const auto gamma = parse_number(std::string_view(name).substr(kGamma.size()));
  if (gamma && *gamma >= kMinGamma && *gamma <= kMaxGamma) return {ColorSpace::kLinear, *gamma};
  p.remark("encoding",
           fmt::format("has no gamma from {} to {}; {} is used", kMinGamma, kMaxGamma, kDefaultGamma));
  return {ColorSpace::kLinear, kDefaultGamma};
}

// As scene files give transforms.
Transform without_negative_zeros(const Transform& t) {
  constexpr Vec3 kZero{};
  return {t.x_axis + kZero, t.y_axis + kZero, t.z_axis + kZero, t.origin + kZero};
}

std::string mapping_of(const Parameters& p) {
  return p.choice("mapping", "uv", {"uv", "planar", "spherical", "cylindrical"});
}

std::string name_in(const Parameter& parameter) {
  return parameter.strings.empty() ? "" : parameter.strings.front();
}

int dimension_of(const Parameters& p) {
  const int dimension = p.integer("dimension", 2);
  if (dimension == 2 || dimension == 3) return dimension;
  p.remark("dimension", "range", fmt::format("must be 2 or 3, got {}; 2 is used", dimension));
  return 2;
}

Transform turned_to_z(Vec3 direction) {
  const Frame frame = Frame::around(direction);
  const auto column = [&](int axis) {
    return Vec3{frame.tangent[axis], frame.bitangent[axis], frame.normal[axis]};
  };
  return {column(0), column(1), column(2), {}};
}

bool is_gray(const TextureImage& image) {
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Rgb c = image.texel(x, y);
      if (c.r != c.g || c.g != c.b) return false;
    }
  return true;
}

float at_least_0(float value) {
  return std::max(value, 0.0f);
}

bool has_float_ending(std::string_view file) {
  return ends_with_ignoring_case(file, ".exr") || ends_with_ignoring_case(file, ".pfm") ||
         ends_with_ignoring_case(file, ".hdr");
}

// pbrt decodes alpha as it does colours.
TexturePtr decoded_alpha(const ImageNode& alpha, const Encoding& encoding, bool has_codes) {
  const TexturePtr linear = make_texture(alpha);
  if (encoding.gamma != 1) return make_texture(PowerNode{linear, encoding.gamma});
  if (encoding.color_space == ColorSpace::kLinear || !has_codes) return linear;
  return make_texture(ChannelNode{linear, [](float code) { return srgb_decode(static_cast<double>(code)); }});
}

bool is_one_texel(const TextureImage& image) {
  return image.width() == 1 && image.height() == 1;
}

}  // namespace

Status Textures::define(const std::string& name, const std::string& type, const std::string& kind,
                        const Parameters& p, const Matrix& to_world) {
  const bool is_number = type == "float";
  if (!is_number && type != "spectrum" && type != "color")
    return report_.error(p.place(), fmt::format("the type of a texture is \"float\" or \"spectrum\", got {}",
                                                in_quotes(type)));
  auto texture = make(kind, p, is_number ? Kind::kNumber : Kind::kColor, to_world);
  if (!texture) return fail(texture.error());
  if (*texture == nullptr)
    return report_.error(p.place(), fmt::format("the texture {} refers to too many others", in_quotes(name)));
  report_.tell(p, fmt::format("the texture '{}'", kind));
  auto& textures = is_number ? numbers_ : spectra_;
  if (!textures.insert_or_assign(name, *texture).second)
    report_.warn(
        p.place(), "another texture " + name,
        fmt::format("the texture {} exists already; this one replaces it from here on", in_quotes(name)));
  return {};
}

Result<TexturePtr> Textures::make(const std::string& kind, const Parameters& p, Kind type,
                                  const Matrix& to_world) {
  if (kind == "constant") return constant_texture(value(p, "value", 1, type));
  if (auto flat = make_flat(kind, p, type); !flat || *flat)
    return flat ? projected(*flat, p, to_world) : flat;
  if (kind == "scale") {
    // Version 3 called the factors tex1 and tex2.
    const bool is_old = !p.has("tex") && p.has("tex1");
    const TexturePtr base = input(p, is_old ? "tex1" : "tex", 1, type);
    const TexturePtr factor = is_old ? input(p, "tex2", 1, type) : number(p, "scale", 1);
    const Rgb* constant = constant_of(factor);
    return constant != nullptr ? make_texture(AffineNode{base, *constant, {}})
                               : make_texture(ProductNode{base, factor});
  }
  if (kind == "directionmix") return make_direction_mix(p, type, to_world);
  if (kind == "mix")
    return make_texture(
        BlendNode{input(p, "tex1", 0, type), input(p, "tex2", 1, type), number(p, "amount", 0.5f)});
  if (const auto pattern = make_pattern(kind, p, type, to_world)) return pattern;
  return make_unknown(kind, p);
}

Result<TexturePtr> Textures::make_flat(const std::string& kind, const Parameters& p, Kind type) {
  if (kind == "imagemap") return make_image(p, type);
  if (kind == "bilerp")
    return make_texture(BilinearNode{value(p, "v00", 0, type), value(p, "v01", 1, type),
                                     value(p, "v10", 0, type), value(p, "v11", 1, type), mapping(p)});
  if (kind == "checkerboard" && dimension_of(p) == 2)
    return make_texture(CheckerNode{input(p, "tex1", 1, type), input(p, "tex2", 0, type), mapping(p)});
  if (kind == "dots")
    return make_texture(PatternNode{DotsPattern(), PatternSpace::kUv, map_of(mapping(p)),
                                    input(p, "outside", 0, type), input(p, "inside", 1, type)});
  return TexturePtr();
}

// The interpreter refuses transformations that flatten space.
TexturePtr Textures::projected(const TexturePtr& flat, const Parameters& p, const Matrix& to_world) {
  const std::string kind = mapping_of(p);
  if (kind == "uv" || flat == nullptr || constant_of(flat) != nullptr) return flat;
  Matrix from_world = inverse(to_world).value_or(Matrix());
  ProjectedNode node{flat, kind == "spherical" ? Projection::kSpherical : Projection::kCylindrical};
  if (kind == "planar") {
    const Vec3 u = p.vector("v1", {1, 0, 0}), v = p.vector("v2", {0, 1, 0});
    const auto row = [](Vec3 along, float offset) {
      return std::array{static_cast<double>(along.x), static_cast<double>(along.y),
                        static_cast<double>(along.z), static_cast<double>(offset)};
    };
    const auto offset = [&](std::string_view name) { return p.number_in(name, 0, -kMaxTiling, kMaxTiling); };
    const Matrix plane{{row(u, offset("udelta")), row(v, offset("vdelta")), row(cross(u, v), 0)}};
    if (!inverse(plane)) {
      report_.warn(p.place(),
                   "a planar mapping without a plane is not supported; texture coordinates are used");
      return flat;
    }
    node.projection = Projection::kPlanar;
    from_world = plane * from_world;
  }
  node.transform = without_negative_zeros(from_world.transform());
  return make_texture(node);
}

TexturePtr Textures::make_pattern(const std::string& kind, const Parameters& p, Kind type,
                                  const Matrix& to_world) {
  constexpr float kMaxFactor = 1e4f, kMaxOctaveHeight = 10;
  PatternNode node;
  const auto read_octaves = [&](auto& noise) {
    noise.octaves = std::clamp(p.integer("octaves", 8), 1, kMaxNoiseOctaves);
    noise.roughness = p.number_in("roughness", 0.5f, 0, kMaxOctaveHeight);
  };
  const auto with_noise = [&](auto noise) {
    read_octaves(noise);
    return noise;
  };
  if (kind == "fbm") {
    node.pattern = with_noise(FbmPattern());
  } else if (kind == "wrinkled") {
    node.pattern = with_noise(WrinkledPattern());
  } else if (kind == "windy") {
    node.pattern = WindyPattern();
  } else if (kind == "marble") {
    auto marble = with_noise(MarblePattern());
    marble.scale = p.number_in("scale", 1, -kMaxFactor, kMaxFactor);
    marble.variation = p.number_in("variation", 0.2f, -kMaxFactor, kMaxFactor);
    node.pattern = marble;
  } else if (kind == "checkerboard") {
    node.pattern = CheckerboardPattern();
    node.a = input(p, "tex1", 1, type);
    node.b = input(p, "tex2", 0, type);
  } else {
    return nullptr;
  }
  // The interpreter refuses transformations that flatten space.
  node.transform = without_negative_zeros(inverse(to_world).value_or(Matrix()).transform());
  return make_texture(node);
}

// The share of tex1 is the absolute value of the cosine between the geometric normal and the direction (Pharr
// et al. 2023, section 10.5).
TexturePtr Textures::make_direction_mix(const Parameters& p, Kind type, const Matrix& to_world) {
  const TexturePtr along = input(p, "tex1", 0, type), across = input(p, "tex2", 1, type);
  const Vec3 direction = normalize(to_world.direction(p.vector("dir", {0, 1, 0})));
  PatternNode facing{FacingPattern(), PatternSpace::kNormal};
  if (is_finite(direction))
    facing.transform = without_negative_zeros(turned_to_z(direction));
  else
    p.remark("dir", "has no length; the z axis is used");
  return make_texture(BlendNode{across, along, make_texture(facing)});
}

TexturePtr Textures::make_unknown(const std::string& kind, const Parameters& p) {
  const std::string text = fmt::format("the texture {} is not supported; gray is used", in_quotes(kind));
  report_.warn(p.place(), text, text);
  return unknown_;
}

// Negative values of numbers remain, as in pbrt.
Result<TexturePtr> Textures::make_image(const Parameters& p, Kind type) {
  // Only the filter of pbrt's own lookups, which does not change the mean.
  p.find("maxanisotropy"), p.find("trilinear");
  auto base = image(p, p.file_name("filename"), type == Kind::kNumber);
  if (!base || constant_of(*base) != nullptr) return base;
  const float factor = p.number("scale", 1);
  if (p.boolean("invert", false))
    return make_texture(
        ChannelNode{make_texture(AffineNode{*base, Rgb::gray(-factor), Rgb::gray(1)}), at_least_0});
  if (factor == 1) return base;
  const TexturePtr scaled = make_texture(AffineNode{*base, Rgb::gray(factor), {}});
  return factor < 0 && type == Kind::kColor ? make_texture(ChannelNode{scaled, at_least_0}) : scaled;
}

Result<TexturePtr> Textures::image(const Parameters& p, const std::string& file, bool is_number,
                                   const std::string& default_wrap) {
  const Place place = p.place_of(p.find("filename"));
  if (file.empty()) {
    report_.warn(place, "the texture 'imagemap' has no file name; gray is used");
    return unknown_;
  }
  const auto path = find_file(builder_, place, file);
  if (!path) {
    report_.warn(place, "missing image " + file,
                 fmt::format("the image {} does not exist; gray is used", in_quotes(file)));
    return unknown_;
  }
  const Encoding encoding = encoding_of(p, file);
  ImageNode node;
  node.mapping = mapping(p);
  const std::string wrap = p.choice("wrap", default_wrap, {"repeat", "clamp", "black"});
  node.wrap = wrap == "repeat" ? Wrap::kRepeat : Wrap::kClamp;
  if (p.choice("filter", "bilinear", {"point", "bilinear", "trilinear", "EWA", "ewa"}) == "point")
    node.filter = TextureFilter::kNearest;
  const std::string channel = p.text("channel");
  if (is_number && channel.empty()) {
    auto alpha = builder_.image_file(*path, {ColorSpace::kLinear, TextureChannel::kAlpha});
    if (alpha && !is_one_texel(**alpha)) {
      node.image = *alpha;
      if (wrap == "black")
        if (auto done = surround_with_black(file, node); !done) return fail(done.error());
      return decoded_alpha(node, encoding, !has_float_ending(file));
    }
  }
  auto decoded = builder_.image_file(*path, use_of_channel(encoding.color_space, channel));
  if (!decoded) {
    if (decoded.error().code == ErrorCode::kResourceExhausted) return fail(decoded.error());
    report_.warn(place, "image " + file, decoded.error().message + "; gray is used");
    return unknown_;
  }
  node.image = *decoded;
  if (wrap == "black")
    if (auto done = surround_with_black(file, node); !done) return fail(done.error());
  TexturePtr texture = make_texture(node);
  if (encoding.gamma != 1) texture = make_texture(PowerNode{texture, encoding.gamma});
  return is_number && !is_gray(*node.image) ? make_texture(MeanNode{texture}) : texture;
}

// pbrt blends the outer texels with black ones, too.
Status Textures::surround_with_black(const std::string& file, ImageNode& node) {
  const SceneBuilder::Image inner = node.image;
  auto image = builder_.image_pixels(file, {inner->width() + 2, inner->height() + 2},
                                     [&] { return with_black_border(*inner); });
  if (!image) return fail(image.error());
  node.image = *image;
  node.mapping = inside_of_border(node.mapping, *inner);
  return {};
}

// Only the mapping "uv" has it.
UvMapping Textures::mapping(const Parameters& p) {
  if (mapping_of(p) != "uv") return {};
  const auto finite = [&](std::string_view name, float otherwise) {
    return p.number_in(name, otherwise, -kMaxTiling, kMaxTiling);
  };
  return {{finite("uscale", 1), finite("vscale", 1)}, {finite("udelta", 0), finite("vdelta", 0)}};
}

TexturePtr Textures::input(const Parameters& p, std::string_view name, float otherwise, Kind type) {
  return type == Kind::kNumber ? number(p, name, otherwise)
                               : color(p, name, SpectrumRole::kUnbounded, Rgb::gray(otherwise));
}

Rgb Textures::value(const Parameters& p, std::string_view name, float otherwise, Kind type) {
  if (type == Kind::kNumber) return Rgb::gray(p.number(name, otherwise));
  return colors_.color(p, name, SpectrumRole::kUnbounded, Rgb::gray(otherwise));
}

TexturePtr Textures::color(const Parameters& p, std::string_view name, SpectrumRole role, Rgb otherwise) {
  TexturePtr given = color(p, name, role);
  return given ? given : constant_texture(otherwise);
}

TexturePtr Textures::color(const Parameters& p, std::string_view name, SpectrumRole role) {
  const Parameter* parameter = p.find(name);
  if (parameter == nullptr) return nullptr;
  if (parameter->type == "texture") return named(p, *parameter, Kind::kColor);
  return constant_texture(colors_.color(p, *parameter, role));
}

TexturePtr Textures::number(const Parameters& p, std::string_view name, float otherwise) {
  TexturePtr given = number(p, name);
  return given ? given : constant_texture(Rgb::gray(otherwise));
}

TexturePtr Textures::number(const Parameters& p, std::string_view name) {
  const Parameter* parameter = p.find(name);
  if (parameter == nullptr) return nullptr;
  if (parameter->type == "texture") return named(p, *parameter, Kind::kNumber);
  if (is_color_type(parameter->type)) {
    p.remark(name, "is a colour, and a number is expected; its mean is used");
    return constant_texture(Rgb::gray(mean(colors_.color(p, *parameter, SpectrumRole::kUnbounded))));
  }
  const auto value = p.number(name);
  return value ? constant_texture(Rgb::gray(*value)) : nullptr;
}

// Names of the other type are found, too.
TexturePtr Textures::named(const Parameters& p, const Parameter& parameter, Kind type) {
  if (const TexturePtr found = find(parameter, type)) return found;
  const std::string name = name_in(parameter);
  report_.warn(p.place_of(&parameter), "texture " + name,
               fmt::format("there is no texture {}; gray is used", in_quotes(name)));
  return unknown_;
}

TexturePtr Textures::find(const Parameter& parameter, Kind type) const {
  for (const auto* textures :
       {type == Kind::kColor ? &spectra_ : &numbers_, type == Kind::kColor ? &numbers_ : &spectra_})
    if (const auto found = textures->find(name_in(parameter)); found != textures->end()) return found->second;
  return nullptr;
}

// Gray would make the surface half transparent.
TexturePtr Textures::alpha(const Parameters& p) {
  const Parameter* given = p.find("alpha");
  if (given == nullptr || given->type != "texture") return number(p, "alpha");
  const TexturePtr found = find(*given, Kind::kNumber);
  if (found && !found->is_unknown) return found;
  const std::string name = name_in(*given);
  report_.warn(p.place_of(given), "alpha " + name,
               found ? fmt::format("the texture {}, or a part of it, cannot be read; the surface is opaque",
                                   in_quotes(name))
                     : fmt::format("there is no texture {}; the surface is opaque", in_quotes(name)));
  return nullptr;
}

}  // namespace tessera::core::pbrt
