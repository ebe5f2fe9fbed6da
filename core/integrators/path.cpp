// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/path.hpp"

#include <algorithm>
#include <bit>
#include <cassert>
#include <utility>

#include "core/geometry/ray_lanes.hpp"
#include "core/integrators/direct_light.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core {

// With fewer than eight paths, the other lanes repeat the first.
struct PathTracer::Paths {
  Paths(const PathQueue::Batch& batch, std::span<const Hit> all_hits, const ShadingBins& bins,
        std::span<const std::uint32_t> slots)
      : count(slots.size()), used((1u << slots.size()) - 1), continuing(used) {
    RgbLanes throughputs;
    FloatLanes eta_scales, guiding_pdf_ratios;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
      const std::uint32_t slot = slots[lane < slots.size() ? lane : 0];
      heads[lane] = &batch.heads[slot];
      hits[lane] = &all_hits[slot];
      rays[lane] = &batch.rays[slot];
      materials[lane] = bins.material(slot);
      emissive_lanes |= (lane < slots.size() && bins.is_emissive(slot) ? 1u : 0u) << lane;
      throughputs.set(lane, heads[lane]->throughput);
      eta_scales.set(lane, heads[lane]->eta_scale);
      guiding_pdf_ratios.set(lane, heads[lane]->guiding_pdf_ratio);
    }
    throughput = throughputs.all();
    eta_scale = eta_scales.all();
    guiding_pdf_ratio = guiding_pdf_ratios.all();
  }

  // Ends the paths that have reached the maximum depth.
  void limit(std::span<const std::uint16_t> depths, int max_depth) {
    for (std::size_t lane = 0; lane < count; ++lane)
      if (depths[heads[lane]->path] >= max_depth) continuing &= ~(1u << lane);
  }

  std::array<const Sampler*, kLaneCount> of(std::span<const Sampler> samplers) const {
    std::array<const Sampler*, kLaneCount> of_lanes;
    for (std::size_t lane = 0; lane < kLaneCount; ++lane) of_lanes[lane] = &samplers[heads[lane]->path];
    return of_lanes;
  }

  std::size_t count;
  unsigned used;                // bit i for lane i
  unsigned continuing;          // bit i for lane i: may have further vertices
  unsigned emissive_lanes = 0;  // bit i for lane i: the hit may be emissive
  std::array<const PathHead*, kLaneCount> heads;
  std::array<const Ray*, kLaneCount> rays;
  std::array<const Hit*, kLaneCount> hits;
  SurfaceBatch::Materials materials;
  bool plain_triangles = false;  // in all lanes
  RgbOf<Float8> throughput;
  Float8 eta_scale, guiding_pdf_ratio;
};

PathTracer::PathTracer(const RenderPlan& plan, std::span<const Sampler> samplers, std::span<Rgb> radiance,
                       std::span<LightParts> parts)
    : scene_(plan.scene()),
      settings_(plan.settings()),
      light_sampler_(plan.light_sampler()),
      compensation_(mis_compensation(settings_.integrator)),
      guide_(plan.guide()),
      lens_lights_(plan.lens_lights()),
      samplers_(samplers),
      radiance_(radiance),
      parts_(parts),
      depths_(samplers.size()),
      clamps_(settings_.clamp_indirect > 0),
      indirect_(clamps_ ? samplers.size() : 0),
      survives_(samplers.size()),
      bins_(scene_, plan.material_bins()) {
  waiting_.front().make_room(samplers.size());
}

std::span<const std::uint32_t> PathTracer::step(RenderCounters& counters) {
  const std::size_t list = longest_list(), next = list_after(list);
  if (next == waiting_.size()) waiting_.emplace_back();
  PathQueue& paths = waiting_[list];
  next_paths_ = &waiting_[next];
  batch_ = paths.last();
  const std::size_t count = batch_.rays.size();
  assert(count > 0);
  next_paths_->make_room(count);
  counters.closest_hit_rays += count;
  scene_.bvh().closest_hits(scene_.primitives(), batch_.rays, {hits_.data(), count});

  const int depth = static_cast<int>(std::min(list, kListsByDepth));
  if (!scene_.is_opaque()) pass_through_surfaces(counters);
  const int max_depth = settings_.max_depth > 0 ? settings_.max_depth : kMaxPathDepth;
  bins_.sort(batch_.rays, {hits_.data(), count});
  bins_.for_each_group([&](ShadingBin bin, std::span<const std::uint32_t> slots, bool plain_triangles) {
    Paths together(batch_, hits_, bins_, slots);
    together.plain_triangles = plain_triangles;
    together.limit(depths_, max_depth);
    shade(bin, together, depth);
  });
  add_unoccluded(counters, depth);
  collect_ended();
  paths.drop_last(count);
  return ended_;
}

// Passing through a surface stochastically adds no depth, and tints the light.
void PathTracer::pass_through_surfaces(RenderCounters& counters) {
  const std::span<Hit> hits(hits_.data(), batch_.rays.size());
  counters.closest_hit_rays += pass_by_chance(
      scene_, batch_.rays, hits,
      [&](std::uint32_t slot) { return std::uint64_t{depths_[batch_.heads[slot].path]}; },
      [&](std::uint32_t slot) -> const Sampler& { return samplers_[batch_.heads[slot].path]; },
      [&](std::uint32_t slot, Rgb tint) { batch_.heads[slot].throughput *= tint; });
}

std::size_t PathTracer::list_after(std::size_t list) {
  return list == kListsByDepth + 1 ? kListsByDepth : list + 1;
}

// The last of the lists with the most waiting paths.
std::size_t PathTracer::longest_list() const {
  std::size_t longest = 0;
  for (std::size_t list = 1; list < waiting_.size(); ++list)
    if (waiting_[list].size() >= waiting_[longest].size()) longest = list;
  return longest;
}

void PathTracer::collect_ended() {
  ended_.clear();
  for (const PathHead& head : batch_.heads) {
    if (survives_[head.path] == 0) {
      ended_.push_back(head.path);
      if (clamps_) add_indirect(head.path);
    }
    survives_[head.path] = 0;
  }
}

// Adds the indirect light of a path that has ended, clamped.
void PathTracer::add_indirect(std::uint32_t path) {
  const Rgb indirect = clamped(indirect_[path], settings_.clamp_indirect);
  radiance_[path] += indirect;
  if (!parts_.empty()) parts_[path].indirect = indirect;
}

// The random numbers for a decision at these paths' vertices; `pad_at` returns their pad, by depth.
template <typename PadAt>
std::array<Float8, 4> PathTracer::numbers(const Paths& paths, int depth, PadAt pad_at) const {
  if (depth < static_cast<int>(kListsByDepth)) return Sampler::pads(paths.of(samplers_), pad_at(depth));
  std::array<std::uint32_t, kLaneCount> pads;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) pads[lane] = pad_at(depths_[paths.heads[lane]->path]);
  return Sampler::pads(paths.of(samplers_), pads);
}

void PathTracer::shade(ShadingBin bin, const Paths& paths, int depth) {
  using enum ShadingBin;
  if (bin == kEscaped) return add_environment(paths, depth);
  const SurfaceBatch surfaces(scene_, paths.rays, paths.hits, paths.materials, paths.plain_triangles);
  switch (bin) {
    case kDiffuse:
      return shade(paths, diffuse_vertices(surfaces), depth);
    case kGlossy:
      return shade(paths, glossy_vertices(surfaces), depth);
    case kPhong:
      return shade(paths, phong_vertices(surfaces), depth);
    case kSpecular:
      return shade(paths, specular_vertices(surfaces), depth);
    case kPrincipled:
    case kClearPrincipled:
    case kPlastic:
    case kConductor:
    case kDiffuseTransmission:
    case kThinDielectric:
      return shade(paths, layered_vertices(surfaces), depth);
    case kMixed:
      return shade(paths, mixed_vertices(surfaces, paths.count), depth);
    case kBlends:
    case kEscaped:
      return;
  }
}

template <typename Vertices>
void PathTracer::shade(const Paths& paths, const Vertices& vertices, int depth) {
  for (unsigned lanes = paths.emissive_lanes; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    const std::uint32_t light = scene_.light_of(*paths.hits[lane]);
    if (light == kNoLight) continue;
    const Vec2Of<Float8>& uv = vertices.surface().uv;
    const Vec2 uv_of_lane{FloatLanes(uv.x)[lane], FloatLanes(uv.y)[lane]};
    add_emission(
        *paths.heads[lane],
        {Vec3Lanes(vertices.position())[lane], scene_.primitives().uv_sets(*paths.hits[lane], uv_of_lane),
         Vec3Lanes(vertices.wo())[lane], light, paths.rays[lane]->time},
        depth);
  }
  if (paths.continuing == 0) return;
  const Guidance guidance = guidance_at(vertices);
  const unsigned lit = light_sampler_.empty() ? 0 : paths.continuing & ~vertices.is_delta().bits();
  if (lit != 0) connect_to_lights(paths, vertices, guidance.share, lit, depth);
  scatter(paths, vertices, guidance, depth);
}

// Adds the environment's radiance to escaped rays.
void PathTracer::add_environment(const Paths& paths, int depth) {
  for (std::size_t lane = 0; depth == 0 && !parts_.empty() && lane < paths.count; ++lane)
    parts_[paths.heads[lane]->path].escaped = true;
  const std::uint32_t light = scene_.environment_light();
  if (light == kNoLight || (depth == 0 && !scene_.environment().visible_to_camera())) return;
  Vec3Lanes directions, normals;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    directions.set(lane, paths.rays[lane]->direction);
    normals.set(lane, paths.heads[lane]->last.normal);
  }
  const Environment::Seen seen = scene_.environment().see(normals.all(), directions.all(), compensation_);
  const RgbLanes radiance(seen.radiance);
  const FloatLanes pdf(seen.pdf);
  for (std::size_t lane = 0; lane < paths.count; ++lane) {
    const PathHead& head = *paths.heads[lane];
    const float weight = emitter_hit_weight(light, head, [&] { return pdf[lane]; });
    if (weight > 0)
      add(head.path, head.throughput * radiance[lane] * weight, depth, light,
          LightParts::Source::kEnvironment);
  }
}

// Adds emission hit by the ray itself.
void PathTracer::add_emission(const PathHead& head, const EmitterHit& hit, int depth) {
  scene_.with_area_light(hit.light, hit.time, [&](const AreaLight& area) {
    const auto pdf = [&] { return area.pdf(head.last.position, hit.position); };
    const float weight = depth == 0 && lens_lights_ != nullptr ? camera_ray_weight(head, hit, pdf())
                                                               : emitter_hit_weight(hit.light, head, pdf);
    if (weight > 0)
      add(head.path, head.throughput * area.emitted(scene_.textures(), hit.position, hit.uv, hit.wo) * weight,
          depth, hit.light);
  });
}

// The weight of light that a camera ray found, against connections to the lens.
float PathTracer::camera_ray_weight(const PathHead& head, const EmitterHit& hit, float light_pdf) const {
  return lens_lights_->weight(settings_.heuristic, {.focus = head.last.position,
                                                    .direction = -hit.wo,
                                                    .time = hit.time,
                                                    .light = hit.light,
                                                    .light_pdf = light_pdf});
}

// The weight of light that a BSDF sample found. If the previous vertex could also have sampled it, `nee`
// leaves it to light sampling and `mis` weighs it. `pdf` is the density of the direction, given the light.
template <typename Pdf>
float PathTracer::emitter_hit_weight(std::uint32_t light, const PathHead& head, Pdf pdf) const {
  if (head.last_pdf == kDeltaPdf || settings_.integrator == Integrator::kNaive) return 1;
  if (settings_.integrator == Integrator::kNee || head.emitter_mis_scale == 0) return 0;
  const float pmf = light_sampler_.pmf(head.last, light, compensation_);
  return head.emitter_mis_scale * mis_weight(settings_.heuristic, head.last_pdf, pmf * pdf());
}

// The times of the paths' rays.
Float8 PathTracer::times_of(const Paths& paths) const {
  if (!scene_.has_motion()) return 0.0f;
  FloatLanes times;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) times.set(lane, paths.rays[lane]->time);
  return times.all();
}

// Samples a light for each vertex, and evaluates what the vertex reflects of it along the path.
template <typename Vertices>
void PathTracer::connect_to_lights(const Paths& paths, const Vertices& vertices, Float8 guide_share,
                                   unsigned lit, int depth) {
  const auto u = numbers(paths, depth, light_pad);
  const FloatLanes coarse(u[2]), fine(u[3]);
  std::array<double, kLaneCount> u_light;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    u_light[lane] = combine_uniforms(coarse[lane], fine[lane]);
  const LightSampleContexts light_contexts{vertices.position(), vertices.light_normal()};
  const auto choices = light_sampler_.sample(light_contexts, u_light, lit, compensation_);
  std::array<const Light*, kLaneCount> chosen{};
  FloatLanes pmf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const auto& [light, chance] = choices[lane];
    if ((lit >> lane & 1) != 0 && light != kNoLight) chosen[lane] = &scene_.lights()[light];
    pmf.set(lane, chance);
  }
  const LightSamples lights =
      sample_lights(chosen, scene_.textures(), light_contexts, {u[0], u[1]}, compensation_, times_of(paths));
  const BsdfValueOf<Float8> scattered = vertices.evaluate(lights.wi);
  const Mask8 found = lights.found & !is_black(scattered.value);
  const Float8 light_pdf = pmf.all() * lights.pdf;
  const Float8 weight = light_sample_weight(light_pdf, lights.delta, scattered.pdf * (1 - guide_share));
  const RgbLanes gained(paths.throughput * (scattered.value * lights.radiance) * (weight / light_pdf));
  const RayLanes rays(vertices.rays_toward(lights));
  for (unsigned lanes = found.bits(); lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    add_connection(rays[lane], paths.rays[lane]->time,
                   {paths.heads[lane]->path, gained[lane], choices[lane].light});
  }
}

// The weight of light that a light sample found, against the BSDF's density. Only light samples find delta
// lights.
Float8 PathTracer::light_sample_weight(Float8 light_pdf, Mask8 delta, Float8 bsdf_pdf) const {
  if (settings_.integrator != Integrator::kMis) return 1.0f;
  return select(delta, Float8(1.0f), mis_weight(settings_.heuristic, light_pdf, bsdf_pdf));
}

struct PathTracer::Directions {
  Mask8 found, delta;
  Vec3Of<Float8> wi;
  RgbOf<Float8> weight;  // BSDF * cosine / pdf of the mixture
  Float8 bsdf_pdf;       // the BSDF's share of that pdf
  Float8 eta;
  Float8 emitter_mis_scale,
      guiding_pdf_ratio;  // PathHead::emitter_mis_scale, and the factor for PathHead::guiding_pdf_ratio
};

// Continues the paths that survive.
template <typename Vertices>
void PathTracer::scatter(const Paths& paths, const Vertices& vertices, const Guidance& guidance, int depth) {
  const auto u = numbers(paths, depth, scatter_pad);
  const Directions next = choose_directions(vertices, guidance, {u[0], u[1]}, u[2]);
  RgbOf<Float8> throughput = paths.throughput * next.weight;
  const Float8 eta_scale = paths.eta_scale * (next.eta * next.eta),
               guiding_pdf_ratio = paths.guiding_pdf_ratio * next.guiding_pdf_ratio;
  const Mask8 survives = survives_roulette(throughput, eta_scale, guiding_pdf_ratio, depth, u[3]);
  const RayLanes rays(vertices.ray_along(next.wi));
  const RgbLanes throughputs(throughput);
  const FloatLanes eta_scales(eta_scale), guiding_pdf_ratios(guiding_pdf_ratio),
      emitter_mis_scales(next.emitter_mis_scale);
  const FloatLanes pdf(select(next.delta, Float8(kDeltaPdf), next.bsdf_pdf));
  const Vec3Lanes position(vertices.position()), normal(vertices.light_normal());
  for (unsigned lanes = (next.found & survives).bits() & paths.continuing; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    survives_[paths.heads[lane]->path] = 1;
    ++depths_[paths.heads[lane]->path];
    Ray next_ray = rays[lane];
    next_ray.time = paths.rays[lane]->time;
    next_paths_->push(next_ray, {.path = paths.heads[lane]->path,
                                 .throughput = throughputs[lane],
                                 .eta_scale = eta_scales[lane],
                                 .last_pdf = pdf[lane],
                                 .last = {position[lane], normal[lane]},
                                 .emitter_mis_scale = emitter_mis_scales[lane],
                                 .guiding_pdf_ratio = guiding_pdf_ratios[lane]});
  }
}

template <typename Vertices>
PathTracer::Guidance PathTracer::guidance_at(const Vertices& vertices) const {
  if (!guide_ || all(vertices.is_delta())) return {};
  Guidance guidance = guide_->at(vertices.position(), vertices.side_normal());
  guidance.share = select(vertices.is_delta(), Float8(0.0f), guidance.share);
  return guidance;
}

// Samples the guide or the BSDF: one sample of a mixture (Veach and Guibas 1995, section 3.3). The guide
// does not represent direct light. Emission that the next ray hits is therefore left to BSDF and light
// samples, which then need no guiding densities.
template <typename Vertices>
PathTracer::Directions PathTracer::choose_directions(const Vertices& vertices, const Guidance& guidance,
                                                     Vec2Of<Float8> u, Float8 u_lobe) const {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const Float8 share = guidance.share, bsdf_share = 1 - share;
  const Mask8 guided = u.x < share;
  const Mask8 mixed = share > 0;
  const Vec2Of<Float8> u_bsdf{smaller((u.x - share) / bsdf_share, Float8(kBelowOne)), u.y};
  const auto [found, delta, wi, weight, pdf, eta] = vertices.sample(u_bsdf, u_lobe);
  Directions next{found, delta, wi, weight, pdf, eta, 1.0f, 1.0f};
  if (!any(mixed)) return next;

  const Vec2Of<Float8> u_guide{smaller(u.x / share, Float8(kBelowOne)), u.y};
  const auto [mixed_wi, guide_pdf] = guide_->sample_or(guidance, guided, u_guide, wi);
  next.wi = mixed_wi;
  RgbOf<Float8> value = weight * pdf;
  Float8 bsdf_pdf = pdf;
  if (any(guided)) {
    const auto at_guided = vertices.evaluate(select(guided, next.wi, {}));
    value = select(guided, at_guided.value, value);
    bsdf_pdf = select(guided, at_guided.pdf, pdf);
    next.found = (guided & !is_black(value)) | (found & !guided);
    next.eta = select(guided, Float8(1.0f), eta);
  }
  const Float8 by_bsdf = bsdf_share * bsdf_pdf;
  const Float8 density = share * guide_pdf + by_bsdf;
  next.weight = select(mixed, value * (1 / density), weight);
  next.bsdf_pdf = select(mixed, by_bsdf, pdf);
  next.emitter_mis_scale = select(mixed, select(guided, Float8(0.0f), density / by_bsdf), Float8(1.0f));
  next.guiding_pdf_ratio = select(mixed, density / bsdf_pdf, Float8(1.0f));
  next.delta = delta & !guided;
  const Mask8 by_delta = mixed & next.delta;
  if (!any(by_delta)) return next;
  // The guide generates no direction of a delta lobe.
  next.weight = select(by_delta, weight * (1 / bsdf_share), next.weight);
  next.emitter_mis_scale = select(by_delta, Float8(1.0f), next.emitter_mis_scale);
  next.guiding_pdf_ratio = select(by_delta, bsdf_share, next.guiding_pdf_ratio);
  return next;
}

void PathTracer::add_unoccluded(RenderCounters& counters, int depth) {
  const std::size_t count = std::exchange(connection_count_, 0);
  counters.shadow_rays += count;
  scene_.bvh().any_hits(scene_.primitives(), {shadow_rays_.data(), count}, {occluded_.data(), count});
  for (std::size_t i = 0; i < count; ++i)
    if (occluded_[i] == 0)
      add(connections_[i].path, connections_[i].radiance, depth + 1, connections_[i].light);
  if (!scene_.is_opaque()) add_transmitted(count, counters, depth);
}

// Adds the light of occluded connections that partly transparent surfaces let through.
void PathTracer::add_transmitted(std::size_t count, RenderCounters& counters, int depth) {
  std::vector<Ray> rays;
  std::vector<std::size_t> of_rays;
  for (std::size_t i = 0; i < count; ++i) {
    if (occluded_[i] == 0) continue;
    rays.push_back(shadow_rays_[i]);
    of_rays.push_back(i);
  }
  std::vector<Rgb> shares(rays.size());
  counters.shadow_rays += find_transmittances(scene_, rays, shares);
  for (std::size_t k = 0; k < rays.size(); ++k) {
    const auto& [path, radiance, light] = connections_[of_rays[k]];
    if (!is_black(shares[k])) add(path, radiance * shares[k], depth + 1, light);
  }
}

}  // namespace tessera::core
