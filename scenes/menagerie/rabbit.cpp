// SPDX-License-Identifier: Apache-2.0
#include "scenes/menagerie/rabbit.hpp"

#include <utility>

#include "scenes/modelling/marching_cubes.hpp"

namespace tessera::menagerie {
namespace {

using core::Vec3;
using modelling::ball;
using modelling::both_sides;
using modelling::carve;
using modelling::ellipsoid;
using modelling::Field;
using modelling::limb;
using modelling::unite;

Field torso() {
  const Field rump = ellipsoid({{0, 4.9f, -3.4f}, {3.7f, 4.9f, 4.5f}});
  const Field back = ellipsoid({{0, 5.9f, -0.6f}, {3.3f, 4.5f, 5}, {0, 1, 0.3f}, {0, -0.3f, 1}});
  const Field chest = ellipsoid({{0, 6, 2.7f}, {2.8f, 4.2f, 2.8f}, {0, 1, 0.1f}, {0, 0, 1}});
  const Field neck = limb({0, 7.4f, 2.2f}, 2.8f, {0, 10.6f, 3.9f}, 2);
  return unite(unite(unite(rump, back, 2.5f), chest, 2), neck, 2);
}

// Paws: three toes, parted by grooves.
Field with_toes(Field leg, Vec3 tip, float width) {
  for (const float side : {-0.33f, 0.33f}) {
    const Vec3 top = tip + Vec3{side * width, 0.75f * width, -0.25f * width};
    const Vec3 front = tip + Vec3{side * width, -0.3f * width, 0.35f * width};
    leg = carve(std::move(leg), limb(top, 0.05f, front, 0.08f), 0.16f);
  }
  return leg;
}

Field haunch() {
  return ellipsoid({{3, 3.9f, -2.2f}, {1.75f, 3.1f, 3.5f}, {-0.18f, 1, 0.35f}, {0, -0.35f, 1}});
}

Field hind_foot() {
  const Field foot = limb({3.5f, 0.8f, -2.9f}, 0.8f, {3.75f, 0.72f, 2.2f}, 0.72f);
  const Field toes = ellipsoid({{3.8f, 0.74f, 2.6f}, {0.95f, 0.74f, 1.2f}});
  return with_toes(unite(foot, toes, 0.6f), {3.8f, 0.74f, 3.6f}, 0.95f);
}

Field foreleg() {
  const Field upper = limb({1.75f, 4.8f, 3.4f}, 1.3f, {1.4f, 1, 5}, 0.7f);
  const Field paw = ellipsoid({{1.4f, 0.68f, 5.6f}, {0.85f, 0.68f, 1.15f}});
  return with_toes(unite(upper, paw, 0.6f), {1.4f, 0.68f, 6.55f}, 0.85f);
}

Field skull() {
  const Field cranium = ellipsoid({{0, 12, 4.6f}, {2.35f, 2.4f, 2.75f}, {0, 1, 0.25f}, {0, -0.25f, 1}});
  const Field cheeks = both_sides(ball({1.05f, 11.05f, 6}, 1.35f), 0.8f);
  const Field muzzle = ellipsoid({{0, 11.25f, 7}, {1.25f, 1.1f, 1.4f}});
  const Field lips = both_sides(ball({0.42f, 10.85f, 7.85f}, 0.62f), 0.12f);
  const Field nose = ellipsoid({{0, 11.55f, 8.25f}, {0.42f, 0.3f, 0.3f}});
  return unite(unite(unite(unite(cranium, cheeks, 1.2f), muzzle, 1), lips, 0.25f), nose, 0.15f);
}

// Set into the side of the head, between lids.
Field with_eyes(Field head) {
  const Vec3 center{1.92f, 12.45f, 5.9f};
  const Field lids = ellipsoid({center, {0.5f, 0.78f, 0.92f}, {0, 1, 0.15f}, {-0.55f, 0, 1}});
  const Field socket =
      ellipsoid({center + Vec3{0.42f, 0, 0.18f}, {0.4f, 0.58f, 0.7f}, {0, 1, 0.15f}, {-0.55f, 0, 1}});
  const Field eye = ball(center + Vec3{-0.06f, 0, -0.02f}, 0.6f);
  head = unite(std::move(head), both_sides(lids, 0), 0.5f);
  head = carve(std::move(head), both_sides(socket, 0), 0.12f);
  return unite(std::move(head), both_sides(eye, 0), 0.06f);
}

Field long_ear() {
  const Vec3 up{0.2f, 1, -0.34f}, forward{0.25f, 0.25f, 1}, middle{1.55f, 16.6f, 2.6f};
  const Field shell = ellipsoid({middle, {1.18f, 3.9f, 0.62f}, up, forward});
  const Field hollow = ellipsoid({middle + Vec3{0.16f, 0.25f, 0.62f}, {0.78f, 3.25f, 0.66f}, up, forward});
  const Field root = limb({1, 13.2f, 3.8f}, 0.85f, {1.3f, 15, 3.2f}, 0.7f);
  return unite(carve(shell, hollow, 0.25f), root, 0.5f);
}

Field whole_rabbit() {
  Field body = unite(torso(), both_sides(haunch(), 0), 0.3f);
  body = unite(std::move(body), both_sides(hind_foot(), 0), 0.35f);
  body = unite(std::move(body), both_sides(foreleg(), 0.2f), 0.8f);
  const Field head = unite(with_eyes(skull()), both_sides(long_ear(), 0.3f), 0.5f);
  const Field tail = ellipsoid({{0, 3.9f, -8}, {1.5f, 1.6f, 1.5f}});
  const Field ground = [](Vec3 p) { return p.y; };
  return carve(unite(unite(std::move(body), head, 1.3f), tail, 0.4f), ground, 0.1f);
}

}  // namespace

core::MeshDescription rabbit(float cube) {
  return modelling::marching_cubes(whole_rabbit(), {{-6, -0.5f, -11}, {6, 21.5f, 10}, cube});
}

}  // namespace tessera::menagerie
