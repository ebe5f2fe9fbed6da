// SPDX-License-Identifier: Apache-2.0
#include "core/textures/texture.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>

namespace tessera::core {

namespace {

// A coordinate inside of the image with the texel of kMirror at `coordinate`.
template <typename T>
T mirrored(T coordinate) {
  using std::floor;
  const T half = coordinate * 0.5f;
  const T within = (half - floor(half)) * 2.0f;
  return select(within > 1.0f, T(2.0f) - within, within);
}

// The centre of the texel of a coordinate, where the others have no weight but rounding; inside of the image
// if it repeats, since large coordinates are coarse.
template <typename T>
T centre_of_texel(T coordinate, T size, MaskOf<T> repeat) {
  using std::floor;
  const T within = select(repeat, coordinate - floor(coordinate), coordinate);
  return (floor(within * size) + 0.5f) / size;
}

}  // namespace

Vec2 Texture::image_point(Vec2 uv) const {
  Vec2 at{uv.x * scale.x + offset.x, uv.y * scale.y + offset.y};
  if (shear != Vec2{}) at = at + Vec2{uv.y * shear.x, uv.x * shear.y};
  if (wrap == Wrap::kMirror) at.x = mirrored(at.x);
  if (wrap_along_v() == Wrap::kMirror) at.y = mirrored(at.y);
  if (filter == TextureFilter::kNearest)
    at = {centre_of_texel(at.x, static_cast<float>(image->width()), wrap == Wrap::kRepeat),
          centre_of_texel(at.y, static_cast<float>(image->height()), wrap_along_v() == Wrap::kRepeat)};
  return at;
}

Rgb Texture::evaluate(Vec2 uv) const {
  return image->bilinear(image_point(uv), wrap, wrap_along_v());
}

float Texture::evaluate_red(const UvSets& uv) const {
  return image->bilinear_red(image_point(uv[uv_set]), wrap, wrap_along_v());
}

namespace {

// The lanes whose textures have the filter kNearest.
class NearestLanes {
 public:
  void set(std::size_t lane, const Texture& texture) {
    if (texture.filter != TextureFilter::kNearest) return;
    nearest_ |= 1u << lane;
    widths_.set(lane, static_cast<float>(texture.image->width()));
    heights_.set(lane, static_cast<float>(texture.image->height()));
  }
  Vec2Of<FloatN> moved_to_centres(Vec2Of<FloatN> at, MaskN repeat_u, MaskN repeat_v) const {
    if (nearest_ == 0) return at;
    const MaskN lanes = MaskN::from_bits(nearest_);
    return {select(lanes, centre_of_texel(at.x, widths_.all(), repeat_u), at.x),
            select(lanes, centre_of_texel(at.y, heights_.all(), repeat_v), at.y)};
  }

 private:
  unsigned nearest_ = 0;                                     // bit i for lane i
  FloatLanes widths_{FloatN(1.0f)}, heights_{FloatN(1.0f)};  // of these lanes
};

// The lanes whose textures wrap in each way.
struct WrapLanes {
  void set(std::size_t lane, Wrap wrap) {
    repeat |= (wrap == Wrap::kRepeat ? 1u : 0u) << lane;
    mirror |= (wrap == Wrap::kMirror ? 1u : 0u) << lane;
  }
  FloatN mirrored_where_due(FloatN coordinate) const {
    return mirror == 0 ? coordinate : select(MaskN::from_bits(mirror), mirrored(coordinate), coordinate);
  }

  unsigned repeat = 0, mirror = 0;  // bit i for lane i
};

// The second set where bit i is set for lane i, else the first.
Vec2Of<FloatN> in_lanes(unsigned by_second, const UvSetsOf<FloatN>& uv) {
  if (by_second == 0) return uv.first;
  const MaskN second = MaskN::from_bits(by_second);
  return {select(second, uv.second.x, uv.first.x), select(second, uv.second.y, uv.first.y)};
}

// The points of their images at which textures are looked up.
struct ImagePoints {
  TextureImage::Images images;
  Vec2Of<FloatN> at;
  MaskN repeat_u, repeat_v;
};

ImagePoints image_points(const std::array<const Texture*, kLaneCount>& textures,
                         const UvSetsOf<FloatN>& uv_sets) {
  TextureImage::Images images;
  FloatLanes scale_u, scale_v, offset_u, offset_v, shear_u, shear_v;
  WrapLanes wrap_u, wrap_v;
  NearestLanes nearest;
  unsigned sheared = 0, by_second = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const Texture& texture = *textures[lane];
    images[lane] = texture.image.get();
    scale_u.set(lane, texture.scale.x), scale_v.set(lane, texture.scale.y);
    offset_u.set(lane, texture.offset.x), offset_v.set(lane, texture.offset.y);
    shear_u.set(lane, texture.shear.x), shear_v.set(lane, texture.shear.y);
    sheared |= (texture.shear != Vec2{} ? 1u : 0u) << lane;
    by_second |= (texture.uv_set == UvSet::kSecond ? 1u : 0u) << lane;
    nearest.set(lane, texture);
    wrap_u.set(lane, texture.wrap);
    wrap_v.set(lane, texture.wrap_along_v());
  }
  const Vec2Of<FloatN> uv = in_lanes(by_second, uv_sets);
  Vec2Of<FloatN> at{uv.x * scale_u.all() + offset_u.all(), uv.y * scale_v.all() + offset_v.all()};
  if (sheared != 0) {
    const MaskN lanes = MaskN::from_bits(sheared);
    at = {select(lanes, at.x + uv.y * shear_u.all(), at.x), select(lanes, at.y + uv.x * shear_v.all(), at.y)};
  }
  const MaskN repeat_u = MaskN::from_bits(wrap_u.repeat), repeat_v = MaskN::from_bits(wrap_v.repeat);
  at = nearest.moved_to_centres({wrap_u.mirrored_where_due(at.x), wrap_v.mirrored_where_due(at.y)}, repeat_u,
                                repeat_v);
  return {images, at, repeat_u, repeat_v};
}

}  // namespace

RgbOf<FloatN> Texture::evaluate(const std::array<const Texture*, kLaneCount>& textures,
                                const UvSetsOf<FloatN>& uv) {
  const ImagePoints points = image_points(textures, uv);
  return TextureImage::bilinear(points.images, points.at, points.repeat_u, points.repeat_v);
}

FloatN Texture::evaluate_red(const std::array<const Texture*, kLaneCount>& textures,
                             const UvSetsOf<FloatN>& uv) {
  const ImagePoints points = image_points(textures, uv);
  return TextureImage::bilinear_red(points.images, points.at, points.repeat_u, points.repeat_v);
}

namespace {

// The textures of the parameters in all lanes. Lanes without an image get another lane's.
template <typename Parameter>
struct TexturesOf {
  TexturesOf(const std::array<const Parameter*, kLaneCount>& parameters, const std::vector<Texture>& all) {
    const Texture* some_image = nullptr;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      if (parameters[lane]->texture < 0) continue;
      const Texture& texture = all[static_cast<std::size_t>(parameters[lane]->texture)];
      textured |= 1u << lane;
      if (texture.procedural) {
        procedural[lane] = &texture;
        with_procedural |= 1u << lane;
      } else {
        some_image = images[lane] = &texture;
      }
    }
    has_images = some_image != nullptr;
    std::replace(images.begin(), images.end(), static_cast<const Texture*>(nullptr), some_image);
  }

  RgbOf<FloatN> colors(const std::vector<Texture>& all, const TexturePointOf<FloatN>& at) const {
    const auto of_images = has_images ? Texture::evaluate(images, at.uv) : RgbOf<FloatN>::gray(0.0f);
    return with_patterns(of_images,
                         [&](const Texture& texture) { return texture.evaluate_procedural(all, at); });
  }
  FloatN reds(const std::vector<Texture>& all, const TexturePointOf<FloatN>& at) const {
    const FloatN of_images = has_images ? Texture::evaluate_red(images, at.uv) : FloatN(0.0f);
    return with_patterns(of_images,
                         [&](const Texture& texture) { return texture.evaluate_procedural(all, at).r; });
  }

  unsigned textured = 0;  // bit i for lane i

 private:
  // Evaluates each procedural texture once, for all of its lanes.
  template <typename Values, typename Evaluate>
  Values with_patterns(Values values, const Evaluate& evaluate) const {
    for (unsigned left = with_procedural; left != 0;) {
      const Texture* texture = procedural[static_cast<std::size_t>(std::countr_zero(left))];
      unsigned its_lanes = 0;
      for (std::size_t lane = 0; lane < kLaneCount; ++lane)
        its_lanes |= (procedural[lane] == texture ? 1u : 0u) << lane;
      values = select(MaskN::from_bits(its_lanes), evaluate(*texture), values);
      left &= ~its_lanes;
    }
    return values;
  }

  unsigned with_procedural = 0;
  bool has_images = false;
  std::array<const Texture*, kLaneCount> images{}, procedural{};
};

}  // namespace

RgbOf<FloatN> evaluate(const std::array<const ColorParameter*, kLaneCount>& parameters,
                       const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at) {
  RgbLanes constants;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) constants.set(lane, parameters[lane]->value);
  const RgbOf<FloatN> value = constants.all();
  const TexturesOf of(parameters, textures);
  if (of.textured == 0) return value;
  return select(MaskN::from_bits(of.textured), value * of.colors(textures, at), value);
}

FloatN evaluate(const std::array<const ScalarParameter*, kLaneCount>& parameters,
                const std::vector<Texture>& textures, const TexturePointOf<FloatN>& at) {
  FloatLanes constants;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) constants.set(lane, parameters[lane]->value);
  const FloatN value = constants.all();
  const TexturesOf of(parameters, textures);
  if (of.textured == 0) return value;
  return select(MaskN::from_bits(of.textured), value * of.reds(textures, at), value);
}

}  // namespace tessera::core
