// The time for each ray against the number of triangles, one thread: what bench/growth/measure.sh plots.
#include <benchmark/benchmark.h>

#include <memory>
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

// Kept until another is asked for, since each benchmark is called several times.
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

template <typename Query>
void trace(benchmark::State& state, std::vector<Ray> RaySets::*kind, Query query) {
  const Fixture& f = fixture(static_cast<int>(state.range(0)));
  const std::vector<Ray>& rays = f.rays.*kind;
  for (auto _ : state)
    for (const Ray& ray : rays) benchmark::DoNotOptimize(query(f, ray));
  state.counters["triangles"] = static_cast<double>(f.primitives.count());
  state.counters["rays/s"] =
      benchmark::Counter(static_cast<double>(rays.size()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

constexpr auto kClosest = [](const Fixture& f, const Ray& ray) {
  return f.bvh.closest_hit(f.primitives, ray);
};
constexpr auto kAny = [](const Fixture& f, const Ray& ray) { return f.bvh.any_hit(f.primitives, ray); };

void growth_primary(benchmark::State& state) {
  trace(state, &RaySets::primary, kClosest);
}
void growth_bounce(benchmark::State& state) {
  trace(state, &RaySets::bounce, kClosest);
}
void growth_shadow(benchmark::State& state) {
  trace(state, &RaySets::shadow, kAny);
}

// From a hundred triangles to ten million.
void sizes(benchmark::internal::Benchmark* benchmark) {
  for (const int rows : {5, 16, 50, 158, 500, 1581}) benchmark->Arg(rows);
  benchmark->Unit(benchmark::kMillisecond);
}
BENCHMARK(growth_primary)->Apply(sizes);
BENCHMARK(growth_bounce)->Apply(sizes);
BENCHMARK(growth_shadow)->Apply(sizes);

}  // namespace
}  // namespace tessera::core
