// SPDX-License-Identifier: Apache-2.0
// Samples per second of whole renders, one thread, for every shipped scene and strategy.
#include <benchmark/benchmark.h>

#include <string>

#include "core/integrators/render.hpp"
#include "core/scene/loader/loader.hpp"

namespace tessera::core {
namespace {

void render_scene(benchmark::State& state, const std::string& name, Integrator integrator) {
  auto description = load_scene_file(std::string(TESSERA_SCENES_DIR "/") + name + "/scene.json");
  if (!description) return state.SkipWithError(description.error().message.c_str());
  const auto scene = Scene::build(*std::move(description), 1);
  if (!scene) return state.SkipWithError(scene.error().message.c_str());
  RenderSettings settings = scene->settings();
  settings.integrator = integrator;
  const PixelRect image{0, 0, settings.width_px, settings.height_px};
  const integrators::RenderPlan plan = integrators::prepare(*scene, settings, 1);

  RenderCounters counters;
  std::uint32_t sample = 0;
  for (auto _ : state) {
    counters.add(render(plan, image, {sample, sample + 1}, 1).counters);
    ++sample;
  }
  const auto rate = [&](std::uint64_t count) {
    return benchmark::Counter(static_cast<double>(count), benchmark::Counter::kIsRate);
  };
  state.counters["samples/s"] = rate(counters.samples);
  state.counters["rays/s"] = rate(counters.closest_hit_rays + counters.shadow_rays);
}

BENCHMARK_CAPTURE(render_scene, cornell_mis, "cornell", Integrator::kMis)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, cornell_nee, "cornell", Integrator::kNee)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, cornell_naive, "cornell", Integrator::kNaive)->Unit(benchmark::kMillisecond);
BENCHMARK_CAPTURE(render_scene, still_life_mis, "still_life", Integrator::kMis)
    ->Unit(benchmark::kMillisecond);

}  // namespace
}  // namespace tessera::core
