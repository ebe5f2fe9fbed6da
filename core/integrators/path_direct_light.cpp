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

// Samples a light for each vertex, and evaluates what the vertex reflects of it along the path.
template <typename Vertices>
void PathTracer::connect_to_lights(const Paths& paths, const Vertices& vertices, FloatN guide_share,
                                   unsigned lit, int depth) {
  const auto u = numbers(paths, depth, sampling::light_pad);
  const FloatLanes coarse(u[2]), fine(u[3]);
  std::array<double, kLaneCount> u_light;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane)
    u_light[lane] = combine_uniforms(coarse[lane], fine[lane]);
  const lights::LightSampleContexts light_contexts{vertices.position(), vertices.light_normal()};
  const auto choices = light_sampler_.sample(light_contexts, u_light, lit, compensation_);
  std::array<const lights::Light*, kLaneCount> chosen{};
  WordLanes of_lights;
  FloatLanes pmf;
  for (std::size_t lane = 0; lane < kLaneCount; ++lane) {
    const auto& [light, chance] = choices[lane];
    if ((lit >> lane & 1) != 0 && light != lights::kNoLight) chosen[lane] = &scene_.lights()[light];
    of_lights.set(lane, light);
    pmf.set(lane, chance);
  }
  const lights::LightSamples lights =
      sample_lights(chosen, scene_.textures(), light_contexts, {u[0], u[1]}, compensation_,
                    scene_.has_motion() ? paths.rays.all(&Ray::time) : 0.0f);
  const BsdfValueOf<FloatN> scattered = vertices.evaluate(lights.wi);
  const MaskN found = lights.found & !is_black(scattered.value);
  const FloatN light_pdf = pmf.all() * lights.pdf;
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
  added.put(&Connection::light, of_lights.all());
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
