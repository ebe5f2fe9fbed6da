// SPDX-License-Identifier: Apache-2.0
// Rays per second through the acceleration structure, single-threaded: a tessellated, bumpy sphere on a
// plane, with primary rays, cosine-distributed bounces from their hits, and shadow rays to a lamp; and the
// time to build it.
#include <benchmark/benchmark.h>

#include <vector>

#include "bench/soups.hpp"

namespace tessera::core {
namespace {

struct Fixture {
  explicit Fixture(int rows)
      : soup(blob_on_plane(rows)),
        primitives(soup.primitives()),
        bvh(accel::Bvh::build(primitives, 1)),
        rays(make_rays(soup, primitives, bvh, 512)) {}
  Soup soup;
  Primitives primitives;
  accel::Bvh bvh;
  RaySets rays;
};

template <typename Query>
void trace(benchmark::State& state, const std::vector<Ray>& rays, Query query) {
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(query(ray));
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(rays.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

void closest_primary(benchmark::State& state) {
  const Fixture f(static_cast<int>(state.range(0)));
  trace(state, f.rays.primary, [&](const Ray& ray) { return f.bvh.closest_hit(f.primitives, ray); });
}
void closest_bounce(benchmark::State& state) {
  const Fixture f(static_cast<int>(state.range(0)));
  trace(state, f.rays.bounce, [&](const Ray& ray) { return f.bvh.closest_hit(f.primitives, ray); });
}
void any_shadow(benchmark::State& state) {
  const Fixture f(static_cast<int>(state.range(0)));
  trace(state, f.rays.shadow, [&](const Ray& ray) { return f.bvh.any_hit(f.primitives, ray); });
}
// The nearest hit by testing every primitive, as a baseline.
void closest_primary_without_bvh(benchmark::State& state) {
  Fixture f(static_cast<int>(state.range(0)));
  std::vector<Ray> some;
  for (std::size_t i = 0; i < f.rays.primary.size(); i += 4096) some.push_back(f.rays.primary[i]);
  trace(state, some, [&](const Ray& ray) {
    Hit hit;
    for (std::uint32_t p = 0; p < f.primitives.count(); ++p) f.primitives.intersect(p, ray, hit);
    return hit;
  });
}
void build(benchmark::State& state) {
  const Primitives primitives = blob_on_plane(static_cast<int>(state.range(0))).primitives();
  for (auto _ : state) benchmark::DoNotOptimize(accel::Bvh::build(primitives, 1));
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(primitives.count()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

// 40,000 and 1,000,000 triangles; and 137,000, with the structure and without.
BENCHMARK(closest_primary)->Arg(100)->Arg(185)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(closest_primary_without_bvh)->Arg(185)->Unit(benchmark::kMillisecond);
BENCHMARK(closest_bounce)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(any_shadow)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(build)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera::core
