// SPDX-License-Identifier: Apache-2.0
#include "scenes/still_life/pottery.hpp"

#include <algorithm>

#include "core/math/elementary.hpp"
#include "scenes/modelling/lathe.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"

namespace tessera::still_life {
namespace {

using core::Rgb;
using core::Vec2;
using core::Vec3;
using modelling::blend;
using modelling::paint_on;
using modelling::Profile;
using modelling::smooth_step;
using modelling::specks;
using modelling::srgb;

// What fingers leave in turning clay: a fine spiral, never quite even.
float throwing_ridges(Vec3 p, float u, float spacing) {
  const float wander = 0.6f * modelling::noise(p * 0.35f);
  return core::sin(2 * core::kPi * (p.y / spacing + u + wander));
}

}  // namespace

Model stoneware_bottle() {
  const Profile profile({{0, 0},         {3, 0},         {4.1f, 0.2f},   {4.5f, 1},      {4.7f, 4},
                         {4.7f, 9},      {4.5f, 14},     {3.7f, 18},     {2.3f, 21},     {1.5f, 24},
                         {1.35f, 27.5f}, {1.5f, 29.6f},  {1.95f, 30.6f}, {1.95f, 30.9f}, {1.7f, 31},
                         {1.15f, 30.2f}, {0.95f, 27.5f}, {1.1f, 24},     {1.9f, 21},     {3.3f, 17.8f},
                         {4.1f, 13.8f},  {4.2f, 4},      {3.6f, 1.2f},   {0, 0.9f}});
  core::MeshDescription mesh = modelling::lathe_mesh(profile, 96, 128);
  modelling::displace(mesh, [](Vec3 p, Vec2 uv) {
    const float inside = smooth_step(0.5f, 0.56f, uv.y);
    return uv.y == 0 || uv.y == 1 ? 0
                                  : 0.025f * (1 - inside) * throwing_ridges(p, uv.x == 1 ? 0 : uv.x, 0.9f);
  });
  const Rgb clay = srgb(0x8a5a42), glaze = srgb(0xe4ddcd), thin = srgb(0xb9926f);
  core::Image texture = paint_on(profile, 1024, 1024, [&](Vec3 p, float, float) {
    const float edge = 7.5f + 0.8f * modelling::noise(p * 0.45f) + 0.25f * modelling::noise(p * 1.7f);
    const Rgb grain = Rgb::gray(1 + 0.07f * modelling::fractal_noise(p * 2.5f, 4));
    const Rgb glazed = blend(thin, glaze, smooth_step(edge, edge + 1.2f, p.y));
    const Rgb body = p.y < edge ? clay : glazed;
    return body * grain * (1 - 0.45f * specks(p, 2.2f));
  });
  return {std::move(mesh), {}, {}, std::move(texture)};
}

Model speckled_bowl() {
  const Profile profile({{0, 0.5f},
                         {2.6f, 0.4f},
                         {3.3f, 0},
                         {4.1f, 0},
                         {4.4f, 0.3f},
                         {4.3f, 0.9f},
                         {5.6f, 1.7f},
                         {8, 3.2f},
                         {9.9f, 5.4f},
                         {10.8f, 7.4f},
                         {11, 7.9f},
                         {10.85f, 8.1f},
                         {10.6f, 7.9f},
                         {9.4f, 5.5f},
                         {7.5f, 3.6f},
                         {4.8f, 2.2f},
                         {0, 1.7f}});
  core::MeshDescription mesh = modelling::lathe_mesh(profile, 128, 112);
  modelling::displace(mesh, [](Vec3 p, Vec2 uv) {
    const float wall = smooth_step(0.22f, 0.28f, uv.y) * (1 - smooth_step(0.92f, 0.98f, uv.y));
    return 0.035f * wall * throwing_ridges(p, uv.x == 1 ? 0 : uv.x, 0.8f);
  });
  const Rgb rim = srgb(0x6b4a33), glaze = srgb(0xb9c4b2), pooled = srgb(0x8fa69a);
  core::Image texture = paint_on(profile, 1536, 1024, [&](Vec3 p, float, float) {
    const float depth = smooth_step(2, 7, p.y) + 0.15f * modelling::fractal_noise(p * 0.5f, 3);
    const Rgb glazed = blend(pooled, glaze, std::clamp(depth, 0.0f, 1.0f));
    const Rgb bare = blend(glazed, rim, smooth_step(7.45f, 7.9f, p.y + 0.12f * modelling::noise(p * 1.5f)));
    return bare * (1 + 0.05f * modelling::fractal_noise(p * 3, 3)) * (1 - 0.6f * specks(p, 2));
  });
  return {std::move(mesh), {}, {}, std::move(texture)};
}

Model goblet() {
  const Profile profile({{0, 0.12f},     {2, 0.06f},     {3.5f, 0},      {3.72f, 0.1f},  {3.5f, 0.24f},
                         {1.8f, 0.55f},  {0.7f, 1.15f},  {0.42f, 2.4f},  {0.4f, 4.4f},   {0.62f, 5.4f},
                         {0.95f, 5.9f},  {0.62f, 6.4f},  {0.42f, 7.2f},  {0.6f, 8.1f},   {1.7f, 9.1f},
                         {3.1f, 10.7f},  {3.85f, 13},    {3.85f, 15.4f}, {3.5f, 17.9f},  {3.42f, 18},
                         {3.34f, 17.9f}, {3.68f, 15.4f}, {3.67f, 13},    {2.95f, 10.9f}, {1.6f, 9.5f},
                         {0, 9}});
  return {modelling::lathe_mesh(profile, 96, 144), {}, {}, {}};
}

}  // namespace tessera::still_life
