// SPDX-License-Identifier: Apache-2.0
#include "scenes/still_life/fruit.hpp"

#include <algorithm>
#include <cmath>

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

// The oil glands of citrus skin: shallow pits, `per_cm` of them to a centimetre.
float pits(Vec3 p, float per_cm) {
  const float distance = modelling::cellular_noise(p * per_cm).nearest;
  return 1 - smooth_step(0.05f, 0.55f, distance);
}

// Stands the mesh on y = 0.
void set_down(core::MeshDescription& mesh) {
  float lowest = mesh.positions.front().y;
  for (const Vec3 p : mesh.positions) lowest = std::min(lowest, p.y);
  for (Vec3& p : mesh.positions) p.y -= lowest;
}

core::Image citrus_skin(const Profile& profile, Rgb light, Rgb dark, Rgb navel, float pits_per_cm) {
  return paint_on(profile, 1024, 512, [=](Vec3 p, float, float v) {
    const float patch = 0.5f + 0.6f * modelling::fractal_noise(p * 0.35f, 3);
    const float tip = 1 - smooth_step(0.02f, 0.09f, std::min(v, 1 - v));
    const Rgb skin = blend(blend(dark, light, std::clamp(patch, 0.0f, 1.0f)), navel, 0.8f * tip);
    return skin * (1 - 0.16f * pits(p, pits_per_cm));
  });
}

}  // namespace

Model orange() {
  const Profile profile({{0, -3.42f},
                         {0.35f, -3.48f},
                         {1.5f, -3.3f},
                         {2.9f, -2.25f},
                         {3.75f, 0},
                         {2.95f, 2.25f},
                         {1.5f, 3.3f},
                         {0.4f, 3.42f},
                         {0, 3.3f}});
  core::MeshDescription mesh = modelling::lathe_mesh(profile, 160, 96);
  modelling::displace(mesh, [](Vec3 p, Vec2) {
    return 0.12f * modelling::noise(p * 0.28f) + 0.02f * modelling::noise(p * 1.2f) - 0.035f * pits(p, 3.2f);
  });
  set_down(mesh);
  return {
      std::move(mesh), {}, {}, citrus_skin(profile, srgb(0xf39a2b), srgb(0xe3761b), srgb(0x7d8a3a), 3.2f)};
}

Model lemon() {
  const Profile profile({{0, -4.75f},
                         {0.42f, -4.65f},
                         {0.75f, -4.15f},
                         {1.5f, -3.35f},
                         {2.55f, -1.9f},
                         {3, 0},
                         {2.6f, 1.9f},
                         {1.6f, 3.3f},
                         {0.9f, 3.9f},
                         {0.6f, 4.3f},
                         {0, 4.4f}});
  core::MeshDescription mesh = modelling::lathe_mesh(profile, 144, 96);
  modelling::displace(mesh, [](Vec3 p, Vec2) {
    return 0.16f * modelling::noise(p * 0.3f) + 0.03f * modelling::noise(p * 1.1f) - 0.04f * pits(p, 2.8f);
  });
  for (Vec3& p : mesh.positions) p = {p.y, -p.x, p.z};
  modelling::smooth_normals(mesh);
  set_down(mesh);
  return {
      std::move(mesh), {}, {}, citrus_skin(profile, srgb(0xf6d648), srgb(0xe8b92c), srgb(0x9c9a45), 2.8f)};
}

Model pear() {
  const Profile profile({{0, 0.25f},
                         {0.5f, 0.12f},
                         {1.7f, 0},
                         {3.1f, 0.9f},
                         {3.75f, 2.9f},
                         {3.35f, 5.1f},
                         {2.3f, 7},
                         {1.75f, 8.4f},
                         {1.2f, 9.35f},
                         {0.5f, 9.6f},
                         {0, 9.45f}});
  const auto lean = [](Vec3 p) {
    return Vec3{p.x + 0.006f * p.y * p.y, p.y, p.z + 0.1f * core::sin(0.5f * p.y)};
  };
  core::MeshDescription mesh = modelling::lathe_mesh(profile, 128, 96);
  modelling::displace(mesh, [](Vec3 p, Vec2) {
    return 0.28f * modelling::noise(p * 0.25f) + 0.035f * modelling::noise(p * 1.4f);
  });
  modelling::append(
      mesh, modelling::tube_mesh({{{0, 9.2f, 0}, {0.02f, 10, 0}, {0.2f, 10.9f, 0.1f}, {0.6f, 11.6f, 0.15f}},
                                  {0.2f, 0.15f, 0.14f, 0.24f},
                                  12,
                                  24}));
  for (Vec3& p : mesh.positions) p = lean(p);
  modelling::smooth_normals(mesh);
  set_down(mesh);
  core::Image texture = paint_on(profile, 1024, 1024, [&](Vec3 p, float, float v) {
    const Rgb green = srgb(0xb5b24a), yellow = srgb(0xd3b455), blush = srgb(0xb8562f),
              russet = srgb(0x7a5a34);
    const float ripe = std::clamp(0.5f + 0.5f * modelling::fractal_noise(p * 0.3f, 3), 0.0f, 1.0f);
    const float sunny = smooth_step(0, 4, p.x + 0.8f * modelling::fractal_noise(p * 0.6f, 3));
    const float rough =
        smooth_step(0.25f, 0.9f, modelling::fractal_noise(p * 1.2f, 4) + 3.2f * (0.12f - std::min(v, 1 - v)));
    const Rgb skin = blend(blend(green, yellow, ripe), blush, 0.7f * sunny);
    return blend(skin, russet, 0.75f * rough) * (1 - 0.4f * specks(p, 4));
  });
  return {std::move(mesh), {}, {}, std::move(texture)};
}

}  // namespace tessera::still_life
