// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/path.hpp"

#include <algorithm>
#include <bit>
#include <cassert>

#include "core/integrators/opacity.hpp"
#include "core/integrators/path_lanes.hpp"
#include "core/integrators/path_wavelength.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {

PathTracer::PathTracer(const RenderPlan& plan, std::span<const sampling::Sampler> samplers,
                       std::span<Rgb> radiance, std::span<LightParts> parts)
    : scene_(plan.scene()),
      settings_(plan.settings()),
      light_sampler_(plan.light_sampler()),
      compensation_(mis_compensation(settings_.integrator)),
      guide_(plan.guide()),
      environment_guide_(plan.environment_guide()),
      through_panes_(plan.samples_through_panes()),
      lens_lights_(plan.lens_lights()),
      samplers_(samplers),
      radiance_(radiance),
      parts_(parts),
      depths_(samplers.size()),
      clamps_(settings_.clamp_indirect > 0),
      indirect_(clamps_ ? samplers.size() : 0),
      enclosures_(scene_.nested_dielectrics().empty() ? 1 : samplers.size()),
      survives_(samplers.size()),
      bins_(scene_, plan.material_bins()) {
  waiting_.front().reserve(samplers.size());
  connections_.reserve(kBatchPaths);
}

void PathTracer::begin(const RayOf<FloatN>& rays, std::span<const std::uint32_t> paths,
                       const Vec3Of<FloatN>& focuses) {
  static constexpr PathState kBegun{};
  const NewRows<PathState> begun = waiting_.front().push((1u << paths.size()) - 1);
  begun.fill(kBegun);
  begun.put(&PathState::ray, rays);
  begun.put(&PathState::path, Paths::rows_of(paths).all());
  if (lens_lights_ != nullptr)
    begun.field(&PathState::last).put(&lights::LightSampleContext::position, focuses);
  for (const std::uint32_t path : paths) {
    radiance_[path] = {};
    depths_[path] = 0;
    if (clamps_) indirect_[path] = {};
    if (!parts_.empty()) parts_[path].clear();
  }
}

std::span<const std::uint32_t> PathTracer::step(RenderCounters& counters) {
  const std::size_t list = longest_list(), next = list_after(list);
  if (next == waiting_.size()) waiting_.emplace_back();
  Columns<PathState>& paths = waiting_[list];
  next_paths_ = &waiting_[next];
  const std::size_t count = std::min(paths.size(), kBatchPaths), left = paths.size() - count;
  assert(count > 0);
  batch_ = paths.all().rows(left, count);
  const ColumnsView<const Ray> rays = batch_.field(&PathState::ray);
  const ColumnsView<Hit> hits = hits_.all().rows(0, count);
  next_paths_->reserve(next_paths_->size() + count);
  counters.closest_hit_rays += count;
  scene_.closest_hits(rays, hits);

  const int depth = static_cast<int>(std::min(list, kListsByDepth));
  if (!scene_.is_opaque()) pass_through_surfaces(counters, depth);
  const int max_depth = settings_.max_depth > 0 ? settings_.max_depth : kMaxPathDepth;
  bins_.sort(rays, hits, {boundaries_.data(), count});
  const auto together = [&](std::span<const std::uint32_t> slots) {
    Paths paths_of_slots(batch_, hits, bins_, slots);
    paths_of_slots.limit(depths_, max_depth);
    return paths_of_slots;
  };
  bins_.for_each_group([&](Kernel kernel, std::span<const std::uint32_t> slots, bool plain_triangles) {
    Paths shaded = together(slots);
    shaded.plain_triangles = plain_triangles;
    if (scene_.has_dispersion()) find_wavelengths(shaded, depth);
    shade(kernel, shaded, depth);
  });
  bins_.for_each_escaped(
      [&](std::span<const std::uint32_t> slots) { add_environment(together(slots), depth); });
  add_unoccluded(counters, depth);
  collect_ended();
  paths.resize(left);
  return ended_;
}

// Passing through a surface stochastically adds no depth, and tints the light.
void PathTracer::pass_through_surfaces(RenderCounters& counters, int depth) {
  const ColumnsView<Rgb> throughputs = batch_.field(&PathState::throughput);
  const auto path_in = [this](std::uint32_t slot) { return batch_.get(&PathState::path, slot); };
  const auto enclosure_of = [&](std::uint32_t slot) -> Enclosure& { return enclosure(path_in(slot)); };
  const auto count = static_cast<std::uint32_t>(batch_.size());
  for (std::uint32_t slot = 0; depth == 0 && slot < count; ++slot) enclosure_of(slot) = {};
  counters.closest_hit_rays += pass_by_chance(
      scene_, origin_at_depth(depth), batch_.field(&PathState::ray), hits_.all().rows(0, count),
      [&](std::uint32_t slot) { return std::uint64_t{depths_[path_in(slot)]}; },
      [&](std::uint32_t slot) -> const sampling::Sampler& { return samplers_[path_in(slot)]; }, enclosure_of,
      [&](std::uint32_t slot, const Ray& ray, const Hit& hit, const Crossing& met) {
        if (met.emits) add_passed_emission({batch_, slot}, ray, hit, met.surface, depth);
        throughputs.set(slot, throughputs[slot] * met.tint());
      });
  for (std::uint32_t slot = 0; slot < count; ++slot) boundaries_[slot] = enclosure_of(slot).boundary;
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
  const ColumnsView<std::uint32_t> paths = batch_.field(&PathState::path);
  for (std::size_t slot = 0; slot < paths.size(); ++slot) {
    const std::uint32_t path = paths[slot];
    if (survives_[path] == 0) {
      ended_.push_back(path);
      if (clamps_) add_indirect(path);
    }
    survives_[path] = 0;
  }
}

// Adds the indirect light of a path that has ended, clamped.
void PathTracer::add_indirect(std::uint32_t path) {
  const Rgb indirect = clamped(indirect_[path], settings_.clamp_indirect);
  radiance_[path] += indirect;
  if (!parts_.empty()) parts_[path].indirect = indirect;
}

// The random numbers for a decision at these paths' vertices; `pad_at` returns their pad, by depth.
std::array<FloatN, 4> PathTracer::numbers(const Paths& paths, int depth, std::uint32_t (*pad_at)(int)) const {
  if (depth < static_cast<int>(kListsByDepth))
    return sampling::Sampler::pads(paths.of(samplers_), pad_at(depth));
  std::array<std::uint32_t, kLaneCount> pads;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) pads[lane] = pad_at(depths_[paths.path[lane]]);
  return sampling::Sampler::pads(paths.of(samplers_), pads);
}

void PathTracer::find_wavelengths(Paths& paths, int depth) const {
  const unsigned lanes = paths.dispersive_lanes();
  if (lanes == 0) return;
  paths.disperses_light = MaskN::from_bits(lanes);
  paths.light = wavelengths_at(paths.states.all(&PathState::wavelength_nm),
                               numbers(paths, depth, sampling::wavelength_pad)[0]);
}

void PathTracer::shade(Kernel kernel, const Paths& paths, int depth) {
  SurfaceBatch surfaces(scene_, paths.rays, paths.hits, paths.materials, paths.plain_triangles);
  if (paths.light) surfaces.wavelength = &*paths.light;
  switch (kernel) {
    case Kernel::kDiffuse:
      return shade(paths, diffuse_vertices(surfaces), depth);
    case Kernel::kGlossy:
      return shade(paths, glossy_vertices(surfaces), depth);
    case Kernel::kPhong:
      return shade(paths, phong_vertices(surfaces), depth);
    case Kernel::kSpecular:
      return shade(paths, specular_vertices(surfaces), depth);
    case Kernel::kLayered:
      return shade(paths, layered_vertices(surfaces), depth);
    case Kernel::kGeneral:
      return shade(paths, general_vertices(surfaces), depth);
  }
}

template <typename Vertices>
void PathTracer::shade(const Paths& paths, const Vertices& vertices, int depth) {
  for (unsigned lanes = paths.emissive_lanes; lanes != 0; lanes &= lanes - 1) {
    const auto lane = static_cast<std::size_t>(std::countr_zero(lanes));
    const Hit hit = paths.hits[lane];
    const std::uint32_t light = scene_.light_of(hit);
    if (light == lights::kNoLight) continue;
    const Vec2Of<FloatN>& uv = vertices.surface().uv;
    const Vec2 uv_of_lane{FloatLanes(uv.x)[lane], FloatLanes(uv.y)[lane]};
    add_emission(paths.states.at(lane),
                 {Vec3Lanes(vertices.position())[lane], scene_.primitives().uv_sets(hit, uv_of_lane),
                  Vec3Lanes(vertices.wo())[lane], light, paths.rays.get(&Ray::time, lane)},
                 depth);
  }
  if (paths.continuing == 0) return;
  const Guidance guidance = guidance_at(vertices);
  const unsigned lit = light_sampler_.empty() ? 0 : paths.continuing & ~vertices.is_delta().bits();
  if (lit != 0) connect_to_lights(paths, vertices, guidance.share, lit, depth);
  scatter(paths, vertices, guidance, depth);
}

// The rays are those that follow the paths'. Where nothing moves, rays have no times.
void PathTracer::put_times(const Paths& paths, const NewRows<Ray>& rays) const {
  if (scene_.has_motion()) rays.put(&Ray::time, paths.rays.all(&Ray::time));
}

struct PathTracer::Directions {
  MaskN found, delta;
  Vec3Of<FloatN> wi;
  RgbOf<FloatN> weight;  // BSDF * cosine / pdf of the mixture
  FloatN bsdf_pdf;       // the BSDF's share of that pdf
  FloatN eta;
  FloatN emitter_mis_scale, guiding_pdf_ratio;  // PathState::emitter_mis_scale, and a factor for its ratio
};

// Continues the paths that survive.
template <typename Vertices>
void PathTracer::scatter(const Paths& paths, const Vertices& vertices, const Guidance& guidance, int depth) {
  const auto u = numbers(paths, depth, sampling::scatter_pad);
  const Directions next = choose_directions(vertices, guidance, {u[0], u[1]}, u[2]);
  RgbOf<FloatN> throughput = paths.throughput * next.weight;
  const FloatN eta_scale = paths.eta_scale * (next.eta * next.eta),
               guiding_pdf_ratio = paths.guiding_pdf_ratio * next.guiding_pdf_ratio;
  const MaskN survives = survives_roulette(throughput, eta_scale, guiding_pdf_ratio, depth, u[3]);
  const unsigned going_on = (next.found & survives).bits() & paths.continuing;
  if (going_on == 0) return;
  for (unsigned lanes = going_on; lanes != 0; lanes &= lanes - 1) {
    const std::uint32_t path = paths.path[static_cast<std::size_t>(std::countr_zero(lanes))];
    survives_[path] = 1;
    ++depths_[path];
  }
  const RayOf<FloatN> along = vertices.ray_along(next.wi);
  const NewRows<PathState> states = next_paths_->push(going_on);
  const NewRows<Ray> rays = states.field(&PathState::ray);
  rays.put(&Ray::origin, along.origin);
  rays.put(&Ray::direction, along.direction);
  rays.put(&Ray::t_max, along.t_max);
  put_times(paths, rays);
  states.put(&PathState::path, paths.path.all());
  states.put(&PathState::throughput, throughput);
  states.put(&PathState::eta_scale, eta_scale);
  states.put(&PathState::last_pdf, select(next.delta, FloatN(kDeltaPdf), next.bsdf_pdf));
  states.put(&PathState::last, {vertices.position(), vertices.light_normal()});
  states.put(&PathState::emitter_mis_scale, next.emitter_mis_scale);
  states.put(&PathState::guiding_pdf_ratio, guiding_pdf_ratio);
  if (through_panes_)
    put_straight(paths,
                 {{vertices.position(), vertices.light_normal()},
                  next.wi,
                  next.bsdf_pdf,
                  next.emitter_mis_scale,
                  next.delta,
                  dot(next.wi, vertices.side_normal()) < 0,
                  dot(vertices.surface().geometric_normal, vertices.wo()) < 0},
                 states, depth);
  if (!scene_.has_dispersion()) return;
  const MaskN refracted = paths.disperses_light & (dot(next.wi, vertices.side_normal()) < 0);
  states.put(&PathState::wavelength_nm, paths.light ? wavelength_beyond(*paths.light, refracted)
                                                    : paths.states.all(&PathState::wavelength_nm));
}

template <typename Vertices>
PathTracer::Guidance PathTracer::guidance_at(const Vertices& vertices) const {
  if (!guide_ || all(vertices.is_delta())) return {};
  Guidance guidance = guide_->at(vertices.position(), vertices.side_normal());
  guidance.share = select(vertices.is_delta(), FloatN(0.0f), guidance.share);
  return guidance;
}

// Samples the guide or the BSDF: one sample of a mixture (Veach and Guibas 1995, section 3.3). The guide
// does not represent direct light. Emission that the next ray hits is therefore left to BSDF and light
// samples, which then need no guiding densities.
template <typename Vertices>
PathTracer::Directions PathTracer::choose_directions(const Vertices& vertices, const Guidance& guidance,
                                                     Vec2Of<FloatN> u, FloatN u_lobe) const {
  constexpr float kBelowOne = 1 - 0x1p-24f;
  const FloatN share = guidance.share, bsdf_share = 1 - share;
  const MaskN guided = u.x < share;
  const MaskN mixed = share > 0;
  const Vec2Of<FloatN> u_bsdf{smaller((u.x - share) / bsdf_share, FloatN(kBelowOne)), u.y};
  const auto [found, delta, wi, weight, pdf, eta] = vertices.sample(u_bsdf, u_lobe);
  Directions next{found, delta, wi, weight, pdf, eta, 1.0f, 1.0f};
  if (!any(mixed)) return next;

  const Vec2Of<FloatN> u_guide{smaller(u.x / share, FloatN(kBelowOne)), u.y};
  const auto [mixed_wi, guide_pdf] = guide_->sample_or(guidance, guided, u_guide, wi);
  next.wi = mixed_wi;
  RgbOf<FloatN> value = weight * pdf;
  FloatN bsdf_pdf = pdf;
  if (any(guided)) {
    const auto at_guided = vertices.evaluate(select(guided, next.wi, {}));
    value = select(guided, at_guided.value, value);
    bsdf_pdf = select(guided, at_guided.pdf, pdf);
    next.found = (guided & !is_black(value)) | (found & !guided);
    next.eta = select(guided, FloatN(1.0f), eta);
  }
  const FloatN by_bsdf = bsdf_share * bsdf_pdf;
  const FloatN density = share * guide_pdf + by_bsdf;
  next.weight = select(mixed, value * (1 / density), weight);
  next.bsdf_pdf = select(mixed, by_bsdf, pdf);
  next.emitter_mis_scale = select(mixed, select(guided, FloatN(0.0f), density / by_bsdf), FloatN(1.0f));
  next.guiding_pdf_ratio = select(mixed, density / bsdf_pdf, FloatN(1.0f));
  next.delta = delta & !guided;
  const MaskN by_delta = mixed & next.delta;
  if (!any(by_delta)) return next;
  // The guide generates no direction of a delta lobe.
  next.weight = select(by_delta, weight * (1 / bsdf_share), next.weight);
  next.emitter_mis_scale = select(by_delta, FloatN(1.0f), next.emitter_mis_scale);
  next.guiding_pdf_ratio = select(by_delta, bsdf_share, next.guiding_pdf_ratio);
  return next;
}

}  // namespace tessera::core::integrators
