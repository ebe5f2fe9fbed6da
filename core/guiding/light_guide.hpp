// SPDX-License-Identifier: Apache-2.0
// Where light comes from at the places of a scene, learnt from photons, for choosing the directions in which
// paths go on (Jensen 1995; Vorba et al. 2014). What it says is a guess: it may make a picture less noisy,
// never wrong. Immutable once built, shared by all threads.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/guiding/direction_tree.hpp"

namespace tessera::core {

// Light that arrived at a surface.
struct Photon {
  Vec3 position;
  Vec3 side_normal;  // the surface's true one, on the side on which the light arrived
  Vec3 wi;           // unit, towards where it came from
  float distance;    // to the surface from which it came, above 0
  float flux;        // luminous, above 0
  // Luminance that a path finds which goes where the photon came from and arrives at the light by mirrors and
  // glass alone; 0 if the photon was scattered in between.
  float radiance;
};

// Estimates the luminous irradiance at a photon's place by all light that neither photons nor lights
// themselves bring, with the n-th random numbers of its own. Called by many threads.
using OtherLight = std::function<float(const Photon& photon, std::uint32_t n)>;

class LightGuide {
 public:
  LightGuide() = default;  // knows of nothing
  // The result does not depend on `threads`.
  static LightGuide build(std::span<const Photon> photons, const OtherLight& other_light, int threads);

  // A neighbourhood on surfaces that face about the same way. Read in rows of four numbers.
  struct alignas(64) Cell {
    Aabb box;
    // A sphere around the box, about as far away as where the light comes from. Directions are kept as those
    // of its points from its centre, so that what is near is seen elsewhere from another place of the box.
    Vec3 center;
    float radius;
    DirectionTrees::Root directions;
    float share;  // of samples that the guide should choose, above 0 and below 1
  };
  std::span<const Cell> cells() const { return std::span(cells_).subspan(1); }

  // What is known at a place: that of the cell around it. T is float, or Float8 for eight places.
  template <typename T>
  struct GuidanceOf {
    T share = 0.0f;       // 0 where too little is known; then there is nothing else
    Vec3Of<T> in_sphere;  // the place, from the centre
    T radius;
    WordOf<T> directions;
  };
  template <typename T>
  GuidanceOf<T> at(Vec3Of<T> position, Vec3Of<T> side_normal) const;

  // Where `sampled`, a direction from the place for u in [0, 1) x [0, 1); elsewhere `other`; and its density
  // per solid angle.
  template <typename T>
  DirectionTrees::DirectionOf<T> sample_or(const GuidanceOf<T>& from, MaskOf<T> sampled, Vec2Of<T> u,
                                           Vec3Of<T> other) const;

 private:
  class Builder;

  // Three splits of space, one after another, below and from a coordinate on: seven of them, since the second
  // and the third are others on each side. From the lowest bits on, `axes_and_children` has two bits with the
  // axis of each, and then the number of the first child.
  struct alignas(32) Node {
    std::array<std::uint32_t, 7> splits;  // as_bits
    std::uint32_t axes_and_children;
  };

  std::uint32_t cell_at(std::uint32_t facing, Vec3 position) const;
  U32x8 cell_at(U32x8 facing, Vec3Of<Float8> position) const;

  // The first six are the roots, by the axis that the surface faces most, and its side. All leaves are
  // `levels_` below them.
  std::vector<Node> nodes_;
  int levels_ = 0;
  std::vector<std::uint32_t> cell_of_leaf_;
  std::vector<Cell> cells_{1};  // the first has no place in it, and stands for none
  DirectionTrees trees_;
};

}  // namespace tessera::core
