// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/lens_lights.hpp"

#include <utility>
#include <vector>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/path_weights.hpp"

namespace tessera::core::integrators {
namespace {

// Of the lens that lamps fill when a point in focus projects them onto it: a single lamp that is sampled, and
// all those of one point in focus. What fills more is found often enough from points of the lens.
constexpr float kMaxShareOfLamp = 1.0f / 16, kMaxShareOfAll = 0.25f;

bool is_small(const lights::LightBounds& bounds, const Camera& camera) {
  const Vec3 middle = bounds.box().lower * 0.5f + bounds.box().upper * 0.5f;
  const float share =
      camera.share_of_lens(static_cast<float>(bounds.area()), middle, length(bounds.box().upper - middle));
  return share > 0 && share <= kMaxShareOfLamp;
}

// The lens fills the solid angle 1 / lens_pdf() at the focus.
bool pays(const lights::LightsInCone& lights, const Camera& camera, const DoubleCone& cone) {
  return !lights.empty() &&
         lights.solid_angle() * static_cast<double>(camera.lens_pdf(cone.axis)) <= double{kMaxShareOfAll};
}

}  // namespace

LensLights::LensLights(const Scene& scene, int threads) : scene_(&scene) {
  // Connections to the lens take hidden surfaces for opaque.
  if (!scene.camera().has_lens() || scene.hides_surfaces()) return;
  std::vector<lights::LightTree::Item> small;
  for (std::uint32_t i = 0; i < scene.lights().size(); ++i) {
    if (is_delta(scene.lights()[i])) continue;
    const auto of_light = bounds(scene.lights()[i]);
    if (of_light && is_small(*of_light, scene.camera())) small.push_back({*of_light, i});
  }
  tree_ = lights::LightTree::build(std::move(small), threads);
}

std::optional<LensLights::Connection> LensLights::connect(Heuristic heuristic, Vec3 focus, float time,
                                                          const std::array<float, 4>& u) const {
  return scene_->with_camera(
      time, [&](const Camera& camera) { return connect(camera, heuristic, focus, time, u); });
}

std::optional<LensLights::Connection> LensLights::connect(const Camera& camera, Heuristic heuristic,
                                                          Vec3 focus, float time,
                                                          const std::array<float, 4>& u) const {
  const DoubleCone cone = camera.lens_cone(focus);
  const lights::LightsInCone lights(tree_, cone);
  if (!pays(lights, camera, cone)) return std::nullopt;
  const auto [light, pmf] = lights.sample(combine_uniforms(u[2], u[3]));
  if (light == lights::kNoLight) return std::nullopt;
  const auto sample = scene_->with_area_light(light, time, [&](const lights::AreaLight& area) {
    return area.sample_along(scene_->textures(), focus, camera.forward(), {u[0], u[1]});
  });
  if (!sample) return std::nullopt;
  const auto lens = camera.lens_point(focus, sample->wi);
  if (!lens || !(dot(sample->point->position - *lens, sample->wi) > 0)) return std::nullopt;
  const float by_light = pmf * sample->pdf, by_lens = camera.lens_pdf(sample->wi);
  const float weight = mis_weight(heuristic, by_light, by_lens) * (by_lens / by_light);
  const Vec3 end = offset_origin(*sample->point, *lens - sample->point->position);
  return Connection{{*lens, end - *lens, 1, time}, sample->radiance * weight, light};
}

float LensLights::weight(Heuristic heuristic, const Found& found) const {
  if (!tree_.contains(found.light)) return 1;
  return scene_->with_camera(found.time, [&](const Camera& camera) {
    const DoubleCone cone = camera.lens_cone(found.focus);
    const lights::LightsInCone lights(tree_, cone);
    if (!pays(lights, camera, cone)) return 1.0f;
    return mis_weight(heuristic, camera.lens_pdf(found.direction), lights.pmf(found.light) * found.light_pdf);
  });
}

}  // namespace tessera::core::integrators
