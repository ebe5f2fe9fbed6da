// SPDX-License-Identifier: Apache-2.0
// Dielectrics that overlap, such as glass and the liquid in it (Schmidt and Budge 2002). Of the materials
// with a priority whose surfaces enclose a point, the one of the highest priority fills it; of equal ones,
// the first in the scene. A surface is where that changes, or it has no effect. Thread-safe.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "core/materials/material.hpp"

namespace tessera::core {

// The materials with a priority that enclose a point, by rank, and how many times each: as many as solids of
// it overlap there. It does not depend on the order of the surfaces crossed.
class Enclosing {
 public:
  // Of more materials than that, the lowest ranks are forgotten.
  static constexpr std::size_t kMaxCount = 8;

  bool empty() const { return count_ == 0; }
  // The rank of the material that fills the point. There must be one.
  std::uint8_t first() const { return materials_[0].rank; }
  void add(std::uint8_t rank);
  // Nothing happens if it does not enclose the point, as where the camera stands in it.
  void remove(std::uint8_t rank);

  friend bool operator==(const Enclosing&, const Enclosing&) = default;

 private:
  struct Counted {
    std::uint8_t rank = 0;
    std::uint16_t times = 0;  // up to its largest value: further solids are forgotten
    friend bool operator==(const Counted&, const Counted&) = default;
  };

  std::array<Counted, kMaxCount> materials_{};  // of ascending ranks, then zeros
  std::uint8_t count_ = 0;
};

class NestedDielectrics {
 public:
  NestedDielectrics() = default;
  // Of a scene's materials, at most kMaxNestedDielectrics of them with a priority. Appends to them what
  // scatters at their surfaces: for each with a priority, one that lies in no other, and one for each other
  // of lower priority around it, with the index of refraction relative to that, and its medium outside.
  explicit NestedDielectrics(std::vector<Material>& materials);

  bool empty() const { return boundaries_.empty(); }
  bool contains(std::uint32_t material) const { return rank_of(material) != kNone; }

  // What encloses the points on one side of a surface of `material`, which this contains, by what encloses
  // those on the other.
  Enclosing outside_of(std::uint32_t material, Enclosing inside) const;
  Enclosing inside_of(std::uint32_t material, Enclosing outside) const;
  // The material that scatters at the surface; nothing if it has no effect.
  std::optional<std::uint32_t> boundary(std::uint32_t material, const Enclosing& outside) const;

 private:
  static constexpr std::uint8_t kNone = 0xff;
  std::uint8_t rank_of(std::uint32_t material) const {
    return material < ranks_.size() ? ranks_[material] : kNone;
  }

  std::vector<std::uint8_t> ranks_;  // by material
  // By rank: the first of its boundaries among the materials. That in the next rank follows, and so on.
  std::vector<std::uint32_t> boundaries_;
};

}  // namespace tessera::core
