#include "core/lights/light.hpp"

#include "core/base/overloaded.hpp"

namespace tessera::core {

std::optional<LightSample> sample_light(const Light& light, const std::vector<Texture>& textures, Vec3 p_lit,
                                        Vec2 u) {
  return std::visit(Overloaded{
                        [&](const AreaLight& area) { return area.sample(textures, p_lit, u); },
                        [&](const PointLight& point) { return point.sample(p_lit); },
                        [&](const SpotLight& spot) { return spot.sample(p_lit); },
                        [&](const DirectionalLight& directional) { return directional.sample(); },
                        [&](const Environment& environment) { return environment.sample(u); },
                    },
                    light);
}

bool is_delta(const Light& light) {
  return !std::holds_alternative<AreaLight>(light) && !std::holds_alternative<Environment>(light);
}

double power(const Light& light, double scene_radius) {
  return std::visit(Overloaded{
                        [&](const AreaLight& area) { return area.power(); },
                        [&](const PointLight& point) { return point.power(); },
                        [&](const SpotLight& spot) { return spot.power(); },
                        [&](const DirectionalLight& directional) { return directional.power(scene_radius); },
                        [&](const Environment& environment) { return environment.power(scene_radius); },
                    },
                    light);
}

std::optional<LightBounds> bounds(const Light& light) {
  using Bounds = std::optional<LightBounds>;
  return std::visit(Overloaded{
                        [](const AreaLight& area) -> Bounds { return area.bounds(); },
                        [](const PointLight& point) -> Bounds { return point.bounds(); },
                        [](const SpotLight& spot) -> Bounds { return spot.bounds(); },
                        [](const DirectionalLight&) -> Bounds { return std::nullopt; },
                        [](const Environment&) -> Bounds { return std::nullopt; },
                    },
                    light);
}

}  // namespace tessera::core
