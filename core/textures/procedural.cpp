// SPDX-License-Identifier: Apache-2.0
// The values of procedural textures, one or in lanes.
#include "core/textures/procedural.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

#include "core/math/elementary.hpp"
#include "core/math/lane_array.hpp"
#include "core/sampling/warp.hpp"
#include "core/textures/grid.hpp"
#include "core/textures/noise.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {
namespace {

template <typename T>
RgbOf<T> gray(T value) {
  return {value, value, value};
}

template <typename T>
Vec3Of<T> times(Vec3 v, T factor) {
  return {v.x * factor, v.y * factor, v.z * factor};
}

template <typename T>
Vec3Of<T> transformed(const Transform& t, Vec3Of<T> p) {
  const Vec3Of<T> moved = times(t.x_axis, p.x) + times(t.y_axis, p.y) + times(t.z_axis, p.z);
  return moved + Vec3Of<T>{t.origin.x, t.origin.y, t.origin.z};
}

RgbOf<FloatN> of_image(const Texture& texture, const UvSetsOf<FloatN>& uv) {
  std::array<const Texture*, kLaneCount> every{};
  every.fill(&texture);
  return Texture::evaluate(every, uv);
}
Rgb of_image(const Texture& texture, const UvSets& uv) {
  return texture.evaluate(uv);
}

// 0 or 1, alternately, at the cell of the coordinate.
template <typename T>
T parity(T x) {
  using std::floor;
  const T cell = floor(x);
  return cell - floor(cell * 0.5f) * 2.0f;
}

// The colours of the bands of marble, as control points of a spline, and the factor of their values (Pharr et
// al. 2023, section 10.5).
constexpr std::array<Rgb, 9> kMarbleColors{
    Rgb{0.58f, 0.58f, 0.6f}, Rgb{0.58f, 0.58f, 0.6f}, Rgb{0.58f, 0.58f, 0.6f},
    Rgb{0.5f, 0.5f, 0.5f},   Rgb{0.6f, 0.59f, 0.58f}, Rgb{0.58f, 0.58f, 0.6f},
    Rgb{0.58f, 0.58f, 0.6f}, Rgb{0.2f, 0.2f, 0.33f},  Rgb{0.58f, 0.58f, 0.6f}};
constexpr float kMarbleBrightness = 1.5f;

// The colour of a band, from 0 to 1: a segment of four control points, by de Casteljau's algorithm.
Rgb marble_color(float band) {
  constexpr int kSegments = static_cast<int>(kMarbleColors.size()) - 3;
  const float place = (band > 0 ? std::fmin(band, 1.0f) : 0) * kSegments;
  const int first = std::min(static_cast<int>(place), kSegments - 1);
  const float t = place - static_cast<float>(first);
  std::array<Rgb, 4> points{};
  for (std::size_t i = 0; i < 4; ++i) points[i] = kMarbleColors[static_cast<std::size_t>(first) + i];
  for (std::size_t left = 3; left > 0; --left)
    for (std::size_t i = 0; i < left; ++i) points[i] = points[i] * (1 - t) + points[i + 1] * t;
  return points[0] * kMarbleBrightness;
}

float marble_band(float height) {
  return 0.5f + 0.5f * sin_cos_turns(height / (2 * kPi)).sin;
}

Rgb marble_colors(float height) {
  return marble_color(marble_band(height));
}
RgbOf<FloatN> marble_colors(FloatN height) {
  const FloatLanes heights(height);
  RgbLanes colors;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) colors.set(lane, marble_colors(heights[lane]));
  return colors.all();
}

// Whether (x, y) is in a dot of its cell.
template <typename T>
MaskOf<T> is_in_dot(T x, T y) {
  using std::floor;
  constexpr float kRadius = 0.35f, kMaxShift = 0.5f - kRadius;
  const T cell_x = floor(x + 0.5f), cell_y = floor(y + 0.5f);
  const auto noise = [&](float dx, float dy) { return perlin_noise<T>({cell_x + dx, cell_y + dy, T(0.5f)}); };
  const T from_x = x - (cell_x + kMaxShift * noise(1.5f, 2.8f)),
          from_y = y - (cell_y + kMaxShift * noise(4.5f, 9.8f));
  return (noise(0.5f, 0.5f) > 0.0f) & (from_x * from_x + from_y * from_y < kRadius * kRadius);
}

float turns(float y, float x) {
  return atan2(y, x) / (2 * kPi);
}

template <typename T>
Vec2Of<T> projected(Projection projection, Vec3Of<T> p) {
  if (projection == Projection::kPlanar) return {p.x, p.y};
  if (projection == Projection::kCylindrical)
    return {in_each_lane([](float y, float x) { return 0.5f + turns(y, x); }, p.y, p.x), p.z};
  const auto colatitude = [](float x, float y, float z) { return 2 * turns(std::sqrt(x * x + y * y), z); };
  const auto longitude = [](float y, float x) { return turns(y, x) < 0 ? turns(y, x) + 1 : turns(y, x); };
  return {in_each_lane(colatitude, p.x, p.y, p.z), in_each_lane(longitude, p.y, p.x)};
}

float power(float base, float exponent) {
  return base > 0 ? static_cast<float>(pow(static_cast<double>(base), static_cast<double>(exponent)))
                  : (exponent == 0 ? 1.0f : 0.0f);
}

// Evaluates patterns and what they refer to at one point, or at one in each lane.
template <typename T>
class PatternAt {
 public:
  PatternAt(const std::vector<Texture>& all, const TexturePointOf<T>& at) : all_(all), at_(at) {}

  RgbOf<T> value(const Texture& texture) const {
    if (!texture.procedural) return of_image(texture, at_.uv);
    const ProceduralTexture& procedural = *texture.procedural;
    const Vec3Of<T> p = transformed(procedural.transform, coordinates(procedural.space, texture.uv_set));
    return std::visit([&](const auto& pattern) { return of_pattern(pattern, p); }, procedural.pattern);
  }

 private:
  Vec3Of<T> coordinates(PatternSpace space, UvSet uv_set) const {
    if (space == PatternSpace::kPosition) return at_.position;
    if (space == PatternSpace::kNormal) return at_.normal;
    const Vec2Of<T> uv = at_.uv[uv_set];
    return {uv.x, uv.y, T(0.0f)};
  }
  RgbOf<T> value(const ColorParameter& input) const {
    const RgbOf<T> factor{input.value.r, input.value.g, input.value.b};
    return input.texture < 0 ? factor : factor * value(all_[static_cast<std::size_t>(input.texture)]);
  }
  T value(const ScalarParameter& input) const {
    const T factor = input.value;
    return input.texture < 0 ? factor : factor * value(all_[static_cast<std::size_t>(input.texture)]).r;
  }

  RgbOf<T> of_pattern(const CheckerboardPattern& board, Vec3Of<T> p) const {
    const T sum = parity(p.x) + parity(p.y) + parity(p.z);
    return select(parity(sum) > 0.5f, value(board.odd), value(board.even));
  }
  RgbOf<T> of_pattern(const DotsPattern& dots, Vec3Of<T> p) const {
    return select(is_in_dot(p.x, p.y), value(dots.inside), value(dots.outside));
  }
  RgbOf<T> of_pattern(const FbmPattern& noise, Vec3Of<T> p) const {
    return gray(fbm(p, noise.roughness, noise.octaves));
  }
  RgbOf<T> of_pattern(const WrinkledPattern& noise, Vec3Of<T> p) const {
    return gray(turbulence(p, noise.roughness, noise.octaves));
  }
  RgbOf<T> of_pattern(const WindyPattern&, Vec3Of<T> p) const {
    using std::fabs;
    const T strength = fbm(p * T(0.1f), 0.5f, 3), waves = fbm(p, 0.5f, 6);
    return gray(fabs(strength) * waves);
  }
  RgbOf<T> of_pattern(const MarblePattern& marble, Vec3Of<T> p) const {
    const Vec3Of<T> scaled = p * T(marble.scale);
    return marble_colors(scaled.y + marble.variation * fbm(scaled, marble.roughness, marble.octaves));
  }
  RgbOf<T> of_pattern(const MixPattern& mix, Vec3Of<T>) const {
    const T amount = value(mix.amount);
    return value(mix.first) * (1.0f - amount) + value(mix.second) * amount;
  }
  RgbOf<T> of_pattern(const ProductPattern& product, Vec3Of<T>) const {
    return value(product.first) * value(product.second);
  }
  RgbOf<T> of_pattern(const PowerPattern& p, Vec3Of<T>) const {
    const RgbOf<T> base = value(p.base);
    const auto raised = [&](T channel) {
      return in_each_lane([&](float x) { return power(x, p.exponent); }, channel);
    };
    return {raised(base.r), raised(base.g), raised(base.b)};
  }
  RgbOf<T> of_pattern(const StepPattern& step, Vec3Of<T>) const {
    const RgbOf<T> base = value(step.base);
    const auto compared = [&](T channel) { return select(channel >= step.threshold, T(1.0f), T(0.0f)); };
    return {compared(base.r), compared(base.g), compared(base.b)};
  }

  RgbOf<T> of_pattern(const FacingPattern&, Vec3Of<T> p) const {
    using std::fabs;
    return gray(fabs(p.z));
  }
  RgbOf<T> of_pattern(const GridPattern& grid, Vec3Of<T> p) const {
    const Rgb c = grid.layers.value;
    const RgbOf<T> factor{c.r, c.g, c.b};
    if (grid.layers.texture < 0) return factor;
    return factor * grid_value(grid, *all_[static_cast<std::size_t>(grid.layers.texture)].image, p);
  }
  RgbOf<T> of_pattern(const ProjectedPattern& pattern, Vec3Of<T> p) const {
    const TexturePointOf<T> at(projected(pattern.projection, p), at_.position, at_.normal);
    return PatternAt(all_, at).value(pattern.base);
  }

  const std::vector<Texture>& all_;
  const TexturePointOf<T>& at_;
};

// What is no number becomes 0.
template <typename T>
T clamped(T value, float max) {
  return select(value > 0.0f, smaller(value, T(max)), T(0.0f));
}

template <typename T>
RgbOf<T> seen_by_materials(const Texture& texture, const std::vector<Texture>& all,
                           const TexturePointOf<T>& at) {
  const RgbOf<T> value = PatternAt<T>(all, at).value(texture);
  const float max = texture.procedural->max;
  return {clamped(value.r, max), clamped(value.g, max), clamped(value.b, max)};
}

// The mean over a lattice of points in space, of texture coordinates and of normals. They may miss all that
// is bright, and what has a mean of 0 would be no light: the least result is a thousandth of the largest
// value.
Rgb estimated_mean(const Texture& texture, const std::vector<Texture>& all) {
  constexpr int kSide = 16;
  Rgb sum;
  for (int z = 0; z < kSide; ++z)
    for (int y = 0; y < kSide; ++y)
      for (int x = 0; x < kSide; ++x) {
        const auto along = [](int i) { return (static_cast<float>(i) + 0.5f) / kSide; };
        const Vec3 position = Vec3{along(x) + along(z) / kSide, along(y) + along(x) / kSide, along(z)} * 8;
        const Vec3 normal = sampling::sample_sphere({along(x), along(y)});
        sum += texture.evaluate_procedural(all, {Vec2{along(x), along(y)}, position, normal}) *
               (1.0f / (kSide * kSide * kSide));
      }
  const float least = texture.procedural->max * 1e-3f;
  return {std::max(sum.r, least), std::max(sum.g, least), std::max(sum.b, least)};
}

// The mean of a step over an image, by its texels; nullopt for other textures.
std::optional<Rgb> mean_of_step(const ProceduralTexture& procedural, const std::vector<Texture>& all) {
  const auto* step = std::get_if<StepPattern>(&procedural.pattern);
  if (step == nullptr || step->base.texture < 0) return std::nullopt;
  const TextureImage* image = all[static_cast<std::size_t>(step->base.texture)].image.get();
  if (image == nullptr) return std::nullopt;
  std::array<std::size_t, 3> above{};
  for (int y = 0; y < image->height(); ++y)
    for (int x = 0; x < image->width(); ++x) {
      const Rgb value = step->base.value * image->texel(x, y);
      above[0] += value.r >= step->threshold ? 1 : 0;
      above[1] += value.g >= step->threshold ? 1 : 0;
      above[2] += value.b >= step->threshold ? 1 : 0;
    }
  const float all_texels = static_cast<float>(image->width()) * static_cast<float>(image->height());
  const auto share = [&](std::size_t count) { return static_cast<float>(count) / all_texels; };
  return Rgb{share(above[0]), share(above[1]), share(above[2])};
}

}  // namespace

Rgb Texture::evaluate_procedural(const std::vector<Texture>& all, const TexturePoint& at) const {
  return seen_by_materials(*this, all, at);
}

RgbOf<FloatN> Texture::evaluate_procedural(const std::vector<Texture>& all,
                                           const TexturePointOf<FloatN>& at) const {
  return seen_by_materials(*this, all, at);
}

Rgb Texture::evaluate_unclamped(const std::vector<Texture>& all, const TexturePoint& at) const {
  return PatternAt<float>(all, at).value(*this);
}

Rgb Texture::mean(const std::vector<Texture>& all) const {
  if (!procedural) return image->mean();
  const auto exact = mean_of_step(*procedural, all);
  return exact ? *exact : estimated_mean(*this, all);
}

}  // namespace tessera::core
