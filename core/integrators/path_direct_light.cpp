// SPDX-License-Identifier: Apache-2.0
// What PathTracer adds of light that light samples find.
#include <cassert>
#include <vector>

#include "core/integrators/direct_light.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/path.hpp"
#include "core/integrators/path_lanes.hpp"
#include "core/integrators/path_weights.hpp"
#include "core/math/lane_array.hpp"

namespace tessera::core::integrators {
namespace {

// The lanes that sample the environment by its guide. In the others the numbers become uniform again.
MaskN choose_guided(const EnvironmentGuide::GuidanceOf<FloatN>& guidance, DoubleN& u_light) {
  const DoubleN share = widened(guidance.share);
  const MaskN guided = u_light < share;
  u_light = select((share > 0) & !guided, (u_light - share) / (1 - share), u_light);
  return guided;
}

}  // namespace

// Samples a light for each vertex, and evaluates what the vertex reflects of it along the path.
template <typename Vertices>
void PathTracer::connect_to_lights(const Paths& paths, const Vertices& vertices, FloatN guide_share,
                                   unsigned lit, int depth) {
  const auto [lights, chosen, light_pdf] =
      sample_lights(paths, {vertices.position(), vertices.light_normal()}, lit, depth);
  const BsdfValueOf<FloatN> scattered = vertices.evaluate(lights.wi);
  const MaskN found = lights.found & !is_black(scattered.value);
  const FloatN weight = light_sample_weight(light_pdf, lights.delta, scattered.pdf * (1 - guide_share));
  if (!any(found)) return;
  const RayOf<FloatN> rays = vertices.rays_toward(lights);
  const NewRows<Connection> added = connections_.push(found.bits());
  const NewRows<Ray> shadow_rays = added.field(&Connection::ray);
  shadow_rays.put(&Ray::origin, rays.origin);
  shadow_rays.put(&Ray::direction, rays.direction);
  shadow_rays.put(&Ray::t_max, rays.t_max);
  put_times(paths, shadow_rays);
  added.put(&Connection::path, paths.path.all());
  added.put(&Connection::radiance,
            paths.throughput * (scattered.value * lights.radiance) * (weight / light_pdf));
  added.put(&Connection::light, chosen);
}

// In lanes whose bits are set in `lit`.
PathTracer::LightConnections PathTracer::sample_lights(const Paths& paths,
                                                       const lights::LightSampleContexts& from, unsigned lit,
                                                       int depth) const {
  const auto u = numbers(paths, depth, sampling::light_pad);
  DoubleN u_light = combine_uniforms(u[2], u[3]);
  if (environment_guide_ == nullptr) return sample_chosen_lights(paths, from, {u[0], u[1]}, u_light, lit);
  const EnvironmentGuide::GuidanceOf<FloatN> guidance = environment_guide_->at(from);
  const MaskN guided = MaskN::from_bits(lit) & choose_guided(guidance, u_light);
  LightConnections connections =
      sample_chosen_lights(paths, from, {u[0], u[1]}, u_light, lit & ~guided.bits());
  if (any(guidance.share > 0)) guide_to_environment(from, guidance, guided, {u[0], u[1]}, connections);
  return connections;
}

// Lanes whose bits are set in `lit` choose by u_light.
PathTracer::LightConnections PathTracer::sample_chosen_lights(const Paths& paths,
                                                              const lights::LightSampleContexts& from,
                                                              Vec2Of<FloatN> u, DoubleN u_light,
                                                              unsigned lit) const {
  const auto [light, pmf] = light_sampler_.sample(from, DoubleLanes(u_light), lit, compensation_);
  const WordLanes of_lights(light);
  std::array<const lights::Light*, kLaneCount> chosen{};
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    if ((lit >> lane & 1) != 0 && of_lights[lane] != lights::kNoLight)
      chosen[lane] = &scene_.lights()[of_lights[lane]];
  const lights::LightSamples samples =
      lights::sample_lights(chosen, scene_.textures(), from, u, compensation_,
                            scene_.has_motion() ? paths.rays.all(&Ray::time) : 0.0f);
  return {samples, light, pmf * samples.pdf};
}

// Replaces the samples of guided lanes, and the densities of all where there is guidance.
void PathTracer::guide_to_environment(const lights::LightSampleContexts& from,
                                      const EnvironmentGuide::GuidanceOf<FloatN>& guidance, MaskN guided,
                                      Vec2Of<FloatN> u, LightConnections& connections) const {
  lights::LightSamples& lights = connections.lights;
  const std::uint32_t environment = scene_.environment_light();
  const MaskN mixed = guidance.share > 0;
  const auto [wi, guide_pdf] = environment_guide_->sample_or(
      guidance, guided, u, select(lights.found, lights.wi, Vec3Of<FloatN>{0.0f, 0.0f, 1.0f}));
  FloatN chosen_pdf = connections.pdf;
  if (any(guided)) {
    const lights::Environment::Seen seen = scene_.environment().see(from.normal, wi, compensation_);
    lights.wi = select(guided, wi, lights.wi);
    lights.radiance = select(guided, seen.radiance, lights.radiance);
    lights.found = (guided & !is_black(seen.radiance)) | (lights.found & !guided);
    lights.delta = lights.delta & !guided;
    lights.distant = lights.distant | guided;
    connections.chosen = select(guided, U32xN(environment), connections.chosen);
    chosen_pdf = select(guided, light_sampler_.environment_pmf(from, compensation_) * seen.pdf, chosen_pdf);
  }
  const FloatN by_guide =
      select(connections.chosen == U32xN(environment), guidance.share * guide_pdf, FloatN(0.0f));
  connections.pdf = select(mixed, (1 - guidance.share) * chosen_pdf + by_guide, connections.pdf);
}

// The weight of light that a light sample found, against the BSDF's density. Only light samples find delta
// lights.
FloatN PathTracer::light_sample_weight(FloatN light_pdf, MaskN delta, FloatN bsdf_pdf) const {
  if (settings_.integrator != Integrator::kMis) return 1.0f;
  return select(delta, FloatN(1.0f), mis_weight(settings_.heuristic, light_pdf, bsdf_pdf));
}

template void PathTracer::connect_to_lights(const Paths&, const DiffuseVertices&, FloatN, unsigned, int);
template void PathTracer::connect_to_lights(const Paths&, const GlossyVertices&, FloatN, unsigned, int);
template void PathTracer::connect_to_lights(const Paths&, const PhongVertices&, FloatN, unsigned, int);
template void PathTracer::connect_to_lights(const Paths&, const SpecularVertices&, FloatN, unsigned, int);
template void PathTracer::connect_to_lights(const Paths&, const LayeredVertices&, FloatN, unsigned, int);
template void PathTracer::connect_to_lights(const Paths&, const GeneralVertices&, FloatN, unsigned, int);

void PathTracer::add_unoccluded(RenderCounters& counters, int depth) {
  const ColumnsView<const Connection> all = connections_.all();
  assert(all.size() <= kBatchPaths);
  counters.shadow_rays += all.size();
  scene_.occlusions(all.field(&Connection::ray), {occluded_.data(), all.size()});
  for (std::size_t i = 0; i < all.size(); ++i)
    if (occluded_[i] == accel::Occlusion::kNone)
      add(all.get(&Connection::path, i), all.get(&Connection::radiance, i), depth + 1,
          all.get(&Connection::light, i));
  if (!scene_.is_opaque()) add_transmitted(counters, depth);
  if (passes_panes_at(depth)) add_straight(counters, depth);
  connections_.clear();
}

// Adds the light of connections that partly transparent surfaces let through.
void PathTracer::add_transmitted(RenderCounters& counters, int depth) {
  Columns<Ray> rays;
  std::vector<Connection> of_rays;
  std::vector<Enclosure> enclosures;
  for (std::size_t i = 0; i < connections_.size(); ++i) {
    if (occluded_[i] != accel::Occlusion::kPartial) continue;
    of_rays.push_back(connections_[i]);
    rays.push(of_rays.back().ray);
    enclosures.push_back(depth == kAtLens ? Enclosure{} : enclosure(of_rays.back().path));
  }
  if (rays.size() == 0) return;
  std::vector<Rgb> shares(rays.size());
  counters.shadow_rays += find_transmittances(scene_, rays.all(), enclosures, shares);
  for (std::size_t k = 0; k < of_rays.size(); ++k)
    if (!is_black(shares[k]))
      add(of_rays[k].path, of_rays[k].radiance * shares[k], depth + 1, of_rays[k].light);
}

}  // namespace tessera::core::integrators
