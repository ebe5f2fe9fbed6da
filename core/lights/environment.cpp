// SPDX-License-Identifier: Apache-2.0
#include "core/lights/environment.hpp"

#include <algorithm>
#include <array>
#include <numbers>
#include <utility>

#include "core/math/lane_array.hpp"

namespace tessera::core::lights {
namespace {

// In double, which does not underflow.
double mean_of(Rgb c) {
  return (static_cast<double>(c.r) + static_cast<double>(c.g) + static_cast<double>(c.b)) / 3;
}

// The mean over a texel of the linear interpolation between it and its two neighbours.
double mean_over_texel(double before, double here, double after) {
  return (before + 6 * here + after) / 8;
}

// For each texel, the mean over it of `image` times `factor`, bilinearly interpolated and averaged over the
// channels. It is 0 only if the whole texel is black. Row-major.
std::vector<double> texel_means(const TextureImage& image, Rgb factor) {
  const auto width = static_cast<std::size_t>(image.width()),
             height = static_cast<std::size_t>(image.height());
  std::vector<double> across(width * height), means(width * height), row(width);
  for (std::size_t y = 0; y < height; ++y) {
    for (std::size_t x = 0; x < width; ++x)
      row[x] = mean_of(factor * image.texel(static_cast<int>(x), static_cast<int>(y)));
    for (std::size_t x = 0; x < width; ++x)
      across[y * width + x] = mean_over_texel(row[(x + width - 1) % width], row[x], row[(x + 1) % width]);
  }
  for (std::size_t y = 0; y < height; ++y) {
    const std::size_t above = y > 0 ? y - 1 : 0, below = std::min(y + 1, height - 1);
    for (std::size_t x = 0; x < width; ++x)
      means[y * width + x] =
          mean_over_texel(across[above * width + x], across[y * width + x], across[below * width + x]);
  }
  return means;
}

Rgb radiance_of(Rgb radiance, const TextureImage* image, Vec2 uv) {
  return image ? radiance * image->bilinear(uv, Wrap::kRepeat, Wrap::kClamp) : radiance;
}

EnvironmentDistribution distribution_of(Rgb radiance, const TextureImage* image,
                                        const EquirectangularMap& map) {
  const auto mean_at = [&](Vec2 uv) { return mean_of(radiance_of(radiance, image, uv)); };
  if (!image) return EnvironmentDistribution::build(1, 1, {mean_of(radiance)}, mean_at, map);
  return EnvironmentDistribution::build(image->width(), image->height(), texel_means(*image, radiance),
                                        mean_at, map);
}

RgbOf<FloatN> in_all_lanes(Rgb c) {
  return {c.r, c.g, c.b};
}

template <typename T>
WordOf<T> table_for(Vec3Of<T> normal, MisCompensation compensation) {
  return EnvironmentDistribution::table_of(normal_bin(normal), compensation);
}

}  // namespace

Environment::Environment(Rgb radiance, std::shared_ptr<const TextureImage> image, float rotation_degrees,
                         const Transform& orientation, bool visible_to_camera)
    : radiance_(radiance),
      image_(std::move(image)),
      map_(rotation_degrees, orientation),
      visible_to_camera_(visible_to_camera),
      distribution_(
          std::make_shared<EnvironmentDistribution>(distribution_of(radiance_, image_.get(), map_))) {}

Rgb Environment::radiance(Vec3 direction) const {
  return radiance_of(radiance_, image_.get(), map_.uv_of(direction));
}

float Environment::pdf(Vec3 normal, Vec3 direction, MisCompensation compensation) const {
  return distribution_->pdf(table_for(normal, compensation), map_.uv_of(direction));
}

RgbOf<FloatN> Environment::radiance_at(Vec2Of<FloatN> uv) const {
  std::array<const TextureImage*, kLaneCount> images;
  images.fill(image_.get());
  return in_all_lanes(radiance_) * TextureImage::bilinear(images, uv, true, false);
}

Environment::Seen Environment::see(Vec3Of<FloatN> normals, Vec3Of<FloatN> directions,
                                   MisCompensation compensation) const {
  const Vec2Of<FloatN> uv = map_.uv_of(directions);
  return {image_ ? radiance_at(uv) : in_all_lanes(radiance_),
          distribution_->pdf(table_for(normals, compensation), uv)};
}

std::optional<LightSample> Environment::sample(Vec3 normal, Vec2 u, MisCompensation compensation) const {
  const auto [along_row, depth, side, pdf] = distribution_->sample(table_for(normal, compensation), u);
  const Vec3 wi = map_.direction(along_row, depth, side);
  const Rgb arriving = radiance(wi);
  if (is_black(arriving)) return std::nullopt;
  return LightSample{wi, arriving, pdf, false, std::nullopt};
}

LightSamples Environment::sample(Vec3Of<FloatN> normals, Vec2Of<FloatN> u,
                                 MisCompensation compensation) const {
  const auto [along_row, depth, side, pdf] = distribution_->sample(table_for(normals, compensation), u);
  LightSamples samples;
  samples.wi = map_.direction(along_row, depth, side);
  samples.radiance = image_ ? radiance_at(map_.uv_of(samples.wi)) : in_all_lanes(radiance_);
  samples.found = !is_black(samples.radiance);
  samples.pdf = pdf;
  samples.distant = true;
  return samples;
}

double Environment::power(double scene_radius) const {
  return distribution_->radiance_over_sphere() * std::numbers::pi * scene_radius * scene_radius;
}

}  // namespace tessera::core::lights
