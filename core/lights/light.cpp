// SPDX-License-Identifier: Apache-2.0
#include "core/lights/light.hpp"

#include <algorithm>
#include <bit>

#include "core/base/overloaded.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::lights {
namespace {

// Light samples that are computed one by one.
class SampleLanes {
 public:
  void set(std::size_t lane, const LightSample& sample) {
    const unsigned bit = 1u << lane;
    found_ |= bit;
    wi_.set(lane, sample.wi);
    radiance_.set(lane, sample.radiance);
    pdf_.set(lane, sample.pdf);
    if (sample.delta) delta_ |= bit;
    if (!sample.point) {
      distant_ |= bit;
      return;
    }
    position_.set(lane, sample.point->position);
    position_error_.set(lane, sample.point->position_error);
    geometric_normal_.set(lane, sample.point->geometric_normal);
  }

  // Overwrites the lanes that have been set.
  void merge_into(LightSamples& all) const {
    const MaskN mine = MaskN::from_bits(found_);
    all.found = all.found | mine;
    all.wi = select(mine, wi_.all(), all.wi);
    all.radiance = select(mine, radiance_.all(), all.radiance);
    all.pdf = select(mine, pdf_.all(), all.pdf);
    all.delta = all.delta | MaskN::from_bits(delta_);
    all.distant = all.distant | MaskN::from_bits(distant_);
    all.point.position = select(mine, position_.all(), all.point.position);
    all.point.position_error = select(mine, position_error_.all(), all.point.position_error);
    all.point.geometric_normal = select(mine, geometric_normal_.all(), all.point.geometric_normal);
  }

 private:
  unsigned found_ = 0, delta_ = 0, distant_ = 0;  // bit i for lane i
  Vec3Lanes wi_{}, position_{}, position_error_{}, geometric_normal_{};
  RgbLanes radiance_{};
  FloatLanes pdf_{};
};

// Copies the found samples of `lanes` to `all`.
void take_lanes(LightSamples& all, const LightSamples& others, MaskN lanes) {
  const MaskN mine = lanes & others.found;
  all.found = all.found | mine;
  all.wi = select(mine, others.wi, all.wi);
  all.radiance = select(mine, others.radiance, all.radiance);
  all.pdf = select(mine, others.pdf, all.pdf);
  all.distant = all.distant | (mine & others.distant);
  all.point.position = select(mine, others.point.position, all.point.position);
  all.point.position_error = select(mine, others.point.position_error, all.point.position_error);
  all.point.geometric_normal = select(mine, others.point.geometric_normal, all.point.geometric_normal);
}

// Lights that are sampled together, one in each lane.
class AreaLights {
 public:
  void set(std::size_t lane, const AreaLight* light) {
    lights_[lane] = some_ = light;
    lanes_ |= 1u << lane;
  }
  bool empty() const { return lanes_ == 0; }
  MaskN lanes() const { return MaskN::from_bits(lanes_); }
  // Fills unset lanes with a light of the set.
  const std::array<const AreaLight*, kLaneCount>& filled() {
    std::replace(lights_.begin(), lights_.end(), static_cast<const AreaLight*>(nullptr), some_);
    return lights_;
  }

 private:
  std::array<const AreaLight*, kLaneCount> lights_{};
  const AreaLight* some_ = nullptr;
  unsigned lanes_ = 0;
};

}  // namespace

std::optional<LightSample> sample_light(const Light& light, const std::vector<Texture>& textures,
                                        const LightSampleContext& lit, Vec2 u, MisCompensation compensation,
                                        float time) {
  return std::visit(
      Overloaded{
          [&](const AreaLight& area) { return area.sample(textures, lit.position, u); },
          [&](const MovingAreaLight& area) { return area.at(time).sample(textures, lit.position, u); },
          [&](const PointLight& point) { return point.sample(lit.position); },
          [&](const SpotLight& spot) { return spot.sample(textures, lit.position); },
          [&](const DirectionalLight& directional) { return directional.sample(); },
          [&](const Environment& environment) { return environment.sample(lit.normal, u, compensation); },
      },
      light);
}

LightSamples sample_lights(const std::array<const Light*, 8>& lights, const std::vector<Texture>& textures,
                           const LightSampleContexts& lit, Vec2Of<FloatN> u, MisCompensation compensation,
                           FloatN time) {
  const FloatLanes times(time);
  std::array<std::optional<AreaLight>, kLaneCount> moved;
  AreaLights quads, spheres;
  const Environment* environment = nullptr;  // a scene has at most one
  unsigned environment_lanes = 0, other_lanes = 0;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    if (!lights[lane]) continue;
    const auto* area = std::get_if<AreaLight>(lights[lane]);
    if (const auto* moving = std::get_if<MovingAreaLight>(lights[lane]))
      area = &moved[lane].emplace(moving->at(times[lane]));
    const auto* around = std::get_if<Environment>(lights[lane]);
    if (area && area->is_quad()) {
      quads.set(lane, area);
    } else if (area && area->is_uniform_sphere()) {
      spheres.set(lane, area);
    } else if (around) {
      environment = around;
      environment_lanes |= 1u << lane;
    } else {
      other_lanes |= 1u << lane;
    }
  }
  LightSamples samples;
  if (!quads.empty())
    take_lanes(samples, AreaLight::sample_quads(quads.filled(), textures, lit.position, u), quads.lanes());
  if (!spheres.empty())
    take_lanes(samples, AreaLight::sample_uniform_spheres(spheres.filled(), lit.position, u),
               spheres.lanes());
  if (environment)
    take_lanes(samples, environment->sample(lit.normal, u, compensation),
               MaskN::from_bits(environment_lanes));
  if (other_lanes == 0) return samples;
  const Vec3Lanes position(lit.position), normal(lit.normal);
  const FloatLanes u_x(u.x), u_y(u.y);
  SampleLanes others;
  for (; other_lanes != 0; other_lanes &= other_lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(other_lanes));
    const auto sample = sample_light(*lights[lane], textures, {position[lane], normal[lane]},
                                     {u_x[lane], u_y[lane]}, compensation, times[lane]);
    if (sample) others.set(lane, *sample);
  }
  others.merge_into(samples);
  return samples;
}

bool is_delta(const Light& light) {
  return !std::holds_alternative<AreaLight>(light) && !std::holds_alternative<MovingAreaLight>(light) &&
         !std::holds_alternative<Environment>(light);
}

double power(const Light& light, double scene_radius) {
  return std::visit(Overloaded{
                        [&](const AreaLight& area) { return area.power(); },
                        [&](const MovingAreaLight& area) { return area.power(); },
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
                        [](const MovingAreaLight& area) -> Bounds { return area.bounds(); },
                        [](const PointLight& point) -> Bounds { return point.bounds(); },
                        [](const SpotLight& spot) -> Bounds { return spot.bounds(); },
                        [](const DirectionalLight&) -> Bounds { return std::nullopt; },
                        [](const Environment&) -> Bounds { return std::nullopt; },
                    },
                    light);
}

}  // namespace tessera::core::lights
