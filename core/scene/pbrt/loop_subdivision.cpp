// SPDX-License-Identifier: Apache-2.0
#include "core/scene/pbrt/loop_subdivision.hpp"

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <utility>
#include <vector>

namespace tessera::core::pbrt {
namespace {

using Triangle = std::array<std::uint32_t, 3>;

// A side of a triangle: its ends in ascending order, and the corner opposite.
struct Side {
  std::uint32_t low, high, opposite;
  std::uint32_t triangle, side;  // the side between corners `side` and `side` + 1
};

std::vector<Side> sorted_sides(const std::vector<Triangle>& triangles) {
  std::vector<Side> sides;
  sides.reserve(3 * triangles.size());
  for (std::uint32_t t = 0; t < triangles.size(); ++t)
    for (std::uint32_t i = 0; i < 3; ++i) {
      const std::uint32_t a = triangles[t][i], b = triangles[t][(i + 1) % 3];
      sides.push_back({std::min(a, b), std::max(a, b), triangles[t][(i + 2) % 3], t, i});
    }
  std::sort(sides.begin(), sides.end(), [](const Side& a, const Side& b) {
    return std::tie(a.low, a.high, a.triangle, a.side) < std::tie(b.low, b.high, b.triangle, b.side);
  });
  return sides;
}

// An edge of the mesh.
struct Edge {
  std::uint32_t low, high;
  std::array<std::uint32_t, 2> opposite;
  bool is_boundary;
};

struct Topology {
  std::vector<Edge> edges;
  std::vector<Triangle> edges_of_triangle;  // the edge of each side
};

Topology topology_of(const std::vector<Triangle>& triangles) {
  Topology topology;
  topology.edges_of_triangle.resize(triangles.size());
  const std::vector<Side> sides = sorted_sides(triangles);
  for (std::size_t i = 0; i < sides.size();) {
    std::size_t end = i;
    while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high) {
      topology.edges_of_triangle[sides[end].triangle][sides[end].side] =
          static_cast<std::uint32_t>(topology.edges.size());
      ++end;
    }
    const bool is_boundary = end - i != 2;
    const std::uint32_t other = is_boundary ? sides[i].opposite : sides[i + 1].opposite;
    topology.edges.push_back({sides[i].low, sides[i].high, {sides[i].opposite, other}, is_boundary});
    i = end;
  }
  return topology;
}

// What the rules for a vertex need of its neighbours.
struct Neighbours {
  Vec3 sum{};  // of all
  std::uint32_t valence = 0;
  Vec3 boundary_sum{};  // of those along boundary edges
  std::uint32_t boundary_edges = 0;
};

std::vector<Neighbours> neighbours_of(const std::vector<Vec3>& positions, const std::vector<Edge>& edges) {
  std::vector<Neighbours> all(positions.size());
  const auto add = [&](std::uint32_t vertex, std::uint32_t neighbour, bool is_boundary) {
    Neighbours& n = all[vertex];
    n.sum += positions[neighbour];
    ++n.valence;
    if (!is_boundary) return;
    n.boundary_sum += positions[neighbour];
    ++n.boundary_edges;
  };
  for (const Edge& edge : edges) {
    add(edge.low, edge.high, edge.is_boundary);
    add(edge.high, edge.low, edge.is_boundary);
  }
  return all;
}

// The weight of each neighbour of a vertex inside (Warren 1995).
float neighbour_weight(std::uint32_t valence) {
  return valence == 3 ? 3.0f / 16 : 3 / (8 * static_cast<float>(valence));
}

Vec3 weighted(Vec3 p, const Neighbours& n, float weight) {
  return p * (1 - static_cast<float>(n.valence) * weight) + n.sum * weight;
}

Vec3 moved_vertex(Vec3 p, const Neighbours& n) {
  if (n.valence == 0) return p;
  if (n.boundary_edges == 0) return weighted(p, n, neighbour_weight(n.valence));
  return n.boundary_edges == 2 ? p * 0.75f + n.boundary_sum * 0.125f : p;
}

Vec3 limit_position(Vec3 p, const Neighbours& n) {
  if (n.valence == 0) return p;
  if (n.boundary_edges == 0) {
    const float beta = neighbour_weight(n.valence);
    return weighted(p, n, 1 / (static_cast<float>(n.valence) + 3 / (8 * beta)));
  }
  return n.boundary_edges == 2 ? p * 0.6f + n.boundary_sum * 0.2f : p;
}

Vec3 middle_of(const Edge& edge, const std::vector<Vec3>& p) {
  if (edge.is_boundary) return (p[edge.low] + p[edge.high]) * 0.5f;
  return (p[edge.low] + p[edge.high]) * 0.375f + (p[edge.opposite[0]] + p[edge.opposite[1]]) * 0.125f;
}

void subdivide_once(std::vector<Vec3>& positions, std::vector<Triangle>& triangles) {
  const Topology topology = topology_of(triangles);
  const std::vector<Neighbours> neighbours = neighbours_of(positions, topology.edges);
  std::vector<Vec3> moved;
  moved.reserve(positions.size() + topology.edges.size());
  for (std::size_t v = 0; v < positions.size(); ++v)
    moved.push_back(moved_vertex(positions[v], neighbours[v]));
  const auto first = static_cast<std::uint32_t>(positions.size());
  for (const Edge& edge : topology.edges) moved.push_back(middle_of(edge, positions));
  std::vector<Triangle> finer;
  finer.reserve(4 * triangles.size());
  for (std::size_t t = 0; t < triangles.size(); ++t) {
    const auto& [a, b, c] = triangles[t];
    const auto& sides = topology.edges_of_triangle[t];
    const std::uint32_t ab = first + sides[0], bc = first + sides[1], ca = first + sides[2];
    finer.insert(finer.end(), {{a, ab, ca}, {ab, b, bc}, {ca, bc, c}, {ab, bc, ca}});
  }
  positions = std::move(moved);
  triangles = std::move(finer);
}

// The area-weighted mean of the normals around each vertex of the fine mesh.
std::vector<Vec3> vertex_normals(const std::vector<Vec3>& positions, const std::vector<Triangle>& triangles) {
  std::vector<Vec3> normals(positions.size());
  for (const auto& [a, b, c] : triangles) {
    const Vec3 normal = cross(positions[b] - positions[a], positions[c] - positions[a]);
    for (const std::uint32_t v : {a, b, c}) normals[v] += normal;
  }
  return normals;
}

}  // namespace

MeshDescription subdivide(const MeshDescription& control, int levels) {
  MeshDescription mesh;
  mesh.positions = control.positions;
  mesh.triangles = control.triangles;
  for (int level = 0; level < levels; ++level) subdivide_once(mesh.positions, mesh.triangles);
  const std::vector<Neighbours> neighbours = neighbours_of(mesh.positions, topology_of(mesh.triangles).edges);
  for (std::size_t v = 0; v < mesh.positions.size(); ++v)
    mesh.positions[v] = limit_position(mesh.positions[v], neighbours[v]);
  mesh.normals = vertex_normals(mesh.positions, mesh.triangles);
  return mesh;
}

}  // namespace tessera::core::pbrt
