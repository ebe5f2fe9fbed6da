// Rays per second through the acceleration structure alone, one thread: a tessellated, bumpy sphere on a
// plane, seen by primary rays, by cosine-distributed bounces from their hits, and by shadow rays to a lamp;
// and building it.
#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <vector>

#include "core/accel/bvh.hpp"
#include "core/math/elementary.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

Primitives bumpy_sphere(int rows) {
  const int columns = 2 * rows;
  std::vector<Vec3> positions;
  std::vector<std::array<std::uint32_t, 3>> triangles;
  for (int i = 0; i <= rows; ++i)
    for (int j = 0; j <= columns; ++j) {
      const float theta = kPi * static_cast<float>(i) / static_cast<float>(rows);
      const float phi = 2 * kPi * static_cast<float>(j) / static_cast<float>(columns);
      const float r = 1 + 0.05f * sin(9 * theta) * sin(13 * phi);
      positions.push_back({r * sin(theta) * cos(phi), r * cos(theta) + 1, r * sin(theta) * sin(phi)});
    }
  const auto vertex = [columns](int i, int j) { return static_cast<std::uint32_t>(i * (columns + 1) + j); };
  for (int i = 0; i < rows; ++i)
    for (int j = 0; j < columns; ++j) {
      triangles.push_back({vertex(i, j), vertex(i, j + 1), vertex(i + 1, j + 1)});
      triangles.push_back({vertex(i, j), vertex(i + 1, j + 1), vertex(i + 1, j)});
    }
  Primitives primitives;
  primitives.add_mesh(positions, {}, {}, triangles, {0});
  primitives.add_mesh({{-5, 0, -5}, {-5, 0, 5}, {5, 0, 5}, {5, 0, -5}}, {}, {}, {{0, 1, 2}, {0, 2, 3}}, {0});
  return primitives;
}

struct Rays {
  std::vector<Ray> primary, bounce, shadow;
};

Rays make_rays(const Primitives& primitives, const Bvh& bvh) {
  constexpr int kSide = 512;
  Rays rays;
  for (int y = 0; y < kSide; ++y)
    for (int x = 0; x < kSide; ++x) {
      const Vec3 direction{(static_cast<float>(x) - kSide / 2) / kSide,
                           (kSide / 2 - static_cast<float>(y)) / kSide - 0.2f, -1};
      const Ray ray{{0, 2, 4}, normalize(direction)};
      rays.primary.push_back(ray);
      const Hit hit = bvh.closest_hit(primitives, ray);
      if (!hit.found()) continue;
      const SurfacePoint point = primitives.surface(ray, hit);
      const auto u = Sampler(0, x, y, 0).pad(0);
      const Vec3 normal = face_toward(point.geometric_normal, -ray.direction);
      const Vec3 wi = Frame::around(normal).to_world(sample_cosine_hemisphere({u[0], u[1]}));
      rays.bounce.push_back({offset_origin(point, wi), wi});
      const Vec3 to_lamp = Vec3{2, 5, 2} + sample_sphere({u[2], u[3]}) * 0.5f - point.position;
      rays.shadow.push_back({offset_origin(point, to_lamp), to_lamp, 1});
    }
  return rays;
}

struct Fixture {
  explicit Fixture(int rows)
      : primitives(bumpy_sphere(rows)), bvh(Bvh::build(primitives, 1)), rays(make_rays(primitives, bvh)) {}
  Primitives primitives;
  Bvh bvh;
  Rays rays;
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
// The nearest hit by asking every primitive, for what the structure is worth.
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
  const Primitives primitives = bumpy_sphere(static_cast<int>(state.range(0)));
  for (auto _ : state) benchmark::DoNotOptimize(Bvh::build(primitives, 1));
  state.counters["triangles/s"] =
      benchmark::Counter(static_cast<double>(primitives.count()) * static_cast<double>(state.iterations()),
                         benchmark::Counter::kIsRate);
}

// 40,000 and 1,000,000 triangles; and 137,000, as many as the Go board of docs/report.md has, without.
BENCHMARK(closest_primary)->Arg(100)->Arg(185)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(closest_primary_without_bvh)->Arg(185)->Unit(benchmark::kMillisecond);
BENCHMARK(closest_bounce)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(any_shadow)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);
BENCHMARK(build)->Arg(100)->Arg(500)->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera::core
