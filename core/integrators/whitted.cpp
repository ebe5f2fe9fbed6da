// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/whitted.hpp"

#include <algorithm>
#include <array>
#include <optional>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/vertex.hpp"

namespace tessera::core::integrators {
namespace {

// A ray of the tree and its state.
struct Branch {
  Ray ray;
  std::uint64_t node = sampling::kTreeRoot;
  int depth = 0;
  Rgb weight = Rgb::gray(1);  // multiplies the radiance along the ray
  float eta_scale = 1;        // undoes the compression of radiance by refraction in `weight`
  Enclosure enclosure{};      // where the ray begins
  float wavelength_nm = 0;    // as PathState

  float share() const { return max_component(weight) * eta_scale; }
};

class TreeTracer {
 public:
  TreeTracer(const RenderPlan& plan, const sampling::Sampler& sampler, RenderCounters& counters,
             LightParts* parts)
      : scene_(plan.scene()),
        light_sampler_(plan.light_sampler()),
        sampler_(sampler),
        counters_(counters),
        parts_(parts),
        max_depth_(plan.settings().max_depth > 0 ? plan.settings().max_depth : kWhittedDepth) {}

  Rgb trace(const Ray& ray) {
    follow({.ray = ray});
    return radiance_;
  }

 private:
  // Follows the strongest branch of each fork iteratively and the weaker ones recursively. A weaker one has
  // at most half of the light, so the recursion is about a dozen deep before the weight is negligible; if
  // textures reflect more than they receive, it can be as deep as the tree.
  void follow(Branch branch) {
    while (rays_ < kMaxWhittedRays) {
      const auto [ray, hit, traced, tint] = meet_by_chance(
          scene_, origin_at_depth(branch.depth), branch.ray, sampler_, branch.node, branch.enclosure,
          [&](const Ray& at, const Hit& passed, const Crossing& met, Rgb before) {
            if (met.emits) add_emission(branch, before, met.surface, at, passed);
          });
      branch.weight *= tint;
      counters_.closest_hit_rays += traced;
      rays_ += static_cast<int>(traced);
      if (!hit.found()) return add_environment(branch);
      const PathVertex vertex(
          scene_, ray, hit, branch.enclosure.boundary,
          wavelength_in(scene_, branch.wavelength_nm, sampler_, sampling::tree_wavelength_pad(branch.node)));
      add_emission(branch, Rgb::gray(1), vertex.surface(), ray, hit);
      if (!vertex.is_delta()) add_direct_light(branch, vertex);
      if (!vertex.has_delta()) return;
      if (branch.depth >= max_depth_) return;
      const Fork children = fork(branch, vertex);
      const auto greatest = std::max_element(children.begin(), children.end(), has_less);
      for (const Branch& child : children)
        if (&child != &*greatest && child.share() >= kMinWhittedShare) follow(child);
      if (!(greatest->share() >= kMinWhittedShare)) return;
      branch = *greatest;
    }
  }

  // The branches of all DeltaBranches; a missing one has weight 0.
  using Fork = std::array<Branch, std::tuple_size_v<DeltaBranches>>;
  static bool has_less(const Branch& a, const Branch& b) { return a.share() < b.share(); }
  static Fork fork(const Branch& branch, const PathVertex& vertex) {
    Fork children;
    const auto directions = vertex.delta_branches();
    for (std::size_t i = 0; i < children.size(); ++i) {
      const auto& direction = directions[i];
      if (!direction) {
        children[i].weight = {};
        continue;
      }
      children[i] = {vertex.ray_along(direction->wi),
                     sampling::tree_child(branch.node, static_cast<std::uint32_t>(i)),
                     branch.depth + 1,
                     branch.weight * direction->weight,
                     branch.eta_scale * direction->eta * direction->eta,
                     branch.enclosure,
                     vertex.wavelength_along(direction->wi)};
    }
    return children;
  }

  void add(Rgb radiance, int scatterings, std::uint32_t light,
           LightParts::Source source = LightParts::Source::kEmission) {
    radiance_ += radiance;
    if (parts_ != nullptr) parts_->add(radiance, scatterings, source, scene_.light_group(light));
  }

  void add_environment(const Branch& branch) {
    if (parts_ != nullptr && branch.depth == 0) parts_->escaped = true;
    if (scene_.environment_light() == lights::kNoLight) return;
    if (branch.depth == 0 && !scene_.environment().visible_to_camera()) return;
    add(branch.weight * scene_.environment().radiance(branch.ray.direction), branch.depth,
        scene_.environment_light(), LightParts::Source::kEnvironment);
  }

  // `tint` is that of the surfaces before it which the branch does not have yet.
  void add_emission(const Branch& branch, Rgb tint, const SurfacePoint& surface, const Ray& ray,
                    const Hit& hit) {
    const std::uint32_t light = scene_.light_of(hit);
    if (light == lights::kNoLight) return;
    const Rgb emitted = scene_.with_area_light(light, ray.time, [&](const lights::AreaLight& area) {
      return area.emitted(scene_.textures(), surface.position, uv_sets_at(scene_, hit, surface),
                          normalize(-ray.direction));
    });
    add(branch.weight * tint * emitted, branch.depth, light);
  }

  void add_direct_light(const Branch& branch, const PathVertex& vertex) {
    const auto count = static_cast<std::uint32_t>(scene_.lights().size());
    if (count <= kMaxWhittedLights) {
      for (std::uint32_t i = 0; i < count; ++i) {
        const auto u = sampler_.pad(sampling::tree_light_pad(branch.node, i));
        add_light(branch, vertex, {i, 1}, {u[0], u[1]});
      }
      return;
    }
    for (std::uint32_t i = 0; i < kMaxWhittedLights; ++i) {
      const auto u = sampler_.pad(sampling::tree_light_pad(branch.node, i));
      const double stratum = (i + combine_uniforms(u[2], u[3])) / kMaxWhittedLights;
      lights::LightSampler::Choice choice = light_sampler_.sample(vertex.light_context(), stratum);
      if (choice.light == lights::kNoLight) continue;
      choice.pmf *= kMaxWhittedLights;
      add_light(branch, vertex, choice, {u[0], u[1]});
    }
  }

  // `choice.pmf` is the expected number of samples of the light.
  void add_light(const Branch& branch, const PathVertex& vertex, lights::LightSampler::Choice choice,
                 Vec2 u) {
    const auto light = sample_light(scene_.lights()[choice.light], scene_.textures(), vertex.light_context(),
                                    u, lights::MisCompensation::kOff, vertex.time());
    if (!light) return;
    const Rgb reflected = reflected_light(scene_, vertex, *light, branch.enclosure, counters_);
    add(branch.weight * reflected / (light->pdf * choice.pmf), branch.depth + 1, choice.light);
  }

  const Scene& scene_;
  const lights::LightSampler& light_sampler_;
  const sampling::Sampler& sampler_;
  RenderCounters& counters_;
  LightParts* parts_;
  int max_depth_;
  int rays_ = 0;
  Rgb radiance_{};
};

}  // namespace

Rgb trace_whitted(const RenderPlan& plan, const sampling::Sampler& sampler, const Ray& ray,
                  RenderCounters& counters, LightParts* parts) {
  return TreeTracer(plan, sampler, counters, parts).trace(ray);
}

}  // namespace tessera::core::integrators
