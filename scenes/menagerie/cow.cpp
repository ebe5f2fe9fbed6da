// SPDX-License-Identifier: Apache-2.0
#include "scenes/menagerie/cow.hpp"

#include <algorithm>
#include <utility>

#include "scenes/modelling/atlas.hpp"
#include "scenes/modelling/marching_cubes.hpp"
#include "scenes/modelling/noise.hpp"
#include "scenes/modelling/painting.hpp"

namespace tessera::menagerie {
namespace {

using core::Rgb;
using core::Vec3;
using modelling::blend;
using modelling::both_sides;
using modelling::carve;
using modelling::ellipsoid;
using modelling::Field;
using modelling::limb;
using modelling::smooth_step;
using modelling::srgb;
using modelling::unite;

Field udder() {
  const Field bag = ellipsoid({{0, 5.1f, -4}, {1.7f, 1.3f, 1.7f}});
  const Field front = limb({0.7f, 4.4f, -3.3f}, 0.36f, {0.75f, 3.5f, -3.3f}, 0.27f);
  const Field back = limb({0.7f, 4.4f, -4.7f}, 0.36f, {0.75f, 3.5f, -4.7f}, 0.27f);
  return unite(bag, both_sides(unite(front, back, 0), 0), 0.3f);
}

Field trunk() {
  const Field barrel = ellipsoid({{0, 8.6f, -0.8f}, {4.1f, 4, 6.6f}});
  const Field shoulders = ellipsoid({{0, 9.2f, 3.6f}, {3.5f, 3.7f, 3}});
  const Field hips = ellipsoid({{0, 9.4f, -5}, {3.7f, 3.5f, 3}});
  const Field neck = limb({0, 10.2f, 4.6f}, 2.7f, {0, 13.2f, 7.2f}, 2.1f);
  const Field body = unite(unite(unite(barrel, shoulders, 2.5f), hips, 2.5f), neck, 2);
  return unite(body, udder(), 0.8f);
}

// From the hip down at (x, z), with a hoof split in two.
Field leg(float x, float z, float lean) {
  const Field thigh = limb({x, 7.6f, z}, 1.75f, {x + 0.1f, 4, z + lean}, 1.05f);
  const Field shin = limb({x + 0.1f, 4, z + lean}, 1.05f, {x + 0.1f, 1.3f, z + 0.1f}, 0.92f);
  const Field hoof = limb({x + 0.1f, 1.1f, z + 0.15f}, 1, {x + 0.1f, 0.35f, z + 0.3f}, 1.2f);
  const Field ground = [](Vec3 p) { return p.y; };
  const Field cleft = limb({x + 0.1f, 0, z + 1.75f}, 0.22f, {x + 0.1f, 1.2f, z + 1.3f}, 0.12f);
  const Field whole = unite(unite(thigh, shin, 0.5f), hoof, 0.25f);
  return carve(carve(whole, ground, 0.2f), cleft, 0.15f);
}

Field muzzle() {
  return ellipsoid({{0, 12.3f, 11.7f}, {2.15f, 1.65f, 1.6f}, {0, 1, 0.15f}, {0, -0.15f, 1}});
}

Field nostrils() {
  return both_sides(ellipsoid({{0.85f, 12.8f, 13.1f}, {0.3f, 0.42f, 0.5f}, {0.4f, 1, 0}}), 0);
}

Field eyes() {
  return both_sides(ellipsoid({{1.75f, 14.9f, 10.1f}, {0.5f, 0.66f, 0.6f}, {0, 1, 0}, {0.5f, 0, 1}}), 0);
}

Field horns() {
  const Field root = limb({1.1f, 16.6f, 8}, 0.62f, {2, 17.7f, 8}, 0.5f);
  return both_sides(unite(root, limb({2, 17.7f, 8}, 0.5f, {2.1f, 19, 8.3f}, 0.15f), 0.4f), 0);
}

Field head() {
  const Field skull = ellipsoid({{0, 14.6f, 8.4f}, {2.45f, 2.5f, 2.6f}});
  const Field face = limb({0, 14.2f, 8.8f}, 2, {0, 12.6f, 11}, 1.6f);
  const Field poll = ellipsoid({{0, 16.7f, 8.6f}, {1.2f, 0.8f, 1}});
  const Field brows = both_sides(ellipsoid({{1.75f, 15.35f, 9.7f}, {0.7f, 0.5f, 0.7f}}), 0);
  const Field mouth = limb({-1.5f, 11.55f, 12.9f}, 0.1f, {1.5f, 11.55f, 12.9f}, 0.1f);
  Field whole = unite(unite(skull, face, 1.5f), muzzle(), 1);
  whole = unite(unite(std::move(whole), poll, 0.6f), brows, 0.6f);
  whole = carve(carve(unite(std::move(whole), horns(), 0.25f), nostrils(), 0.2f), mouth, 0.25f);
  return unite(std::move(whole), eyes(), 0.08f);
}

constexpr Vec3 kEarMiddle{3.7f, 15.4f, 7.6f}, kEarOutward{1, -0.12f, -0.2f}, kEarForward{0.25f, -0.15f, 1};

Field ear_hollow() {
  return ellipsoid({kEarMiddle + Vec3{0.1f, 0, 0.5f}, {0.62f, 1.5f, 0.45f}, kEarOutward, kEarForward});
}

Field ear() {
  return carve(ellipsoid({kEarMiddle, {0.95f, 1.9f, 0.5f}, kEarOutward, kEarForward}), ear_hollow(), 0.2f);
}

Field tail() {
  const Field rope = unite(limb({0, 11.6f, -7.4f}, 0.6f, {0.3f, 9.4f, -8.6f}, 0.42f),
                           limb({0.3f, 9.4f, -8.6f}, 0.42f, {0.9f, 6, -8.7f}, 0.36f), 0.3f);
  const Field tuft = ellipsoid({{1, 4.9f, -8.7f}, {0.75f, 1.6f, 0.75f}, {-0.1f, 1, 0}});
  return unite(rope, tuft, 0.4f);
}

Field whole_cow() {
  const Field legs = both_sides(unite(leg(2.1f, 3.6f, -0.1f), leg(2.1f, -5.1f, -0.5f), 0.3f), 0.3f);
  const Field body = unite(trunk(), legs, 1);
  return unite(unite(unite(body, head(), 1.2f), both_sides(ear(), 0), 0.4f), tail(), 0.5f);
}

// Patches of dark hair with frayed edges.
Rgb hair(Vec3 p) {
  const Rgb white = srgb(0xf3eee4), brown = srgb(0x3d2318);
  const float strands = modelling::noise({p.x * 5, p.y * 2, p.z * 5});
  const float patch =
      modelling::noise(p * 0.19f + Vec3{3.3f, 1.2f, 0.4f}) + 0.3f * modelling::noise(p * 0.45f);
  return blend(white, brown, smooth_step(0.01f, 0.05f, patch + 0.012f * strands)) * (1 + 0.04f * strands);
}

// 1 on the surface of a part, and 0 farther from it than `reach`.
float on(const Field& part, Vec3 p, float reach) {
  return 1 - smooth_step(0.6f * reach, reach, part(p));
}

class Coat {
 public:
  Rgb operator()(Vec3 p) const {
    const Rgb pink = srgb(0xe3a598), horn = srgb(0xd9c49c), horn_tip = srgb(0x6a523c);
    const Rgb hoof = srgb(0x4d4038), nostril = srgb(0x8d4f47), eye = srgb(0x120c0a);
    Rgb color = hair(p);
    color = blend(color, pink, on(muzzle_, p, 0.3f));
    color = blend(color, nostril, on(nostrils_, p, 0.2f));
    color = blend(color, pink, 0.9f * on(ear_hollows_, p, 0.12f));
    color = blend(color, pink, on(udder_, p, 0.3f));
    color = blend(color, blend(horn, horn_tip, smooth_step(17.6f, 19, p.y)), on(horns_, p, 0.12f));
    color = blend(color, hoof, 1 - smooth_step(1.3f, 1.45f, p.y));
    return blend(color, eye, on(eyes_, p, 0.1f));
  }

 private:
  Field muzzle_ = muzzle(), nostrils_ = nostrils(), ear_hollows_ = both_sides(ear_hollow(), 0);
  Field udder_ = udder(), horns_ = horns(), eyes_ = eyes();
};

}  // namespace

core::MeshDescription cow(float cube, int texture_px) {
  return modelling::unwrap(modelling::marching_cubes(whole_cow(), {{-7, -0.5f, -10.5f}, {7, 20, 15}, cube}),
                           texture_px);
}

core::Image cow_coat(const core::MeshDescription& cow, int texture_px) {
  const Coat coat;
  return modelling::paint_surface(cow, texture_px, [&](Vec3 p, Vec3) { return coat(p); });
}

}  // namespace tessera::menagerie
