// SPDX-License-Identifier: Apache-2.0
#include "core/scene/loader/triangle_filter.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <tuple>
#include <unordered_set>
#include <vector>

#include "core/base/prefetch.hpp"
#include "core/scene/loader/vertex_normals.hpp"

namespace tessera::core {
namespace {

using Points = std::array<Vec3, 3>;

bool is_before(Vec3 a, Vec3 b) {
  return std::tie(a.x, a.y, a.z) < std::tie(b.x, b.y, b.z);
}

// The triangle's corners in their cyclic order, rotated to a canonical first corner.
Points points_of(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& triangle) {
  Points points{mesh.positions[triangle[0]], mesh.positions[triangle[1]], mesh.positions[triangle[2]]};
  std::rotate(points.begin(), std::min_element(points.begin(), points.end(), is_before), points.end());
  return points;
}

std::size_t hash(const Points& points) {
  std::uint64_t h = 0;
  for (const Vec3 p : points)
    for (const float c : {p.x, p.y, p.z}) {
      // 0 and -0 are equal.
      h = (h ^ std::bit_cast<std::uint32_t>(c + 0.0f)) * 0x9e3779b97f4a7c15u;
      h ^= h >> 32;
    }
  return h;
}

// Finds triangles that may coincide with others: those that share a hash. A filter with two bits per slot
// rejects nearly all others, with a fraction of the memory and cache misses of a hash table; lookups are
// prefetched some triangles ahead.
class PossibleTwins {
 public:
  explicit PossibleTwins(const MeshDescription& mesh) : slots_(mesh.triangles.size()) {
    const std::size_t slot_count = std::min(std::bit_ceil(8 * slots_.size()), kMaxSlots);
    bits_.resize(std::max(slot_count / kSlotsOfWord, std::size_t{1}));
    for (std::size_t t = 0; t < slots_.size() + kAhead; ++t) {
      if (t < slots_.size()) {
        slots_[t] = static_cast<std::uint32_t>(hash(points_of(mesh, mesh.triangles[t])) & (slot_count - 1));
        prefetch(word_of(t));
      }
      if (t >= kAhead) count(t - kAhead);
    }
  }

  // Fastest in ascending order.
  bool has(std::size_t triangle) const {
    if (triangle + kAhead < slots_.size()) prefetch(word_of(triangle + kAhead));
    return (word_of(triangle) >> shift_of(triangle) & kAgain) != 0;
  }

 private:
  static constexpr std::size_t kMaxSlots = std::size_t{1} << 32, kSlotsOfWord = 32, kAhead = 32;
  static constexpr std::uint64_t kOnce = 1, kAgain = 2;

  void count(std::size_t triangle) {
    std::uint64_t& word = word_of(triangle);
    const std::uint64_t was_there = word >> shift_of(triangle) & kOnce;
    word |= (kOnce | was_there * kAgain) << shift_of(triangle);
  }
  std::uint64_t& word_of(std::size_t triangle) { return bits_[slots_[triangle] / kSlotsOfWord]; }
  const std::uint64_t& word_of(std::size_t triangle) const { return bits_[slots_[triangle] / kSlotsOfWord]; }
  unsigned shift_of(std::size_t triangle) const { return slots_[triangle] % kSlotsOfWord * 2; }

  std::vector<std::uint32_t> slots_;  // of each triangle, from its hash
  std::vector<std::uint64_t> bits_;   // two for each slot: kOnce, kAgain
};

// A set of triangles, compared by position.
class KeptTriangles {
 public:
  // Returns false if an equal one exists.
  bool add(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& triangle) {
    return points_.insert(points_of(mesh, triangle)).second;
  }

 private:
  struct Hash {
    std::size_t operator()(const Points& points) const { return hash(points); }
  };

  std::unordered_set<Points, Hash> points_;
};

bool has_area(const MeshDescription& mesh, const std::array<std::uint32_t, 3>& t) {
  return area_normal(mesh.positions[t[0]], mesh.positions[t[1]], mesh.positions[t[2]]) != AreaNormal{};
}

}  // namespace

std::size_t remove_superfluous_triangles(MeshDescription& mesh) {
  const PossibleTwins twins(mesh);
  KeptTriangles kept;
  const bool one_material = mesh.triangle_materials.size() == 1;
  std::size_t count = 0, flat = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const auto triangle = mesh.triangles[t];
    const bool is_flat = !has_area(mesh, triangle);
    flat += is_flat ? 1 : 0;
    if (is_flat || (twins.has(t) && !kept.add(mesh, triangle))) continue;
    mesh.triangles[count] = triangle;
    if (!one_material) mesh.triangle_materials[count] = mesh.triangle_materials[t];
    ++count;
  }
  mesh.triangles.resize(count);
  if (!one_material) mesh.triangle_materials.resize(count);
  return flat;
}

}  // namespace tessera::core
