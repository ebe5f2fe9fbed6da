// SPDX-License-Identifier: Apache-2.0
#include "scenes/go/furniture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>
#include <vector>

#include "core/image/srgb.hpp"
#include "core/math/elementary.hpp"
#include "scenes/go/stones.hpp"
#include "scenes/go/wood.hpp"
#include "scenes/modelling/lathe.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::go {
namespace {

using core::Rgb;
using core::Vec2;
using core::Vec3;
using modelling::Profile;
using modelling::smooth_step;
using modelling::srgb;

constexpr float kMargin = 1.4f;  // of wood beyond the outermost lines
constexpr float kBevel = 0.12f;  // of the upper edge
constexpr float kLineWidth = 0.1f;
constexpr float kStarRadius = 0.2f, kLacquerThickness = 0.004f;
constexpr float kTexelsPerCm = 58;

// Half the board's width and depth.
Vec2 half_extent(int size) {
  const float half = 0.5f * static_cast<float>(size - 1);
  return {half * kColumnSpacing + kMargin, half * kRowSpacing + kMargin};
}

// The lines, counted from the edge, on which star points are.
std::vector<int> star_lines(int size) {
  const int edge = size >= 13 ? 3 : 2;
  if (size < 9) return {size / 2};
  if (size % 2 == 0) return {edge, size - 1 - edge};
  return {edge, size / 2, size - 1 - edge};
}

float to_nearest_star(int size, float x, float z) {
  float nearest = std::numeric_limits<float>::max();
  for (const int i : star_lines(size)) {
    for (const int j : star_lines(size))
      nearest = std::min(nearest, length_squared(Vec3{x, 0, z} - intersection({i, j}, size)));
  }
  return std::sqrt(nearest);
}

// 1 on lacquer, 0 on wood, in between over one texel; x and z from the board's middle.
float lacquer(int size, float x, float z) {
  const float half = 0.5f * static_cast<float>(size - 1);
  const float column = x / kColumnSpacing + half, row = z / kRowSpacing + half;
  const float last = static_cast<float>(size - 1), soft = 0.5f / kTexelsPerCm;
  const auto inside = [soft](float distance, float half_width) {
    return 1 - smooth_step(half_width - soft, half_width + soft, distance);
  };
  const auto nearest = [last](float line) { return std::clamp(std::floor(line + 0.5f), 0.0f, last); };
  const float beyond_x = std::max({-column, column - last, 0.0f}) * kColumnSpacing;
  const float beyond_z = std::max({-row, row - last, 0.0f}) * kRowSpacing;
  const float to_column = std::fabs(column - nearest(column)) * kColumnSpacing;
  const float to_row = std::fabs(row - nearest(row)) * kRowSpacing;
  const float covered =
      std::max(std::min(inside(to_column, kLineWidth / 2), inside(beyond_z, kLineWidth / 2)),
               std::min(inside(to_row, kLineWidth / 2), inside(beyond_x, kLineWidth / 2)));
  return std::max(covered, inside(to_nearest_star(size, x, z), kStarRadius));
}

// A tangent-space normal map from how far a surface stands out at each texel, rows from the top.
core::Image normal_map(int width, int height, const std::vector<float>& relief) {
  const auto at = [&](int x, int y) {
    const int i = std::clamp(x, 0, width - 1), j = std::clamp(y, 0, height - 1);
    return relief[static_cast<std::size_t>(j) * static_cast<std::size_t>(width) +
                  static_cast<std::size_t>(i)];
  };
  // Images are written with the transfer function of sRGB, and these numbers are to be stored as they are.
  const auto stored = [](float c) {
    return core::srgb_decode(static_cast<std::uint8_t>(127.5f * (c + 1) + 0.5f));
  };
  core::Image normals(width, height);
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float right = (at(x + 1, y) - at(x - 1, y)) * (0.5f * kTexelsPerCm);
      const float up = (at(x, y - 1) - at(x, y + 1)) * (0.5f * kTexelsPerCm);
      const Vec3 n = core::normalize({-right, -up, 1});
      normals.at(x, y) = {stored(n.x), stored(n.y), stored(n.z)};
    }
  }
  return normals;
}

core::MeshDescription flat(Vec2 half) {
  return modelling::grid_mesh({modelling::uniform_lines(8), modelling::uniform_lines(8)},
                              [half](float u, float v) {
                                return Vec3{half.x * (2 * u - 1), 0, half.y * (1 - 2 * v)};
                              });
}

// A point of one of the board's four sides, counted counter-clockwise seen from above beginning in front:
// s from -1 to 1 along it, and `down` along the surface, bevel first.
Vec3 on_side(Vec2 half, int side, float s, float down) {
  const float in = std::max(kBevel - down, 0.0f), y = -std::min(down, kBoardHeight);
  const float x = half.x - in, z = half.y - in;
  const std::array<Vec3, 4> places{Vec3{s * x, y, z}, {x, y, -s * z}, {-s * x, y, -z}, {-x, y, s * z}};
  return places[static_cast<std::size_t>(side)];
}

core::Image paint_wood(const Profile& profile) {
  return modelling::paint_on(profile, 1024, 512, [](Vec3 p, float, float) { return mulberry(p); });
}

// The mesh twice, turned so that the two do not look alike.
core::MeshDescription at_both_places(const core::MeshDescription& mesh, Vec3 Place::*where) {
  core::MeshDescription both;
  for (const Place* place : {&kBlackPlace, &kWhitePlace}) {
    core::MeshDescription part = mesh;
    const Vec3 along = place == &kBlackPlace ? Vec3{0.8f, 0, 0.6f} : Vec3{-0.6f, 0, 0.8f};
    const auto turned = [along](Vec3 p) {
      return Vec3{along.x * p.x - along.z * p.z, p.y, along.z * p.x + along.x * p.z};
    };
    for (Vec3& p : part.positions) p = turned(p) + place->*where;
    for (Vec3& n : part.normals) n = turned(n);
    modelling::append(both, part);
  }
  return both;
}

Profile lid_profile() {
  return Profile({{0, 0},
                  {2.6f, 0},
                  {3.4f, 0.05f},
                  {4.8f, 0.45f},
                  {5.75f, 1.1f},
                  {6, 1.6f},
                  {5.92f, 1.74f},
                  {5.75f, 1.68f},
                  {5.3f, 1.15f},
                  {4.4f, 0.72f},
                  {2.8f, 0.46f},
                  {0, 0.42f}});
}

}  // namespace

Model board_top(int size) {
  const Vec2 half = half_extent(size) - Vec2{kBevel, kBevel};
  const auto width = static_cast<int>(2 * half.x * kTexelsPerCm);
  const auto height = static_cast<int>(2 * half.y * kTexelsPerCm);
  const Rgb black = srgb(0x17120e);
  core::Image color(width, height);
  std::vector<float> relief;
  relief.reserve(color.pixels.size());
  for (int y = 0; y < height; ++y) {
    for (int x = 0; x < width; ++x) {
      const float u = (static_cast<float>(x) + 0.5f) / static_cast<float>(width);
      const float v = (static_cast<float>(y) + 0.5f) / static_cast<float>(height);  // downwards
      const Vec3 p{half.x * (2 * u - 1), 0, half.y * (2 * v - 1)};
      const Kaya wood = kaya(p);
      const float covered = lacquer(size, p.x, p.z);
      color.at(x, y) = modelling::blend(wood.color, black, covered);
      relief.push_back(wood.relief + kLacquerThickness * covered);
    }
  }
  core::Image normals = normal_map(width, height, relief);
  return {flat(half), std::move(color), std::move(normals)};
}

Model board_sides(int size) {
  const Vec2 half = half_extent(size);
  constexpr float kDown = kBoardHeight + kBevel;  // along the surface
  core::MeshDescription mesh;
  for (int side = 0; side < 4; ++side) {
    core::MeshDescription part = modelling::grid_mesh(
        {modelling::uniform_lines(16), {0, 1 - 2 * kBevel / kDown, 1 - kBevel / kDown, 1}},
        [half, side](float s, float v) { return on_side(half, side, 2 * s - 1, (1 - v) * kDown); });
    for (Vec2& uv : part.uvs) uv.x = 0.25f * (static_cast<float>(side) + uv.x);
    modelling::append(mesh, part);
  }
  return {std::move(mesh),
          modelling::paint(4096, 192,
                           [half](float u, float v) {
                             const auto side = static_cast<int>(4 * u);
                             const float s = 2 * (4 * u - static_cast<float>(side)) - 1;
                             return kaya(on_side(half, side, s, (1 - v) * kDown)).color;
                           }),
          {}};
}

Model bowls() {
  const Profile profile({{0, 0},
                         {3.9f, 0},
                         {4.4f, 0.12f},
                         {5.2f, 0.9f},
                         {6.5f, 2.6f},
                         {7, 4.5f},
                         {6.9f, 6},
                         {6.3f, 7.6f},
                         {5.5f, 8.9f},
                         {5.38f, 9.12f},
                         {5.25f, 9.2f},
                         {5.1f, 9.1f},
                         {5.3f, 8.4f},
                         {6.2f, 6.4f},
                         {6.4f, 4.5f},
                         {5.9f, 2.8f},
                         {4.6f, 1.4f},
                         {0, 1}});
  return {at_both_places(modelling::lathe_mesh(profile, 128, 96), &Place::bowl), paint_wood(profile), {}};
}

Model lids() {
  const Profile profile = lid_profile();
  return {at_both_places(modelling::lathe_mesh(profile, 128, 64), &Place::lid), paint_wood(profile), {}};
}

std::function<float(float radius)> lid_floor() {
  // The inside runs from the rim inwards; it is searched for the place over `radius`.
  return [profile = lid_profile()](float radius) {
    float outer = 0.55f, inner = 1;
    for (int i = 0; i < 24; ++i) {
      const float middle = 0.5f * (outer + inner);
      (profile.at(middle).x > radius ? outer : inner) = middle;
    }
    return profile.at(inner).y;
  };
}

Model table() {
  return {{},
          modelling::paint(1650, 1200,
                           [](float u, float v) {
                             return walnut({220 * u, 0, 160 * v});
                           }),
          {}};
}

Model shell() {
  return {{},
          modelling::paint(1024, 1024,
                           [](float u, float v) {
                             const Vec3 p{8 * u, 8 * v, 0};
                             const float bend =
                                 0.25f * modelling::noise(p * 0.35f) + 0.03f * modelling::noise(p * 1.5f);
                             const float line = 0.5f + 0.5f * core::sin(2 * core::kPi * 6 * (p.x + bend));
                             const float strength = 0.06f * (0.6f + 0.4f * modelling::noise(p * 0.8f));
                             const Rgb warm =
                                 modelling::blend(srgb(0xf3eee2), srgb(0xe6dcc6),
                                                  0.5f + 0.4f * modelling::fractal_noise(p * 0.6f, 3));
                             return warm * (1 - strength * line);
                           }),
          {}};
}

Model slate() {
  return {{},
          modelling::paint(1024, 1024,
                           [](float u, float v) {
                             const Vec3 p{8 * u, 8 * v, 0};
                             const float cloud = 1 + 0.2f * modelling::fractal_noise(p * 1.2f, 4);
                             const float fleck = modelling::specks(p + Vec3{0, 0, 4}, 9) * 0.5f;
                             return srgb(0x26282b) * cloud * (1 + fleck);
                           }),
          {}};
}

}  // namespace tessera::go
