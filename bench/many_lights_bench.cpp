// SPDX-License-Identifier: Apache-2.0
// Measures the cost and benefit of light sampling: a hall full of small lamps, lit directly, where lamps
// are chosen by the scene's light sampler or by power alone. Prints a table.
//
// Run build/<preset>/bin/many_lights_bench [MAX]; single-threaded, with at most MAX lights (100,000).
#include <benchmark/benchmark.h>
#include <fmt/core.h>

#include <algorithm>
#include <array>
#include <cstdlib>
#include <ctime>
#include <string>
#include <utility>
#include <vector>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/render.hpp"
#include "core/integrators/vertex.hpp"
#include "core/math/frame.hpp"
#include "core/sampling/distribution.hpp"
#include "core/sampling/sampler.hpp"
#include "core/sampling/warp.hpp"

namespace tessera::core {
namespace {

constexpr int kSidePx = 64, kSamples = 64;

double cpu_seconds() {
  timespec now{};
  clock_gettime(CLOCK_PROCESS_CPUTIME_ID, &now);
  return static_cast<double>(now.tv_sec) + 1e-9 * static_cast<double>(now.tv_nsec);
}

std::array<float, 4> numbers(int index, std::uint32_t kind) {
  return sampling::Sampler(3, index, 0, 0).pad(kind);
}

// A facet around `center`.
void add_triangle(MeshDescription& mesh, Vec3 center, float size, const std::array<float, 4>& u) {
  const Frame frame = Frame::around(sampling::sample_sphere({u[0], u[1]}));
  const auto first = static_cast<std::uint32_t>(mesh.positions.size());
  mesh.positions.push_back(center + frame.tangent * size);
  mesh.positions.push_back(center + frame.bitangent * size);
  mesh.positions.push_back(center - (frame.tangent + frame.bitangent) * size);
  mesh.triangles.push_back({first, first + 1, first + 2});
}

// A hall of 100 x 100 metres, 8 high, with lamps of ten strengths below its ceiling and between its pillars.
SceneDescription hall(int lamps, int facets_per_lamp) {
  SceneDescription scene;
  scene.settings = {.width_px = kSidePx, .height_px = kSidePx, .spp = 16};
  scene.camera = {.position = {-45, 5, -45}, .look_at = {0, 2, 0}, .vertical_fov_degrees = 60};
  scene.materials = {{.name = "wall", .model = Lambert{{Rgb::gray(0.5f)}}}};
  for (int i = 0; i < 10; ++i)
    scene.materials.push_back({.name = "lamp" + std::to_string(i),
                               .model = Lambert{{Rgb::gray(0)}},
                               .emission = {Rgb::gray(1 + static_cast<float>(i * i))}});
  const Vec3 x{100, 0, 0}, y{0, 8, 0}, z{0, 0, 100}, corner{-50, 0, -50};
  for (const QuadDescription& quad : {QuadDescription{corner, z, x, 0}, QuadDescription{corner + y, x, z, 0},
                                      QuadDescription{corner, x, y, 0}, QuadDescription{corner + z, y, x, 0},
                                      QuadDescription{corner, y, z, 0}, QuadDescription{corner + x, z, y, 0}})
    scene.shapes.emplace_back(quad);
  for (int i = 0; i < 64; ++i)
    scene.shapes.emplace_back(
        QuadDescription{{static_cast<float>(i % 8) * 12 - 44, 0, static_cast<float>(i / 8) * 12 - 44},
                        {1.5f, 0, 1.5f},
                        y,
                        0});
  for (int i = 0; i < lamps; ++i) {
    const auto u = numbers(i, 0);
    const Vec3 place{u[0] * 98 - 49, 0.5f + u[1] * 7, u[2] * 98 - 49};
    MeshDescription mesh;
    for (int facet = 0; facet < facets_per_lamp; ++facet) {
      const auto v = numbers(facet, static_cast<std::uint32_t>(1 + i));
      const Vec3 offset = facets_per_lamp > 1 ? sampling::sample_sphere({v[2], v[3]}) * 0.1f : Vec3{};
      add_triangle(mesh, place + offset, facets_per_lamp > 1 ? 0.01f : 0.03f, v);
    }
    mesh.triangle_materials = {static_cast<std::uint32_t>(1 + i % 10)};
    scene.shapes.emplace_back(std::move(mesh));
  }
  scene.shape_names.assign(scene.shapes.size(), "lamp");
  return scene;
}

struct Estimate {
  double seconds = 0, relative_mse = 0;  // of one sample at each point, averaged over all points

  double cost() const { return seconds * relative_mse; }
};

// Direct light at the visible points, with lights chosen by choose(point, u): kSamples samples at each
// point.
template <typename Choose>
Estimate estimate(const Scene& scene, const std::vector<integrators::PathVertex>& vertices,
                  const Choose& choose) {
  std::vector<double> sums(vertices.size()), squares(vertices.size());
  const double start = cpu_seconds();
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const integrators::PathVertex& vertex = vertices[v];
    for (std::uint32_t s = 0; s < kSamples; ++s) {
      // Not stratified, so that the variance of the samples estimates the error of one.
      const auto u = sampling::Sampler(9, static_cast<int>(v), static_cast<int>(s), 0).pad(0);
      const auto choice = choose(vertex.light_context(), integrators::combine_uniforms(u[2], u[3]));
      if (choice.light == lights::kNoLight) continue;
      const auto light =
          sample_light(scene.lights()[choice.light], scene.textures(), vertex.light_context(), {u[0], u[1]});
      if (!light) continue;
      const Rgb scattered = vertex.evaluate(light->wi).value;
      if (is_black(scattered) || scene.occlusion(vertex.ray_toward(*light)) != accel::Occlusion::kNone)
        continue;
      const auto value = static_cast<double>(mean(scattered * light->radiance) / (choice.pmf * light->pdf));
      sums[v] += value;
      squares[v] += value * value;
    }
  }
  Estimate result;
  result.seconds = (cpu_seconds() - start) / static_cast<double>(vertices.size() * kSamples);
  double total = 0, variance = 0;
  for (std::size_t v = 0; v < vertices.size(); ++v) {
    const double mean_value = sums[v] / kSamples;
    total += mean_value * mean_value;
    variance += std::max(0.0, squares[v] / kSamples - mean_value * mean_value) * kSamples / (kSamples - 1);
  }
  result.relative_mse = variance / total;
  return result;
}

// Measures the choice alone.
template <typename Choose>
double seconds_per_choice(const std::vector<integrators::PathVertex>& vertices, const Choose& choose) {
  const double start = cpu_seconds();
  for (const integrators::PathVertex& vertex : vertices)
    for (int s = 0; s < kSamples; ++s) {
      const auto u = numbers(s, 0);
      benchmark::DoNotOptimize(choose(vertex.light_context(), integrators::combine_uniforms(u[0], u[1])));
    }
  return (cpu_seconds() - start) / static_cast<double>(vertices.size() * kSamples);
}

std::vector<integrators::PathVertex> visible_vertices(const Scene& scene) {
  std::vector<integrators::PathVertex> vertices;
  for (int y = 0; y < kSidePx; ++y)
    for (int x = 0; x < kSidePx; ++x) {
      const Ray ray = scene.camera().ray({static_cast<float>(x) + 0.5f, static_cast<float>(y) + 0.5f},
                                         kSidePx, kSidePx, {0.5f, 0.5f});
      const Hit hit = scene.closest_hit(ray);
      if (hit.found() && scene.light_of(hit) == lights::kNoLight) vertices.emplace_back(scene, ray, hit);
    }
  return vertices;
}

void measure(int lamps, int facets_per_lamp) {
  SceneDescription description = hall(lamps, facets_per_lamp);
  const Scene scene = Scene::build(std::move(description), 1).value();
  double start = cpu_seconds();
  const lights::LightSampler sampler(scene.lights(), lights::LightSampler::Among::kAll, 1);
  const double build = cpu_seconds() - start;

  std::vector<double> powers;
  for (const lights::Light& light : scene.lights()) powers.push_back(power(light, 1));
  const sampling::DiscreteDistribution by_power(powers);
  const auto vertices = visible_vertices(scene);
  const auto tree_choice = [&](const lights::LightSampleContext& point, double u) {
    return sampler.sample(point, u);
  };
  const auto power_choice = [&](const lights::LightSampleContext&, double u) {
    const auto light = static_cast<std::uint32_t>(by_power.sample(u));
    return lights::LightSampler::Choice{light, by_power.pmf(light)};
  };
  const Estimate tree = estimate(scene, vertices, tree_choice);
  const Estimate power_alone = estimate(scene, vertices, power_choice);

  const integrators::RenderPlan plan = integrators::prepare(scene, scene.settings(), 1);
  start = cpu_seconds();
  const FilmTile tile = render(plan, {0, 0, kSidePx, kSidePx}, {0, scene.settings().spp}, 1);
  const double per_sample = (cpu_seconds() - start) / static_cast<double>(tile.counters.samples);
  fmt::print("| {} | {} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.0f} | {:.2f} | {:.2f} | {:.2f} | {:.1f} |\n",
             scene.lights().size(), lamps, build * 1e3, seconds_per_choice(vertices, tree_choice) * 1e9,
             seconds_per_choice(vertices, power_choice) * 1e9, tree.seconds * 1e9, power_alone.seconds * 1e9,
             per_sample * 1e6, tree.relative_mse, power_alone.relative_mse, power_alone.cost() / tree.cost());
}

}  // namespace
}  // namespace tessera::core

int main(int argc, char** argv) {
  const int most = argc > 1 ? std::atoi(argv[1]) : 100000;
  fmt::print(
      "| lights | lamps | tree built in (ms) | choice by the tree (ns) | by power | direct light by the tree "
      "(ns "
      "a sample) | by power | path traced (us a sample) | relative MSE by the tree | by power | gain at "
      "equal "
      "time |\n"
      "|---|---|---|---|---|---|---|---|---|---|---|\n");
  for (int lamps = 1; lamps <= most; lamps *= 10) tessera::core::measure(lamps, 1);
  if (most >= 100000) tessera::core::measure(1000, 300);
  return 0;
}
