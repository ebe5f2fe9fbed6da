// SPDX-License-Identifier: Apache-2.0
#include "scenes/small_light/planets.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/elementary.hpp"
#include "core/math/vec3.hpp"
#include "scenes/modelling/files.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::small_light {
namespace {

using core::Image;
using core::Rgb;
using core::Vec3;
using modelling::blend;
using modelling::fractal_noise;
using modelling::noise;
using modelling::smooth_step;
using modelling::srgb;

// The texture of a sphere from the colour at each point of the unit sphere.
Image paint_globe(const std::function<Rgb(Vec3 p)>& color) {
  return modelling::paint(1024, 512, [&](float u, float v) {
    const float longitude = 2 * core::kPi * u, latitude = core::kPi * (v - 0.5f);
    const float c = core::cos(latitude);
    return color({c * core::sin(longitude), core::sin(latitude), c * core::cos(longitude)});
  });
}

Image cratered() {
  const Rgb plain = srgb(0xb0a79c), sea = srgb(0x7c746c), ray = srgb(0xd6cec2);
  return paint_globe([=](Vec3 p) {
    const modelling::Cell large = modelling::cellular_noise(p * 2.6f),
                          small = modelling::cellular_noise(p * 7);
    const auto crater = [](modelling::Cell cell) {
      const float radius = 0.12f + 0.3f * cell.random * cell.random, r = cell.nearest / radius;
      return smooth_step(1.25f, 1, r) * 0.6f - smooth_step(1, 0.8f, r);
    };
    const float height = crater(large) + 0.6f * crater(small);
    const Rgb ground = blend(plain, sea, smooth_step(-0.1f, 0.3f, fractal_noise(p * 1.4f, 4)));
    return blend(ground, ray, 0.5f * std::max(height, 0.0f)) * (1 + 0.25f * std::min(height, 0.0f));
  });
}

Image clouded() {
  const Rgb cream = srgb(0xf0d9a8), amber = srgb(0xd29a52);
  return paint_globe([=](Vec3 p) {
    const Vec3 drawn{p.x * 1.1f, p.y * 4 + 0.8f * noise(p * 1.6f), p.z * 1.1f};
    return blend(cream, amber, smooth_step(-0.6f, 0.7f, fractal_noise(drawn, 4)));
  });
}

Image blue() {
  const Rgb deep = srgb(0x12396b), shelf = srgb(0x2c77a3), land = srgb(0x5f7d3c), dry = srgb(0xb9975b);
  const Rgb snow = srgb(0xf2f4f5);
  return paint_globe([=](Vec3 p) {
    const float height = fractal_noise(p * 1.6f + Vec3{4.2f, 0.7f, 1.9f}, 6);
    const Rgb sea = blend(deep, shelf, smooth_step(-0.35f, 0.05f, height));
    const Rgb ground = blend(land, dry, smooth_step(-0.2f, 0.4f, noise(p * 3)) * (1 - std::fabs(p.y)));
    const Rgb below = blend(sea, ground, smooth_step(0.05f, 0.08f, height));
    const Rgb capped = blend(below, snow, smooth_step(0.8f, 0.88f, std::fabs(p.y) + 0.08f * noise(p * 6)));
    const float cloud = fractal_noise({p.x * 2.2f, p.y * 4 + noise(p * 2), p.z * 2.2f}, 5);
    return blend(capped, snow, 0.85f * smooth_step(0.15f, 0.5f, cloud));
  });
}

Image red() {
  const Rgb rust = srgb(0xb5552f), dark = srgb(0x6d3322), pale = srgb(0xd99a6c), ice = srgb(0xf3ece4);
  return paint_globe([=](Vec3 p) {
    const float ground = fractal_noise(p * 2 + Vec3{9, 2, 5}, 5);
    const Rgb land =
        blend(blend(rust, dark, smooth_step(0.05f, 0.4f, ground)), pale, smooth_step(0, -0.5f, ground));
    return blend(land, ice, smooth_step(0.9f, 0.94f, p.y + 0.05f * noise(p * 9)));
  });
}

// Belts and zones that drag each other into eddies, and the great spot.
Image banded() {
  const std::array<Rgb, 5> belts{srgb(0xe9dcc4), srgb(0xb98a5e), srgb(0xf1e7d3), srgb(0x9c6a47),
                                 srgb(0xd9bd94)};
  const Rgb spot = srgb(0xb4512f);
  return paint_globe([=](Vec3 p) {
    const float eddies = 0.05f * fractal_noise({p.x * 5, p.y * 14, p.z * 5}, 4);
    const float place = std::max(0.0f, p.y + eddies + 1) * 6.5f;
    const float belt = std::floor(place), within = place - belt;
    const auto at = [&](float i) { return belts[static_cast<std::size_t>(i) % belts.size()]; };
    const Rgb color = blend(at(belt), at(belt + 1), smooth_step(0.55f, 1, within));
    const Vec3 from_spot = p - Vec3{0.35f, -0.36f, 0.86f};
    const float r =
        std::sqrt(from_spot.x * from_spot.x + 4 * from_spot.y * from_spot.y + from_spot.z * from_spot.z);
    return blend(color, spot, smooth_step(0.3f, 0.2f, r + 0.4f * eddies));
  });
}

Image ringed() {
  const Rgb pale = srgb(0xead9ae), deep = srgb(0xbd9a62);
  return paint_globe([=](Vec3 p) {
    const float bands = noise({0.5f, p.y * 6, 0.5f}) + 0.4f * noise({3.5f, p.y * 17, 0.5f});
    return blend(pale, deep, smooth_step(-0.5f, 0.6f, bands));
  });
}

Image icy() {
  const Rgb pale = srgb(0x8fc4d8), deep = srgb(0x2f6fae), white = srgb(0xe4f1f6);
  return paint_globe([=](Vec3 p) {
    const Vec3 drawn{p.x, p.y * 5, p.z};
    const Rgb sea = blend(deep, pale, smooth_step(-0.6f, 0.6f, fractal_noise(drawn, 3)));
    return blend(sea, white, 0.7f * smooth_step(0.35f, 0.55f, noise({p.x * 3, p.y * 12, p.z * 3 + 8})));
  });
}

// Along its radius; v runs from the inner edge to the outer one.
Image ring() {
  const Rgb pale = srgb(0xe6d6b0), deep = srgb(0x8c7350), gap = srgb(0x1a1712);
  return modelling::paint(16, 512, [=](float, float v) {
    const float bands = 0.5f + 0.5f * noise({v * 14, 0.5f, 2.5f}) + 0.25f * noise({v * 47, 0.5f, 4.5f});
    const float division = smooth_step(0.04f, 0.02f, std::fabs(v - 0.66f));
    return blend(blend(deep, pale, bands), gap, division) * smooth_step(0, 0.1f, v + 0.03f);
  });
}

constexpr float kChartSize = 24;
constexpr std::array<float, 7> kOrbits{1.3f, 2.1f, 3, 3.9f, 5.1f, 6.4f, 7.4f};

// How much of the chart's gold lies at a distance from the middle, and in a direction in turns.
float gold_of_chart(float r, float turn) {
  constexpr float kLine = 0.018f, kSoft = 0.012f;
  const auto line = [](float distance) { return 1 - smooth_step(kLine, kLine + kSoft, std::fabs(distance)); };
  float gold = 0;
  for (const float orbit : kOrbits) gold = std::max(gold, line(r - orbit));
  // A scale of degrees outside of the last orbit, every tenth mark longer.
  const float marks = turn * 180, mark = std::floor(marks + 0.5f);
  const float reach = static_cast<int>(mark) % 10 == 0 ? 7.75f : 7.58f;
  if (r > 7.4f && r < reach) gold = std::max(gold, line((marks - mark) * 2 * core::kPi * r / 180));
  return gold;
}

Image chart() {
  const Rgb night = srgb(0x1d2c4f), ink = srgb(0x16203c), gold = srgb(0xe0b866), star = srgb(0xf2ead2);
  return modelling::paint(2048, 2048, [=](float u, float v) {
    const float x = (u - 0.5f) * kChartSize, y = (v - 0.5f) * kChartSize;
    const float r = std::sqrt(x * x + y * y), turn = core::atan2(y, x) / (2 * core::kPi) + 0.5f;
    const float wash = fractal_noise({x * 0.5f, y * 0.5f, 2}, 5);
    const modelling::Cell cell = modelling::cellular_noise({x * 2.2f, y * 2.2f, 0.5f});
    const float radius = 0.03f + 0.06f * cell.random * cell.random;
    const Rgb paper = blend(night, ink, smooth_step(-0.5f, 0.5f, wash));
    const Rgb starry = blend(paper, star, 0.8f * smooth_step(radius, 0.6f * radius, cell.nearest));
    return blend(starry, gold, 0.9f * gold_of_chart(r, turn));
  });
}

}  // namespace

core::MeshDescription ring_mesh() {
  constexpr float kInner = 1.3f, kOuter = 2.2f;
  return modelling::grid_mesh({modelling::uniform_lines(128), modelling::uniform_lines(4), true},
                              [](float u, float v) {
                                const float angle = 2 * core::kPi * u, r = kInner + (kOuter - kInner) * v;
                                return Vec3{r * core::sin(angle), 0, r * core::cos(angle)};
                              });
}

const std::vector<Painting>& paintings() {
  static const std::vector<Painting> all{{"cratered", cratered}, {"clouded", clouded}, {"blue", blue},
                                         {"red", red},           {"banded", banded},   {"ringed", ringed},
                                         {"icy", icy},           {"ring", ring},       {"chart", chart}};
  return all;
}

}  // namespace tessera::small_light
