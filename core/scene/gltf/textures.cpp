// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/math/elementary.hpp"
#include "core/scene/gltf/uri.hpp"
#include "core/scene/loader/wording.hpp"

namespace tessera::core::gltf {
namespace {

Wrap wrap_of(const Value& sampler, std::string_view key, const Document& document) {
  constexpr std::uint64_t kClampToEdge = 33071, kMirroredRepeat = 33648, kRepeat = 10497;
  std::uint64_t wrap = kRepeat;
  document.try_to(sampler[key], "wrap", "the texture repeats", [&] {
    wrap = sampler.whole_or(key, kRepeat);
    if (wrap != kClampToEdge && wrap != kMirroredRepeat && wrap != kRepeat)
      sampler[key].refuse(fmt::format("{} is no way to wrap", wrap));
  });
  if (wrap == kClampToEdge) return Wrap::kClamp;
  return wrap == kMirroredRepeat ? Wrap::kMirror : Wrap::kRepeat;
}

// KHR_texture_transform scales, then rotates counter-clockwise as seen with v downwards, then moves. Here v
// points upwards: v' = 1 - v.
void apply_transform(const Value& transform, Texture& texture, const Document& document) {
  const auto scale = transform.numbers("scale", 2), offset = transform.numbers("offset", 2);
  const Vec2 s = scale.empty() ? Vec2{1, 1} : Vec2{scale[0], scale[1]};
  const Vec2 t = offset.empty() ? Vec2{0, 0} : Vec2{offset[0], offset[1]};
  constexpr float kMaxAngle = 1e4f;
  float angle = transform.number_or("rotation", 0);
  if (!(angle >= -kMaxAngle && angle <= kMaxAngle)) {
    document.warn(transform["rotation"], "rotation", "is too large; it is ignored");
    angle = 0;
  }
  const float c = angle == 0 ? 1 : core::cos(angle), d = angle == 0 ? 0 : core::sin(angle);
  // (u, v) -> (uu u + uv v, vu u + vv v) + t with v downwards.
  const float uu = c * s.x, uv = d * s.y, vu = -d * s.x, vv = c * s.y;
  texture.scale = {uu, vv};
  texture.shear = {0 - uv, 0 - vu};
  texture.offset = {uv + t.x, 1 - vv - t.y};
}

// An image of the converted values in 8 bits.
TextureImage apply_curve(const TextureImage& source, const Textures::Curve& curve) {
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * static_cast<std::size_t>(source.width()) * static_cast<std::size_t>(source.height()));
  for (int y = 0; y < source.height(); ++y)
    for (int x = 0; x < source.width(); ++x) {
      const float value = std::clamp(curve(source.texel(x, y).r), 0.0f, 1.0f);
      bytes.insert(bytes.end(), 3, static_cast<std::uint8_t>(value * 255 + 0.5f));
    }
  return {source.width(), source.height(), bytes, ColorSpace::kLinear};
}

}  // namespace

std::uint32_t Textures::set_of(const Value& info) const {
  const Value transformed = info.extension("KHR_texture_transform")["texCoord"];
  std::uint64_t set = 0;
  document_.try_to(info, "texCoord", "TEXCOORD_0 is used", [&] {
    const std::uint64_t named = transformed.exists() ? transformed.whole() : info.whole_or("texCoord", 0);
    constexpr std::uint64_t kMaxSet = 1000;
    if (named > kMaxSet) info.refuse(fmt::format("there is no TEXCOORD_{}", named));
    set = named;
  });
  return static_cast<std::uint32_t>(set);
}

void Textures::begin_material(const Value& base_texture) {
  coordinates_ = {};
  if (base_texture["index"].exists()) coordinates_.sets.push_back(set_of(base_texture));
}

UvSet Textures::uv_set(const Value& info) {
  constexpr std::size_t kMaxSets = 2;
  std::vector<std::uint32_t>& sets = coordinates_.sets;
  const std::uint32_t set = set_of(info);
  const auto known = std::find(sets.begin(), sets.end(), set);
  if (known != sets.end()) return known == sets.begin() ? UvSet::kFirst : UvSet::kSecond;
  if (sets.size() == kMaxSets) {
    coordinates_.others.push_back(info);
    return UvSet::kFirst;
  }
  sets.push_back(set);
  return sets.size() == 1 ? UvSet::kFirst : UvSet::kSecond;
}

Value Textures::image_of(const Value& texture) const {
  const Value webp = texture.extension("EXT_texture_webp")["source"];
  const Value source = webp.exists() ? webp : texture["source"];
  return source.exists() ? document_.element("images", source) : Value();
}

Result<SceneBuilder::Image> Textures::decode(const Value& image, const ImageUse& use) {
  SceneBuilder& builder = document_.builder();
  const std::string name = fmt::format("{}, {}", builder.shown(builder.scene_path()), image.path());
  if (image["bufferView"].exists())
    return builder.image_bytes(name, buffers_.view(image["bufferView"]).bytes, use);
  const std::string uri = image.text("uri");
  if (is_data_uri(uri)) {
    const auto bytes = decode_data_uri(uri);
    if (!bytes) return mistake("its uri is not a data URI in base64");
    return builder.image_bytes(name, *bytes, use);
  }
  if (uri.empty() || has_scheme(uri)) return mistake("it names no file by a relative path");
  const auto path = builder.find(decode_percent(uri), builder.scene_path());
  if (!path) return fail(ErrorCode::kNotFound, fmt::format("there is no file {}", in_quotes(uri)));
  return builder.image_file(*path, use);
}

std::optional<SceneBuilder::Image> Textures::image(const Value& info, const ImageUse& use) {
  const Value texture = document_.element("textures", info["index"]);
  const Value image = image_of(texture);
  if (!image.exists()) {
    document_.warn(texture, "texture without image", "has no image that can be read; the texture is ignored");
    return std::nullopt;
  }
  auto decoded = decode(image, use);
  if (decoded) return std::move(*decoded);
  if (decoded.error().code == ErrorCode::kResourceExhausted)
    image.refuse(decoded.error().message, decoded.error().code);
  document_.warn(image, image.path(), fmt::format("{}; the texture is ignored", decoded.error().message));
  return std::nullopt;
}

void Textures::apply_sampler(const Value& sampler, Texture& texture) const {
  texture.wrap = wrap_of(sampler, "wrapS", document_);
  if (const Wrap wrap_v = wrap_of(sampler, "wrapT", document_); wrap_v != texture.wrap)
    texture.wrap_v = wrap_v;
  constexpr std::uint64_t kNearest = 9728;
  if (sampler["magFilter"].as_whole() == kNearest) texture.filter = TextureFilter::kNearest;
}

Texture Textures::with_sampler(const Value& info, SceneBuilder::Image image) {
  Texture texture;
  texture.image = std::move(image);
  texture.uv_set = uv_set(info);
  const Value sampler = document_.element("textures", info["index"])["sampler"];
  if (sampler.exists())
    apply_sampler(document_.element_or_none("samplers", sampler, "the texture repeats"), texture);
  if (const Value transform = info.extension("KHR_texture_transform"); transform.exists())
    apply_transform(transform, texture, document_);
  return texture;
}

int Textures::add(const Value& info, const ImageUse& use) {
  int added = -1;
  if (info.exists())
    document_.try_to(info, "texture", "the texture is ignored", [&] {
      if (auto decoded = image(info, use))
        added = document_.builder().add_texture(with_sampler(info, std::move(*decoded)));
    });
  return added;
}

int Textures::converted(const Value& info, TextureChannel channel, const std::string& name,
                        const Curve& curve) {
  int added = -1;
  if (info.exists())
    document_.try_to(info, "texture", "the texture is ignored",
                     [&] { added = add_converted(info, channel, name, curve); });
  return added;
}

int Textures::add_converted(const Value& info, TextureChannel channel, const std::string& name,
                            const Curve& curve) {
  const std::string key =
      fmt::format("{}, channel {}, {}", image_of(document_.element("textures", info["index"])).path(),
                  static_cast<int>(channel), name);
  auto known = converted_.find(key);
  if (known == converted_.end()) {
    const auto source = image(info, {ColorSpace::kLinear, channel});
    if (!source) return -1;
    auto made = document_.builder().image_pixels(key, apply_curve(**source, curve));
    if (!made) info.refuse(made.error().message, made.error().code);
    known = converted_.emplace(key, std::move(*made)).first;
  }
  return document_.builder().add_texture(with_sampler(info, known->second));
}

}  // namespace tessera::core::gltf
