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
      : soup(blob_on_plane(rows)), primitives(soup.primitives()), bvh(Bvh::build(primitives, 1)) {
    rays = make_rays(soup, primitives, bvh, 512);
  }
  Soup soup;
  Primitives primitives;
  Bvh bvh;
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

template <typename Answer, typename Query>
void trace(benchmark::State& state, std::vector<Ray> RaySets::*kind, std::size_t batch, const Query& query) {
  const Fixture& f = fixture(static_cast<int>(state.range(0)));
  const std::span<const Ray> rays(f.rays.*kind);
  std::vector<Answer> answers(kBatch);
  for (auto _ : state) {
    for (std::size_t i = 0; i < rays.size(); i += batch) {
      const std::size_t count = std::min(batch, rays.size() - i);
      query(f, rays.subspan(i, count), std::span(answers).first(count));
      benchmark::DoNotOptimize(answers.data());
    }
  }
  state.counters["triangles"] = static_cast<double>(f.primitives.count());
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(rays.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

void closest_in_batches(benchmark::State& state, std::vector<Ray> RaySets::*kind) {
  trace<Hit>(state, kind, kBatch, [](const Fixture& f, std::span<const Ray> rays, std::span<Hit> hits) {
    f.bvh.closest_hits(f.primitives, rays, hits);
  });
}
void closest_one_by_one(benchmark::State& state, std::vector<Ray> RaySets::*kind) {
  trace<Hit>(state, kind, 1, [](const Fixture& f, std::span<const Ray> ray, std::span<Hit> hit) {
    hit[0] = f.bvh.closest_hit(f.primitives, ray[0]);
  });
}

void growth_primary_batched(benchmark::State& state) {
  closest_in_batches(state, &RaySets::primary);
}
void growth_bounce_batched(benchmark::State& state) {
  closest_in_batches(state, &RaySets::bounce);
}
void growth_shadow_batched(benchmark::State& state) {
  trace<std::uint8_t>(state, &RaySets::shadow, kBatch,
                      [](const Fixture& f, std::span<const Ray> rays, std::span<std::uint8_t> occluded) {
                        f.bvh.any_hits(f.primitives, rays, occluded);
                      });
}
void growth_primary_single(benchmark::State& state) {
  closest_one_by_one(state, &RaySets::primary);
}
void growth_bounce_single(benchmark::State& state) {
  closest_one_by_one(state, &RaySets::bounce);
}
void growth_shadow_single(benchmark::State& state) {
  trace<std::uint8_t>(state, &RaySets::shadow, 1,
                      [](const Fixture& f, std::span<const Ray> ray, std::span<std::uint8_t> occluded) {
                        occluded[0] = f.bvh.any_hit(f.primitives, ray[0]);
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
