// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/environment_map.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

#include "core/math/elementary.hpp"

namespace tessera::core::pbrt {
namespace {

constexpr int kMinHeight = 64, kFineHeight = 2048, kMaxHeight = 4096;
constexpr int kSamplesAlongSide = 4;  // of a pixel

bool is_square(const TextureImage& image) {
  return image.width() == image.height();
}

int index_of(float coordinate, int size) {
  return std::clamp(static_cast<int>(coordinate * static_cast<float>(size)), 0, size - 1);
}

// The longitude is counter-clockwise about +z from +x; the upper edge is +z.
Vec2 equirectangular_point(Vec3 d) {
  const float longitude = atan2(d.y, d.x) / (2 * kPi);
  const float colatitude = 0.5f - atan2(d.z, std::sqrt(d.x * d.x + d.y * d.y)) / kPi;
  return {longitude < 0 ? longitude + 1 : longitude, colatitude};
}

// The direction of our equirectangular images (core/lights/equirectangular.hpp). (0, 0) is the upper left.
Vec3 direction_of(float x, float y) {
  const SinCos longitude = sin_cos_turns(x - 0.5f), latitude = sin_cos_turns(0.25f - y / 2);
  return {longitude.sin * latitude.cos, latitude.sin, -longitude.cos * latitude.cos};
}

}  // namespace

// Concentric squares of the upper hemisphere's latitudes, folded outwards for the lower one.
Vec2 equal_area_square(Vec3 d) {
  const float x = std::fabs(d.x), y = std::fabs(d.y), z = std::fabs(d.z);
  const float r = std::sqrt(std::max(0.0f, 1 - z));
  const float turn = atan2(std::min(x, y), std::max(x, y)) * (2 / kPi);
  const float phi = x < y ? 1 - turn : turn;
  float v = phi * r, u = r - v;
  if (d.z < 0) {
    std::swap(u, v);
    u = 1 - u;
    v = 1 - v;
  }
  return {(std::copysign(u, d.x) + 1) / 2, (std::copysign(v, d.y) + 1) / 2};
}

Vec3 equal_area_direction(Vec2 point) {
  const float u = 2 * point.x - 1, v = 2 * point.y - 1;
  const float from_diagonal = 1 - (std::fabs(u) + std::fabs(v));
  const float r = 1 - std::fabs(from_diagonal);
  const float turn = r == 0 ? 1 : (std::fabs(v) - std::fabs(u)) / r + 1;
  const SinCos phi = sin_cos_turns(turn / 8);
  const float z = std::copysign(1 - r * r, from_diagonal);
  const float across = r * std::sqrt(std::max(0.0f, 2 - r * r));
  return {std::copysign(phi.cos, u) * across, std::copysign(phi.sin, v) * across, z};
}

void EnvironmentMap::add_image(std::shared_ptr<const TextureImage> image, const Matrix& from_world,
                               Rgb scale) {
  layers_.push_back({std::move(image), from_world, scale});
  has_light_ = true;
}

Rgb EnvironmentMap::Layer::radiance(Vec3 direction) const {
  const Vec3 inside = from_world.direction(direction);
  const float size = length(inside);
  if (!(size > 0)) return {};
  const Vec3 d = inside / size;
  const Vec2 at = is_square(*image) ? equal_area_square(d) : equirectangular_point(d);
  return image->texel(index_of(at.x, image->width()), index_of(at.y, image->height())) * scale;
}

// An equal-area image of side n has 4 n pixels around its equator. Large ones are not made larger still.
int EnvironmentMap::height() const {
  int height = kMinHeight;
  for (const Layer& layer : layers_) {
    const TextureImage& image = *layer.image;
    const int wanted = is_square(image) ? std::max(std::min(2 * image.height(), kFineHeight), image.height())
                                        : image.height();
    height = std::max(height, wanted);
  }
  return std::min(height, kMaxHeight);
}

TextureImage EnvironmentMap::equirectangular() const {
  const int rows = height(), columns = 2 * rows;
  // Fine images have fewer samples in a pixel, with about as many for each pixel of theirs.
  const int samples = rows > 1024 ? kSamplesAlongSide / 2 : kSamplesAlongSide;
  const float share = 1 / static_cast<float>(samples * samples);
  std::vector<float> values;
  values.reserve(static_cast<std::size_t>(rows) * static_cast<std::size_t>(columns) * 3);
  for (int row = 0; row < rows; ++row)
    for (int column = 0; column < columns; ++column) {
      Rgb sum = constant_ * (1 / share);
      for (int sample = 0; sample < samples * samples; ++sample) {
        const float x = static_cast<float>(column) +
                        (static_cast<float>(sample % samples) + 0.5f) / static_cast<float>(samples);
        const float y = static_cast<float>(row) +
                        (static_cast<float>(sample / samples) + 0.5f) / static_cast<float>(samples);
        const Vec3 d = direction_of(x / static_cast<float>(columns), y / static_cast<float>(rows));
        for (const Layer& layer : layers_) sum += layer.radiance(d);
      }
      for (int channel = 0; channel < 3; ++channel) values.push_back(sum[channel] * share);
    }
  return TextureImage(columns, rows, std::move(values));
}

Status EnvironmentMap::finish(SceneBuilder& builder) const {
  if (!has_light_) return {};
  EnvironmentDescription environment;
  environment.radiance = {constant_, -1};
  if (!layers_.empty()) {
    auto image = builder.image_pixels("the infinite light", size(), [&] { return equirectangular(); });
    if (!image) return fail(image.error());
    Texture texture;
    texture.image = std::move(*image);
    environment.radiance = {Rgb::gray(1), builder.add_texture(texture)};
  }
  builder.set_environment(environment);
  return {};
}

double upper_illuminance(const TextureImage& image) {
  double sum = 0;
  for (int y = 0; y < image.height(); ++y)
    for (int x = 0; x < image.width(); ++x) {
      const Vec3 d =
          equal_area_direction({(static_cast<float>(x) + 0.5f) / static_cast<float>(image.width()),
                                (static_cast<float>(y) + 0.5f) / static_cast<float>(image.height())});
      if (d.z > 0) sum += static_cast<double>(luminance(image.texel(x, y)) * d.z);
    }
  return sum * 2 * std::numbers::pi / (static_cast<double>(image.width()) * image.height());
}

}  // namespace tessera::core::pbrt
