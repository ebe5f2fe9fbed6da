// SPDX-License-Identifier: Apache-2.0
// Counts rays that leak out of a closed mesh: each is aimed from inside at the middle of an edge or at a
// corner, and none may pass between the triangles. Prints the count; fails unless it is 0.
//
//   tessera_leak_count [rays]
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <vector>

#include "core/accel/bvh.hpp"
#include "core/sampling/sampler.hpp"
#include "tests/unit/core_geometry/shapes.hpp"

namespace tessera::core {
namespace {

std::uint64_t count_leaks(std::uint64_t count) {
  const test::Mesh mesh = test::icosphere(5, {1, 2, 3}, 1);
  const Primitives primitives = mesh.primitives();
  const accel::Bvh bvh = accel::Bvh::build(primitives, 1);
  constexpr std::size_t kBatch = 4096;
  Columns<Ray> rays(kBatch);
  Columns<Hit> hits(kBatch);
  std::uint64_t leaks = 0;
  for (std::uint64_t done = 0; done < count; done += kBatch) {
    for (std::size_t i = 0; i < kBatch; ++i) {
      const auto u = sampling::Sampler(done, static_cast<int>(i), 0, 0).pad(0);
      const auto corner = static_cast<std::size_t>(u[3] * 6);
      const auto& triangle = mesh.triangles[(done + i * 2654435761u) % mesh.triangles.size()];
      const Vec3 a = mesh.positions[triangle[corner % 3]];
      const Vec3 b = mesh.positions[triangle[corner < 3 ? corner % 3 : (corner + 1) % 3]];
      const Vec3 origin = Vec3{1, 2, 3} + Vec3{u[0] - 0.5f, u[1] - 0.5f, u[2] - 0.5f};
      rays.set(i, {origin, 0.5f * a + 0.5f * b - origin});
    }
    bvh.closest_hits(primitives, rays.all(), hits.all());
    for (std::size_t i = 0; i < kBatch; ++i) leaks += !hits[i].found();
  }
  return leaks;
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const std::uint64_t rays = argc > 1 ? std::strtoull(argv[1], nullptr, 10) : 100'000'000;
  const std::uint64_t leaks = tessera::core::count_leaks(rays);
  std::printf("%llu of %llu rays leaked\n", static_cast<unsigned long long>(leaks),
              static_cast<unsigned long long>(rays));
  return leaks == 0 ? 0 : 1;
}
