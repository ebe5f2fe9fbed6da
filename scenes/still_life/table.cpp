// SPDX-License-Identifier: Apache-2.0
#include "scenes/still_life/table.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/math/elementary.hpp"
#include "scenes/modelling/cloth.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"
#include "scenes/modelling/surface.hpp"

namespace tessera::still_life {
namespace {

using core::Rgb;
using core::Vec2;
using core::Vec3;
using modelling::blend;
using modelling::smooth_step;
using modelling::srgb;

constexpr float kHalfWidth = 80, kBack = -60, kFront = 32, kThickness = 4, kEdgeRadius = 1;

// From the back over the rounded front edge to the lower front edge: x is z, y is y.
Vec2 board_profile(float v) {
  constexpr float kTop = kFront - kEdgeRadius - kBack, kArc = kEdgeRadius * core::kPi / 2;
  constexpr float kFace = kThickness - kEdgeRadius;
  const float s = (1 - v) * (kTop + kArc + kFace);  // v runs backwards, so that the board's outside is up
  if (s <= kTop) return {kBack + s, 0};
  if (s >= kTop + kArc) return {kFront, -kEdgeRadius - (s - kTop - kArc)};
  const float angle = (s - kTop) / kEdgeRadius;
  return {kFront - kEdgeRadius * (1 - core::sin(angle)), -kEdgeRadius * (1 - core::cos(angle))};
}

// Sawn along the trunk: rings seen as long, slowly wandering stripes, and short dark pores. In centimetres.
Rgb wood(float x, float y) {
  const Rgb light = srgb(0x9a6a43), dark = srgb(0x5d3a22), pore = srgb(0x3a2416);
  constexpr float kPlankWidth = 15.5f;
  const float plank = std::floor(y / kPlankWidth), across = y / kPlankWidth - plank;
  const Vec3 p{x * 0.035f, y * 0.35f, plank * 13.7f};
  const float ring = 6 * modelling::fractal_noise(p, 3) + 0.6f * y;
  const float stripe = 0.5f + 0.5f * core::sin(2 * core::kPi * ring);
  const float fiber = modelling::fractal_noise({x * 0.3f, y * 14, plank}, 3);
  const float pores = smooth_step(0.35f, 0.7f, modelling::noise({x * 0.9f, y * 11, plank + 50}));
  const float gap = 1 - smooth_step(0, 0.012f, std::min(across, 1 - across));
  const float tone = 0.9f + 0.25f * modelling::random_at(static_cast<int>(plank), 7, 7) + 0.1f * fiber;
  return blend(blend(blend(dark, light, 0.35f + 0.5f * stripe), pore, 0.5f * pores), Rgb{}, 0.75f * gap) *
         tone;
}

// Where things stand on the cloth: around the middle of each the cloth is smooth.
struct Footprint {
  float x, z, radius;
};
constexpr std::array<Footprint, 6> kFootprints{
    {{-15, 1, 5.2f}, {-1.5f, 8, 4.6f}, {7, 19, 3.6f}, {-8.5f, 18, 3}, {11, -4, 6.2f}, {17, 10, 3.4f}}};
constexpr float kClothRest = 0.12f;  // half the linen's thickness above the board

Vec3 push_out_of_table(Vec3 p) {
  for (const auto& [x, z, radius] : kFootprints) {
    const float dx = p.x - x, dz = p.z - z;
    if (dx * dx + dz * dz < radius * radius) return {p.x, kClothRest, p.z};
  }
  const float radius = kEdgeRadius + kClothRest;
  const Vec3 core{std::clamp(p.x, -kHalfWidth + kEdgeRadius, kHalfWidth - kEdgeRadius),
                  std::clamp(p.y, -kThickness + kEdgeRadius, -kEdgeRadius),
                  std::clamp(p.z, kBack, kFront - kEdgeRadius)};
  const float distance = length(p - core);
  if (distance >= radius) return p;
  if (distance == 0) return {p.x, kClothRest, p.z};
  return core + (p - core) * (radius / distance);
}

constexpr float kLinenWidth = 66, kLinenDepth = 46;

// Plain weave of uneven threads, with three blue stripes along each short side. In centimetres.
Rgb weave(float x, float y) {
  const Rgb flax = srgb(0xd9cfba), blue = srgb(0x49688f);
  const float from_side = std::min(x, kLinenWidth - x);
  const bool stripe = (from_side > 4 && from_side < 5.6f) || (from_side > 6.1f && from_side < 6.5f) ||
                      (from_side > 3.1f && from_side < 3.5f);
  constexpr float kThreadsPerCm = 5;
  const float warp = x * kThreadsPerCm, weft = y * kThreadsPerCm;
  const float warp_thread = std::floor(warp), weft_thread = std::floor(weft);
  const bool warp_on_top = (static_cast<int>(warp_thread) + static_cast<int>(weft_thread)) % 2 == 0;
  const float across = 2 * (warp_on_top ? warp - warp_thread : weft - weft_thread) - 1;
  const float round = 1 - 0.38f * across * across;
  const float thread = warp_on_top ? modelling::noise({warp_thread * 3.7f, y * 0.4f, 0})
                                   : modelling::noise({x * 0.4f, weft_thread * 3.7f, 9});
  const Rgb color = stripe ? blend(flax, blue, warp_on_top ? 0.95f : 0.6f) : flax;
  return color * (round * (1 + 0.13f * thread));
}

}  // namespace

Model table() {
  core::MeshDescription mesh = modelling::grid_mesh(
      {modelling::uniform_lines(8), modelling::uniform_lines(240)}, [](float u, float v) {
        const Vec2 p = board_profile(v);
        return Vec3{kHalfWidth * (2 * u - 1), p.y, p.x};
      });
  return {std::move(mesh), {}, {}, modelling::paint(2048, 1280, [](float u, float v) {
            return wood(2 * kHalfWidth * u, (kFront - kBack + kThickness) * v);
          })};
}

Model linen() {
  modelling::Cloth cloth;
  cloth.columns = 88;
  cloth.rows = 61;
  cloth.spacing = kLinenWidth / static_cast<float>(cloth.columns);
  cloth.start = [](float u, float v) {
    // Pushed together a little, as a hand leaves it; seen from above, v runs to the back.
    const float x = 0.95f * kLinenWidth * (u - 0.5f), z = -0.96f * kLinenDepth * (v - 0.5f);
    const float turn = -0.3f, c = core::cos(turn), s = core::sin(turn);
    const float fold = 2.2f * modelling::fractal_noise({x * 0.11f, z * 0.035f, 3}, 3);
    return Vec3{-5 + c * x + s * z, 2.5f + fold, 17 - s * x + c * z};
  };
  cloth.push_out = push_out_of_table;
  cloth.steps = 360;
  cloth.iterations = 14;
  return {modelling::drape(cloth), {}, {}, modelling::paint(1584, 1104, [](float u, float v) {
            return weave(u * kLinenWidth, v * kLinenDepth);
          })};
}

Model plaster() {
  return {
      {}, {}, {}, modelling::paint(1024, 768, [](float u, float v) {
        const Vec3 p{u * 40, v * 30, 0};
        const float trowel = modelling::fractal_noise(p * 0.22f + Vec3{modelling::noise(p * 0.5f), 0, 0}, 5);
        return blend(srgb(0x6f7466), srgb(0x8d8b78), std::clamp(0.5f + 0.6f * trowel, 0.0f, 1.0f));
      })};
}

}  // namespace tessera::still_life
