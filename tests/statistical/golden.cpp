// SPDX-License-Identifier: Apache-2.0
#include "tests/statistical/golden.hpp"

#include <vector>

#include "core/integrators/render.hpp"
#include "core/integrators/render_plan.hpp"

namespace tessera::test {
namespace {

core::RenderSettings settings_of(const core::Scene& scene) {
  core::RenderSettings settings = scene.settings();
  settings.width_px = kGoldenWidthPx;
  settings.height_px = kGoldenHeightPx;
  settings.spp = kGoldenSpp;
  return settings;
}

std::vector<double> render_batch(const core::integrators::RenderPlan& plan, std::uint64_t seed) {
  core::RenderSettings settings = plan.settings();
  settings.seed = seed;
  const auto tile = core::integrators::render(plan.with(settings), {0, 0, kGoldenWidthPx, kGoldenHeightPx},
                                              {0, kGoldenSpp}, 2);
  std::vector<double> radiance;
  for (const std::uint64_t sum : tile.sums)
    radiance.push_back(static_cast<double>(sum) * core::kFilmUnit / kGoldenSpp);
  return radiance;
}

core::Image to_image(const std::vector<double>& values) {
  core::Image image(kGoldenWidthPx, kGoldenHeightPx);
  for (std::size_t i = 0; i < image.pixels.size(); ++i)
    image.pixels[i] = {static_cast<float>(values[3 * i]), static_cast<float>(values[3 * i + 1]),
                       static_cast<float>(values[3 * i + 2])};
  return image;
}

}  // namespace

Golden render_golden(const core::Scene& scene, std::uint64_t first_seed, int batches) {
  const std::size_t count = std::size_t{3} * kGoldenWidthPx * kGoldenHeightPx;
  std::vector<double> mean(count), squares(count), variance(count);
  const core::integrators::RenderPlan plan = core::integrators::prepare(scene, settings_of(scene), 2);
  for (int batch = 0; batch < batches; ++batch) {
    const auto radiance = render_batch(plan, first_seed + static_cast<std::uint64_t>(batch));
    for (std::size_t i = 0; i < count; ++i) {  // Welford 1962
      const double before = radiance[i] - mean[i];
      mean[i] += before / (batch + 1);
      squares[i] += before * (radiance[i] - mean[i]);
    }
  }
  for (std::size_t i = 0; i < count; ++i) variance[i] = batches > 1 ? squares[i] / (batches - 1) : 0;
  return {to_image(mean), to_image(variance), batches};
}

std::string golden_mean_path(const std::string& name) {
  return TESSERA_SOURCE_DIR "/tests/golden/" + name + ".exr";
}

std::string golden_variance_path(const std::string& name) {
  return TESSERA_SOURCE_DIR "/tests/golden/" + name + "_variance.exr";
}

}  // namespace tessera::test
