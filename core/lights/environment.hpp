// Light from infinitely far away in all directions: one radiance, or a picture of the surroundings that is
// sampled in proportion to the mean of its channels. Immutable, shared by all threads.
//
// Pictures are equirectangular, as seen from inside: the middle looks along -z, right of it is +x, the upper
// edge is +y. Longitude and latitude are linear in u and v.
#pragma once

#include <memory>
#include <optional>
#include <vector>

#include "core/lights/light_sample.hpp"
#include "core/math/word_lanes.hpp"
#include "core/sampling/distribution.hpp"
#include "core/textures/texture.hpp"

namespace tessera::core {

class Environment {
 public:
  // `image` may be null: then `radiance` comes from everywhere; else it multiplies the picture. The picture
  // is turned about +y, counter-clockwise seen from above.
  Environment(Rgb radiance, std::shared_ptr<const TextureImage> image, float rotation_degrees);

  // From a direction, of any length but 0. Bilinear between the picture's texels.
  Rgb radiance(Vec3 direction) const;

  // A direction: nine times in ten in proportion to the mean radiance of the texel it falls on, after
  // interpolation, else any that shines alike. Wherever radiance() is not black there is a density. Uniform
  // without a picture.
  std::optional<LightSample> sample(Vec2 u) const;
  float pdf(Vec3 direction) const;

  // radiance() and pdf() of eight directions.
  struct Seen {
    RgbOf<Float8> radiance;
    Float8 pdf;
  };
  Seen see(Vec3Of<Float8> directions) const;
  // sample() of eight, without points. Where nothing is found, wi is not zero.
  LightSamples sample(Vec2Of<Float8> u) const;

  // Watts, the mean of the channels, that fall on a disk of the scene's radius, from all sides.
  double power(double scene_radius) const;

  // The mean of the channels, of a surface that half of the surroundings shine on, were they alike all over.
  double irradiance() const;

 private:
  template <typename T>
  Vec2Of<T> uv_of(Vec3Of<T> direction) const;
  // Of the texel that (u, v) falls on.
  template <typename T>
  Vec2Of<WordOf<T>> texel_of(Vec2Of<T> uv) const;
  float pdf_of_texel(std::uint32_t x, std::uint32_t y) const;
  RgbOf<Float8> radiance_at(Vec2Of<Float8> uv) const;  // of the picture
  // Where a sample falls: how far along its row, in pictures, and how far from the axis and above the equator
  // on the unit sphere.
  struct Place {
    float along_row, horizontal, height;
    float pdf;
  };
  Place place(const GridDistribution::Choice& texel) const;
  template <typename T>
  Vec3Of<T> direction(T along_row, T horizontal, T height) const;
  // Of each texel of a row.
  double solid_angle(int row) const;

  Rgb radiance_;
  std::shared_ptr<const TextureImage> image_;
  int width_, height_;  // in texels; 1 x 1 without a picture
  float turned_;        // turns
  // The density is constant on each texel: it is uniform in longitude and in height on the unit sphere, where
  // equal heights have equal areas (Archimedes). Rows begin at these depths below the north pole.
  std::vector<double> row_begin_;        // and where the last one ends
  std::vector<double> per_solid_angle_;  // one over that of each texel, by row
  GridDistribution texels_;
  double radiance_over_sphere_ = 0;  // the mean of the channels, integrated over solid angle
};

}  // namespace tessera::core
