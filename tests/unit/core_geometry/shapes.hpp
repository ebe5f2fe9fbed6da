// SPDX-License-Identifier: Apache-2.0
// What the tests of geometry shoot rays at: random numbers that are the same everywhere, meshes and soups.
#pragma once

#include <array>
#include <cstdint>
#include <random>
#include <string>
#include <vector>

#include "core/accel/bvh.hpp"

namespace tessera::core::test {

class Random {
 public:
  explicit Random(std::uint32_t seed) : generator_(seed) {}

  std::uint32_t below(std::uint32_t end) { return generator_() % end; }
  float uniform(float low, float high);
  Vec3 in_box(float half_size);
  Vec3 direction();  // unit, uniform over the sphere
  Vec3 weights();    // barycentric, often on an edge or a corner

 private:
  std::mt19937 generator_;
};

struct Mesh {
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;

  void add(const TriangleCorners& corners);
  Primitives primitives() const;
};

// A closed convex mesh of 20 * 4^subdivisions triangles, counter-clockwise from outside, with its corners on
// the sphere but for rounding.
Mesh icosphere(int subdivisions, Vec3 center, float radius);

// Ways to fill space, each hard on a tree or on arithmetic in its own way.
struct Soup {
  std::string name;
  Primitives primitives;
  float half_size;  // of the box around the origin to which it matters where rays start
};

// All of them, with about `count` primitives each.
std::vector<Soup> all_soups(std::uint32_t count);

// Turned, scaled by different factors along the axes, often mirrored, and moved by up to `distance`.
Transform random_transform(Random& random, float distance);

// A point of a primitive, often on an edge or corner.
Vec3 point_of(const Primitives& primitives, Random& random);

// From anywhere or from a primitive, to anywhere, along an axis or at a primitive; often of limited length.
Ray random_ray(const Soup& soup, Random& random);

// Asks every primitive.
Hit brute_force_hit(const Primitives& primitives, const Ray& ray);

// Bit for bit.
bool identical(const Hit& a, const Hit& b);
std::string describe(const Ray& ray, const Hit& hit);

}  // namespace tessera::core::test
