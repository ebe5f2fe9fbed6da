// SPDX-License-Identifier: Apache-2.0
// Path guiding: where light comes from at positions of a scene, learnt from photons, for sampling
// directions (Jensen 1995; Vorba et al. 2014). The guide is approximate: it affects the noise of an image,
// not its expectation. Immutable once built, shared by all threads.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>
#include <functional>
#include <span>
#include <vector>

#include "core/geometry/aabb.hpp"
#include "core/guiding/direction_tree.hpp"

namespace tessera::core::guiding {

// Light that arrived at a surface.
struct Photon {
  Vec3 position;
  Vec3 side_normal;  // on the side on which the light arrived; that by which the guide is asked there
  Vec3 wi;           // unit, towards the light's origin
  // To the surface that the light came from; positive. Infinite for all photons of a guide: openings let in
  // light from infinity.
  float distance;
  float flux;  // luminous, positive
  // The luminance found by a path in the photon's direction that reaches the light by specular scattering
  // only; 0 if the photon was scattered diffusely in between.
  float radiance;
  bool straight = false;  // whether light samples may find the same light (core/integrators/panes.hpp)
};

// What is known of the light in a cell of the guide when its share is chosen.
struct CellLight {
  std::uint32_t cell;  // number of the cell
  // Root mean square of the irradiance that one guided sample estimates.
  float guided;
  std::span<const Photon> places;  // some of its photons
};
// The fraction of samples to be guided in a cell, in [0, 1); 0 if the guide is of no use there. Called by
// many threads.
using ShareOf = std::function<float(const CellLight& light)>;

// Estimates the luminous irradiance at a photon's position from all light that is carried neither by
// photons nor by direct light sampling, with the n-th set of random numbers. Called by many threads.
using OtherLight = std::function<float(const Photon& photon, std::uint32_t n)>;
// The share with the least noise where a sample finds either the guided light or `other`.
ShareOf share_beside(OtherLight other);

class LightGuide {
 public:
  LightGuide() = default;  // an empty guide
  // The result does not depend on `threads`.
  static LightGuide build(std::span<const Photon> photons, const ShareOf& share_of, int threads);
  // Whether no sample is guided anywhere.
  bool guides_nothing() const;

  // A neighbourhood of surface positions with similar normals. Read in rows of four numbers.
  struct alignas(64) Cell {
    Aabb box;
    // A sphere around the box, with a radius about the distance that the light comes from. Directions are
    // stored relative to the sphere's centre, which corrects the parallax of nearby light for other
    // positions in the box.
    Vec3 center;
    float radius;
    DirectionTrees::Root directions;
    float share;  // fraction of samples to be guided, in [0, 1)
  };
  std::span<const Cell> cells() const { return std::span(cells_).subspan(1); }

  // The guide's data at a position: the cell around it. T is float, or FloatN for positions in lanes.
  template <typename T>
  struct GuidanceOf {
    T share = 0.0f;       // 0 if too little is known; the other members are then unset
    Vec3Of<T> in_sphere;  // the position, relative to the centre
    T radius;
    WordOf<T> directions;
  };
  template <typename T>
  GuidanceOf<T> at(Vec3Of<T> position, Vec3Of<T> side_normal) const;

  // Samples a direction from the position with u in [0, 1) x [0, 1) in lanes where `sampled`, and otherwise
  // takes `other`; also returns its density per solid angle.
  template <typename T>
  DirectionTrees::DirectionOf<T> sample_or(const GuidanceOf<T>& from, MaskOf<T> sampled, Vec2Of<T> u,
                                           Vec3Of<T> other) const;

 private:
  class Builder;

  // Three levels of splits of space at a coordinate, seven splits in total. From the lowest bit on,
  // `axes_and_children` has two bits with the axis of each split, then the index of the first child.
  struct alignas(32) Node {
    std::array<std::uint32_t, 7> splits;  // as_bits
    std::uint32_t axes_and_children;
  };

  std::uint32_t cell_at(std::uint32_t facing, Vec3 position) const;
  U32xN cell_at(U32xN facing, Vec3Of<FloatN> position) const;

  // The first six are the roots, by the dominant axis of the surface normal and its sign. All leaves are
  // `levels_` below them.
  std::vector<Node> nodes_;
  int levels_ = 0;
  std::vector<std::uint32_t> cell_of_leaf_;
  std::vector<Cell> cells_{1};  // entry 0 is the empty cell
  DirectionTrees trees_;
};

}  // namespace tessera::core::guiding
