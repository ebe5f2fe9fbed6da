// SPDX-License-Identifier: Apache-2.0
#include "scenes/modelling/marching_cubes.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <utility>
#include <vector>

namespace tessera::modelling {
namespace {

// Corner c of a cube is at ((c & 1), (c >> 1 & 1), (c >> 2 & 1)). An edge is its axis * 4 and the places of
// its ends on the two axes that follow.
constexpr int kCorners = 8, kEdges = 12;

constexpr int coordinate(int corner, int axis) {
  return corner >> axis & 1;
}

constexpr int edge_between(int corner, int neighbor) {
  const int low = std::min(corner, neighbor), changed = corner ^ neighbor;
  const int axis = changed == 1 ? 0 : changed == 2 ? 1 : 2;
  return axis * 4 + coordinate(low, (axis + 1) % 3) + 2 * coordinate(low, (axis + 2) % 3);
}

constexpr int low_corner_of_edge(int edge) {
  const int axis = edge / 4;
  return (edge & 1) << (axis + 1) % 3 | (edge >> 1 & 1) << (axis + 2) % 3;
}

// Counter-clockwise seen from outside the cube.
using Face = std::array<int, 4>;

std::array<Face, 6> cube_faces() {
  std::array<Face, 6> faces{};
  for (int axis = 0; axis < 3; ++axis) {
    const int right = 1 << (axis + 1) % 3, up = 1 << (axis + 2) % 3, far = 1 << axis;
    faces[static_cast<std::size_t>(2 * axis)] = {0, up, right | up, right};
    faces[static_cast<std::size_t>(2 * axis + 1)] = {far, far | right, far | right | up, far | up};
  }
  return faces;
}

using Loop = std::vector<int>;  // of edges
using EdgeTriangle = std::array<int, 3>;

// Where the surface goes from each crossed edge, around the inside corners of one face after the other. Each
// run of inside corners is cut off by itself; the cube on the other side of the face does the same.
std::array<int, kEdges> successors(int inside_mask, const std::array<Face, 6>& faces) {
  std::array<int, kEdges> next{};
  next.fill(-1);
  for (const Face& face : faces) {
    const auto corner = [&](std::size_t k) { return face[k % 4]; };
    const auto inside = [&](std::size_t k) { return (inside_mask >> corner(k) & 1) != 0; };
    for (std::size_t k = 0; k < 4; ++k) {
      if (inside(k) || !inside(k + 1)) continue;
      std::size_t last = k + 1;
      while (inside(last + 1)) ++last;
      next[static_cast<std::size_t>(edge_between(corner(k), corner(k + 1)))] =
          edge_between(corner(last), corner(last + 1));
    }
  }
  return next;
}

std::vector<Loop> loops_of(std::array<int, kEdges> next) {
  std::vector<Loop> loops;
  for (int start = 0; start < kEdges; ++start) {
    Loop loop;
    for (int edge = start; next[static_cast<std::size_t>(edge)] >= 0;) {
      loop.push_back(edge);
      edge = std::exchange(next[static_cast<std::size_t>(edge)], -1);
    }
    if (!loop.empty()) loops.push_back(std::move(loop));
  }
  return loops;
}

bool on_one_face(int edge_a, int edge_b) {
  for (int axis = 0; axis < 3; ++axis) {
    const auto side = [axis](int edge) {
      return edge / 4 == axis ? -1 : coordinate(low_corner_of_edge(edge), axis);
    };
    if (side(edge_a) >= 0 && side(edge_a) == side(edge_b)) return true;
  }
  return false;
}

// A fan none of whose inner edges lies in a face of the cube, where the neighbour might have the same one and
// four triangles would meet. Every loop that occurs has one.
void add_fan(const Loop& loop, std::vector<EdgeTriangle>& triangles) {
  const std::size_t n = loop.size();
  for (std::size_t apex = 0; apex < n; ++apex) {
    bool flat = false;
    for (std::size_t i = 2; i + 1 < n; ++i) flat = flat || on_one_face(loop[apex], loop[(apex + i) % n]);
    if (flat) continue;
    for (std::size_t i = 1; i + 1 < n; ++i) {
      triangles.push_back({loop[apex], loop[(apex + i) % n], loop[(apex + i + 1) % n]});
    }
    return;
  }
}

using CaseTable = std::array<std::vector<EdgeTriangle>, 1 << kCorners>;

// The triangles for each set of inside corners.
const CaseTable& case_table() {
  static const CaseTable table = [] {
    CaseTable built;
    const std::array<Face, 6> faces = cube_faces();
    for (std::size_t mask = 0; mask < built.size(); ++mask) {
      for (const Loop& loop : loops_of(successors(static_cast<int>(mask), faces))) add_fan(loop, built[mask]);
    }
    return built;
  }();
  return table;
}

struct Voxel {
  int x, y, z;
};

class Mesher {
 public:
  Mesher(const Field& field, const CubeLattice& lattice) : field_(field), lattice_(lattice) {
    const Vec3 extent = (lattice.high - lattice.low) / lattice.size;
    for (int axis = 0; axis < 3; ++axis) {
      corners_[static_cast<std::size_t>(axis)] = static_cast<int>(std::ceil(extent[axis])) + 1;
    }
    sample();
  }

  core::MeshDescription mesh() {
    edge_vertices_.assign(values_.size() * 3, kNoVertex);
    for (int z = 0; z + 1 < corners_[2]; ++z) {
      for (int y = 0; y + 1 < corners_[1]; ++y) {
        for (int x = 0; x + 1 < corners_[0]; ++x) add_cube({x, y, z});
      }
    }
    return std::move(mesh_);
  }

 private:
  static constexpr std::uint32_t kNoVertex = 0xffffffffu;

  std::size_t index(Voxel c) const {
    const auto wide = [](int v) { return static_cast<std::size_t>(v); };
    return (wide(c.z) * wide(corners_[1]) + wide(c.y)) * wide(corners_[0]) + wide(c.x);
  }
  Vec3 position(Voxel c) const {
    return lattice_.low +
           Vec3{static_cast<float>(c.x), static_cast<float>(c.y), static_cast<float>(c.z)} * lattice_.size;
  }
  static Voxel corner_cell(Voxel cube, int corner) {
    return {cube.x + coordinate(corner, 0), cube.y + coordinate(corner, 1), cube.z + coordinate(corner, 2)};
  }

  void sample() {
    for (int z = 0; z < corners_[2]; ++z) {
      for (int y = 0; y < corners_[1]; ++y) {
        for (int x = 0; x < corners_[0]; ++x) {
          const bool outermost = x == 0 || y == 0 || z == 0 || x == corners_[0] - 1 || y == corners_[1] - 1 ||
                                 z == corners_[2] - 1;
          const float value = field_(position({x, y, z}));
          values_.push_back(outermost ? std::max(value, lattice_.size) : value);
        }
      }
    }
  }

  void add_cube(Voxel cube) {
    std::size_t mask = 0;
    for (int c = 0; c < kCorners; ++c) {
      if (values_[index(corner_cell(cube, c))] < 0) mask |= std::size_t{1} << c;
    }
    for (const auto& [a, b, c] : case_table()[mask]) {
      mesh_.triangles.push_back({vertex(cube, a), vertex(cube, b), vertex(cube, c)});
    }
  }

  // The vertex on an edge of a cube; cubes share those of the edges they share.
  std::uint32_t vertex(Voxel cube, int edge) {
    const int axis = edge / 4, low = low_corner_of_edge(edge);
    const Voxel from = corner_cell(cube, low), to = corner_cell(cube, low | 1 << axis);
    std::uint32_t& known = edge_vertices_[index(from) * 3 + static_cast<std::size_t>(axis)];
    if (known == kNoVertex) {
      known = static_cast<std::uint32_t>(mesh_.positions.size());
      const Vec3 p = crossing(from, to);
      mesh_.positions.push_back(p);
      mesh_.normals.push_back(gradient_direction(field_, p, lattice_.size / 2));
    }
    return known;
  }

  // Not quite at the ends, where vertices of several edges would meet.
  Vec3 crossing(Voxel from, Voxel to) const {
    constexpr float kClosest = 1.0f / 32;
    const float a = values_[index(from)], b = values_[index(to)];
    const float t = std::clamp(a / (a - b), kClosest, 1 - kClosest);
    return position(from) + (position(to) - position(from)) * t;
  }

  const Field& field_;
  CubeLattice lattice_;
  std::array<int, 3> corners_{};              // along each axis
  std::vector<float> values_;                 // at the corners, x running fastest
  std::vector<std::uint32_t> edge_vertices_;  // three for each corner, of the edges that leave it upwards
  core::MeshDescription mesh_;
};

}  // namespace

core::MeshDescription marching_cubes(const Field& field, const CubeLattice& lattice) {
  return Mesher(field, lattice).mesh();
}

}  // namespace tessera::modelling
