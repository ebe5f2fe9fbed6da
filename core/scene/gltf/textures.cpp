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
  const std::uint64_t wrap = sampler.whole_or(key, kRepeat);
  if (wrap == kClampToEdge) return Wrap::kClamp;
  if (wrap == kMirroredRepeat) return Wrap::kMirror;
  if (wrap != kRepeat)
    document.warn(sampler[key], "wrap", fmt::format("{} is no way to wrap; the texture repeats", wrap));
  return Wrap::kRepeat;
}

// KHR_texture_transform scales, then rotates counter-clockwise as seen with v downwards, then moves. Here v
// points upwards: v' = 1 - v.
void apply_transform(const Value& transform, Texture& texture) {
  const auto scale = transform.numbers("scale", 2), offset = transform.numbers("offset", 2);
  const Vec2 s = scale.empty() ? Vec2{1, 1} : Vec2{scale[0], scale[1]};
  const Vec2 t = offset.empty() ? Vec2{0, 0} : Vec2{offset[0], offset[1]};
  constexpr float kMaxAngle = 1e4f;
  const float angle = transform.number_or("rotation", 0);
  if (!(angle >= -kMaxAngle && angle <= kMaxAngle)) transform["rotation"].refuse("is too large");
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

std::uint32_t Textures::uv_set(const Value& info) {
  const Value transformed = info.extension("KHR_texture_transform")["texCoord"];
  const std::uint64_t set = transformed.exists() ? transformed.whole() : info.whole_or("texCoord", 0);
  constexpr std::uint64_t kMaxSet = 1000;
  if (set > kMaxSet) info.refuse(fmt::format("there is no TEXCOORD_{}", set));
  return static_cast<std::uint32_t>(set);
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

Texture Textures::with_sampler(const Value& info, SceneBuilder::Image image) const {
  Texture texture;
  texture.image = std::move(image);
  const Value sampler_index = document_.element("textures", info["index"])["sampler"];
  if (sampler_index.exists()) {
    const Value sampler = document_.element("samplers", sampler_index);
    texture.wrap = wrap_of(sampler, "wrapS", document_);
    if (const Wrap wrap_v = wrap_of(sampler, "wrapT", document_); wrap_v != texture.wrap)
      texture.wrap_v = wrap_v;
    constexpr std::uint64_t kNearest = 9728;
    if (sampler.whole_or("magFilter", 0) == kNearest)
      document_.warn(sampler, "nearest", "unfiltered texels are not supported; they are interpolated");
  }
  if (const Value transform = info.extension("KHR_texture_transform"); transform.exists())
    apply_transform(transform, texture);
  return texture;
}

int Textures::add(const Value& info, const ImageUse& use) {
  if (!info.exists()) return -1;
  auto decoded = image(info, use);
  return decoded ? document_.builder().add_texture(with_sampler(info, std::move(*decoded))) : -1;
}

int Textures::converted(const Value& info, TextureChannel channel, const std::string& name,
                        const Curve& curve) {
  if (!info.exists()) return -1;
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
