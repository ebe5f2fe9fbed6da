// SPDX-License-Identifier: Apache-2.0
#include "scenes/menagerie/meadow.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/elementary.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::menagerie {
namespace {

using core::Rgb;
using core::Vec2;
using core::Vec3;
using modelling::blend;
using modelling::random_at;
using modelling::smooth_step;
using modelling::srgb;

// Where feet and bellies press the grass down; centimetres.
struct Footprint {
  float x, z, radius;
};
constexpr std::array<Footprint, 9> kFootprints{{{-12, 5, 4.6f},
                                                {-9.8f, 9, 4},
                                                {-14, 1.5f, 3.5f},
                                                {17.5f, -15, 4.6f},
                                                {15.5f, -11, 4},
                                                {19.5f, -18.5f, 3.5f},
                                                {2.2f, 2.4f, 3.4f},
                                                {6.5f, 1.2f, 3.2f},
                                                {6.5f, -5, 4.5f}}};

// 0 under an animal, 1 where the grass is free.
float freedom(float x, float z) {
  float free = 1;
  for (const auto& [foot_x, foot_z, radius] : kFootprints) {
    const float dx = x - foot_x, dz = z - foot_z;
    free = std::min(free, smooth_step(0.7f * radius, 1.15f * radius, std::sqrt(dx * dx + dz * dz)));
  }
  return free;
}

constexpr float kGreens = 0.8f;  // of the texture's width; petals and hearts of flowers lie beyond
constexpr Vec2 kPetalUv{0.88f, 0.5f}, kHeartUv{0.97f, 0.5f};

struct Blade {
  Vec3 root;
  float height, width;
  float turn, bend;  // where it leans to, in turns, and how far, in heights
  float shade;
};

// A strip that narrows to a point, in the shape of a parabola.
core::MeshDescription blade_mesh(const Blade& blade) {
  const float angle = 2 * core::kPi * blade.turn;
  const Vec3 lean{core::cos(angle), 0, core::sin(angle)}, side{-lean.z, 0, lean.x};
  return modelling::grid_mesh({{0, 1}, {0, 0.4f, 0.75f, 1}}, [&](float u, float v) {
    const float half_width = 0.5f * blade.width * (1 - v * v);
    const Vec3 middle =
        blade.root + Vec3{0, blade.height * v, 0} + lean * (blade.height * blade.bend * v * v);
    return middle + side * ((2 * u - 1) * half_width);
  });
}

void add_blade(core::MeshDescription& mesh, const Blade& blade) {
  core::MeshDescription part = blade_mesh(blade);
  for (Vec2& uv : part.uvs) uv = {kGreens * (0.02f + 0.96f * blade.shade), 0.02f + 0.96f * uv.y};
  modelling::append(mesh, part);
}

void add_disc(core::MeshDescription& mesh, Vec3 center, float radius, float height, Vec2 uv) {
  core::MeshDescription part =
      modelling::grid_mesh({modelling::uniform_lines(10), {0, 0.6f, 1}, true}, [&](float u, float v) {
        const float angle = 2 * core::kPi * u;
        const Vec3 out{core::cos(angle), 0, -core::sin(angle)};
        return center + out * (radius * (1 - v)) + Vec3{0, height * v * (2 - v), 0};
      });
  for (Vec2& part_uv : part.uvs) part_uv = uv;
  modelling::append(mesh, part);
}

void add_daisy(core::MeshDescription& mesh, Vec3 root, float height, int seed) {
  constexpr int kPetals = 13;
  constexpr float kHeart = 0.33f;
  add_blade(mesh, {root, height, 0.12f, 0, 0, 0.3f});
  const Vec3 top = root + Vec3{0, 0.97f * height, 0};
  for (int i = 0; i < kPetals; ++i) {
    const float turn = (static_cast<float>(i) + 0.3f * random_at(seed, i, 3)) / kPetals;
    const float angle = 2 * core::kPi * turn;
    const Vec3 out{core::cos(angle), 0.18f + 0.2f * random_at(seed, i, 4), core::sin(angle)};
    const Vec3 side{-out.z, 0, out.x};
    core::MeshDescription petal = modelling::grid_mesh({{0, 1}, {0, 0.5f, 0.85f, 1}}, [&](float u, float v) {
      const float half_width = 0.17f * (0.5f + v) * (v < 1 ? 1.0f : 0.55f);
      return top + out * (0.8f * kHeart + 0.95f * v) + side * ((1 - 2 * u) * half_width);
    });
    for (Vec2& uv : petal.uvs) uv = kPetalUv;
    modelling::append(mesh, petal);
  }
  add_disc(mesh, top + Vec3{0, 0.05f, 0}, kHeart, 0.2f, kHeartUv);
}

// Jittered squares of `spacing`, from the one edge to the other.
struct Patch {
  float low_x, high_x, low_z, high_z, spacing;
};

void grow(core::MeshDescription& mesh, const Patch& patch, int seed) {
  const auto columns = static_cast<int>((patch.high_x - patch.low_x) / patch.spacing);
  const auto rows = static_cast<int>((patch.high_z - patch.low_z) / patch.spacing);
  for (int j = 0; j < rows; ++j) {
    for (int i = 0; i < columns; ++i) {
      const auto random = [&](int k) { return random_at(i, j, 16 * seed + k); };
      const float x = patch.low_x + (static_cast<float>(i) + random(0)) * patch.spacing;
      const float z = patch.low_z + (static_cast<float>(j) + random(1)) * patch.spacing;
      const float free = freedom(x, z);
      const float lush = 0.75f + 0.35f * modelling::noise({x * 0.12f, 0, z * 0.12f});
      const float height = (0.9f + 1.5f * random(2) * random(2)) * lush * (0.25f + 0.75f * free);
      if (free == 0) continue;
      add_blade(mesh, {{x, 0, z},
                       height,
                       0.16f + 0.12f * random(3),
                       random(4),
                       0.15f + 0.7f * random(5),
                       std::clamp(0.25f + 0.5f * random(6) + 0.25f * lush - 0.2f, 0.0f, 1.0f)});
      if (free == 1 && random(7) < 0.0045f * patch.spacing * patch.spacing / 0.5f)
        add_daisy(mesh, {x, 0, z}, 1.9f + 1.6f * random(8), seed * 100000 + j * 1000 + i);
    }
  }
}

}  // namespace

core::MeshDescription meadow() {
  core::MeshDescription mesh;
  grow(mesh, {-30, 34, -26, 34, 0.62f}, 1);
  grow(mesh, {-60, 66, -80, -26, 1.2f}, 2);
  grow(mesh, {-110, 120, -180, -80, 2.6f}, 3);
  return mesh;
}

core::Image meadow_colors() {
  const Rgb root = srgb(0x2c3d16), cool = srgb(0x4f7d31), warm = srgb(0x8ea344), dry = srgb(0xb9ab62);
  const Rgb petal = srgb(0xf4f2ec), heart = srgb(0xe3ab1f);
  return modelling::paint(512, 64, [=](float u, float v) {
    if (u > 0.93f) return heart;
    if (u > kGreens + 0.02f) return petal;
    const float shade = std::min(u / kGreens, 1.0f);
    const Rgb green = blend(cool, warm, smooth_step(0.1f, 0.8f, shade));
    const Rgb tip = blend(green, dry, smooth_step(0.75f, 1, shade) * smooth_step(0.5f, 1, v));
    return blend(root, tip, smooth_step(0, 0.6f, v));
  });
}

core::Image ground_colors() {
  const Rgb moss = srgb(0x3f5a24), soil = srgb(0x3a2c1c), straw = srgb(0x75702f);
  return modelling::paint(512, 512, [=](float u, float v) {
    // On a torus, so that it repeats without a seam.
    const float a = 2 * core::kPi * u, b = 2 * core::kPi * v;
    const Vec3 p{core::cos(a) * (2.4f + core::cos(b)), core::sin(a) * (2.4f + core::cos(b)), core::sin(b)};
    const float patches = modelling::fractal_noise(p * 2, 4), fine = modelling::fractal_noise(p * 13, 3);
    const Rgb green = blend(moss, straw, smooth_step(-0.2f, 0.8f, patches + 0.5f * fine));
    return blend(green, soil, smooth_step(0.25f, 0.6f, fine - 0.3f * patches));
  });
}

}  // namespace tessera::menagerie
