// SPDX-License-Identifier: Apache-2.0
// Time per ray as a function of the number of triangles, single-threaded, in batches and one by one;
// bench/growth/measure.sh plots it.
#include <benchmark/benchmark.h>

#include <algorithm>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "bench/soups.hpp"

namespace tessera::core {
namespace {

struct Fixture {
  explicit Fixture(int rows)
      : soup(blob_on_plane(rows)), primitives(soup.primitives()), bvh(accel::Bvh::build(primitives, 1)) {
    rays = make_rays(soup, primitives, bvh, 512);
  }
  Soup soup;
  Primitives primitives;
  accel::Bvh bvh;
  RaySets rays;
};

// Cached until another scene is requested, because each benchmark is called several times.
const Fixture& fixture(int rows) {
  static std::unique_ptr<const Fixture> last;
  static int rows_of_last = 0;
  if (rows != rows_of_last) {
    last.reset();
    last = std::make_unique<const Fixture>(rows);
    rows_of_last = rows;
  }
  return *last;
}

// The batch size of a renderer with this many active paths.
constexpr std::size_t kBatch = 1024;

// Calls query(fixture, rays, answers) for a batch after the other.
template <typename Answers, typename Query>
void trace(benchmark::State& state, std::vector<Ray> RaySets::*kind, std::size_t batch, Answers answers,
           const Query& query) {
  const Fixture& f = fixture(static_cast<int>(state.range(0)));
  const Columns<Ray> rays{std::span<const Ray>(f.rays.*kind)};
  for (auto _ : state) {
    for (std::size_t i = 0; i < rays.size(); i += batch) {
      const std::size_t count = std::min(batch, rays.size() - i);
      query(f, rays.all().rows(i, count), answers);
    }
  }
  state.counters["triangles"] = static_cast<double>(f.primitives.count());
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(rays.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

void closest_in_batches(benchmark::State& state, std::vector<Ray> RaySets::*kind) {
  trace(state, kind, kBatch, Columns<Hit>(kBatch),
        [](const Fixture& f, ColumnsView<const Ray> rays, Columns<Hit>& hits) {
          f.bvh.closest_hits(f.primitives, rays, hits.all().rows(0, rays.size()));
        });
}
void closest_one_by_one(benchmark::State& state, std::vector<Ray> RaySets::*kind) {
  trace(state, kind, 1, Hit(), [](const Fixture& f, ColumnsView<const Ray> ray, Hit& hit) {
    benchmark::DoNotOptimize(hit = f.bvh.closest_hit(f.primitives, ray[0]));
  });
}

void growth_primary_batched(benchmark::State& state) {
  closest_in_batches(state, &RaySets::primary);
}
void growth_bounce_batched(benchmark::State& state) {
  closest_in_batches(state, &RaySets::bounce);
}
void growth_shadow_batched(benchmark::State& state) {
  trace(state, &RaySets::shadow, kBatch, std::vector<accel::Occlusion>(kBatch),
        [](const Fixture& f, ColumnsView<const Ray> rays, std::vector<accel::Occlusion>& occluded) {
          f.bvh.occlusions(f.primitives, rays, std::span(occluded).first(rays.size()));
          benchmark::DoNotOptimize(occluded.data());
        });
}
void growth_primary_single(benchmark::State& state) {
  closest_one_by_one(state, &RaySets::primary);
}
void growth_bounce_single(benchmark::State& state) {
  closest_one_by_one(state, &RaySets::bounce);
}
void growth_shadow_single(benchmark::State& state) {
  trace(state, &RaySets::shadow, 1, false, [](const Fixture& f, ColumnsView<const Ray> ray, bool& occluded) {
    benchmark::DoNotOptimize(occluded = f.bvh.any_hit(f.primitives, ray[0]));
  });
}

// From a hundred triangles to ten million.
void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int rows : {5, 16, 50, 158, 500, 1581}) benchmark->Arg(rows);
  benchmark->Unit(benchmark::kMillisecond);
}
BENCHMARK(growth_primary_batched)->Apply(sizes);
BENCHMARK(growth_bounce_batched)->Apply(sizes);
BENCHMARK(growth_shadow_batched)->Apply(sizes);
BENCHMARK(growth_primary_single)->Apply(sizes);
BENCHMARK(growth_bounce_single)->Apply(sizes);
BENCHMARK(growth_shadow_single)->Apply(sizes);

}  // namespace
}  // namespace tessera::core
