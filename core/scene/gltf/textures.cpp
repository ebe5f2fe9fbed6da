// SPDX-License-Identifier: Apache-2.0
#include "core/scene/gltf/textures.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "core/image/srgb.hpp"
#include "core/math/elementary.hpp"
#include "core/scene/gltf/uri.hpp"
#include "core/scene/loader/file_names.hpp"
#include "core/scene/loader/wording.hpp"
#include "core/textures/image_decoder.hpp"

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

// Texel centres of an image.
Vec2 uv_of(int x, int y, TextureSize size) {
  return {(static_cast<float>(x) + 0.5f) / static_cast<float>(size.width),
          1 - (static_cast<float>(y) + 0.5f) / static_cast<float>(size.height)};
}

// The size of the largest image along each axis.
TextureSize common_size(const std::vector<SceneBuilder::Image>& images) {
  TextureSize size{1, 1};
  for (const auto& image : images)
    if (image) size = {std::max(size.width, image->width()), std::max(size.height, image->height())};
  return size;
}

Rgb texel_at(const TextureImage* image, int x, int y, TextureSize size) {
  if (image == nullptr) return Rgb::gray(1);
  if (image->width() == size.width && image->height() == size.height) return image->texel(x, y);
  return image->bilinear(uv_of(x, y, size), Wrap::kRepeat, Wrap::kRepeat);
}

void append(std::vector<std::uint8_t>& bytes, Rgb color, ColorSpace space) {
  for (const float value : {color.r, color.g, color.b}) {
    const float kept = std::clamp(value, 0.0f, 1.0f);
    bytes.push_back(space == ColorSpace::kSrgb ? srgb_encode(kept)
                                               : static_cast<std::uint8_t>(kept * 255 + 0.5f));
  }
}

// An image of 8 bits.
TextureImage combine_texels(const std::vector<SceneBuilder::Image>& images, ColorSpace space,
                            const Textures::Combine& combine) {
  const TextureSize size = common_size(images);
  std::vector<std::uint8_t> bytes;
  bytes.reserve(3 * static_cast<std::size_t>(size.width) * static_cast<std::size_t>(size.height));
  std::vector<Rgb> texels(images.size());
  for (int y = 0; y < size.height; ++y)
    for (int x = 0; x < size.width; ++x) {
      for (std::size_t i = 0; i < images.size(); ++i) texels[i] = texel_at(images[i].get(), x, y, size);
      append(bytes, combine(texels), space);
    }
  return {size.width, size.height, bytes, space};
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
  if (uri.empty() || has_scheme(uri)) return mistake("it names no file");
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
  return combined({{info, {ColorSpace::kLinear, channel}}}, ColorSpace::kLinear, name,
                  [&curve](const std::vector<Rgb>& texels) { return Rgb::gray(curve(texels[0].r)); });
}

int Textures::combined(const std::vector<Input>& inputs, ColorSpace space, const std::string& name,
                       const Combine& combine) {
  const auto images = images_of(inputs);
  const auto first =
      std::find_if(images.begin(), images.end(), [](const auto& image) { return image != nullptr; });
  if (first == images.end()) return -1;
  std::string key = name;
  for (std::size_t i = 0; i < inputs.size(); ++i)
    if (images[i])
      key += fmt::format(", {}: {} channel {}", i,
                         image_of(document_.element("textures", inputs[i].info["index"])).path(),
                         static_cast<int>(inputs[i].use.channel));
  const Value& mapping = inputs[static_cast<std::size_t>(first - images.begin())].info;
  auto known = combined_.find(key);
  if (known == combined_.end()) {
    auto made = document_.builder().image_pixels(key, common_size(images),
                                                 [&] { return combine_texels(images, space, combine); });
    if (!made) mapping.refuse(made.error().message, made.error().code);
    known = combined_.emplace(key, std::move(*made)).first;
  }
  return document_.builder().add_texture(with_sampler(mapping, known->second));
}

// Null for inputs that do not count.
std::vector<SceneBuilder::Image> Textures::images_of(const std::vector<Input>& inputs) {
  std::vector<SceneBuilder::Image> images(inputs.size());
  std::optional<Value> first;
  for (std::size_t i = 0; i < inputs.size(); ++i) {
    const Value& info = inputs[i].info;
    if (!info.exists()) continue;
    document_.try_to(info, "texture", "the texture is ignored", [&] {
      auto decoded = image(info, inputs[i].use);
      if (!decoded) return;
      if (first && !are_mapped_alike(*first, info))
        return document_.warn(
            info, "texture mapping",
            fmt::format("is mapped otherwise than {}, with which it is combined; the texture "
                        "is ignored",
                        first->path()));
      if (!first) first = info;
      images[i] = std::move(*decoded);
    });
  }
  return images;
}

bool Textures::are_mapped_alike(const Value& first, const Value& second) {
  return set_of(first) == set_of(second) && with_sampler(first, nullptr) == with_sampler(second, nullptr);
}

}  // namespace tessera::core::gltf
