// SPDX-License-Identifier: Apache-2.0
#include "core/integrators/environment_guide.hpp"

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <vector>

#include "core/base/parallel_errors.hpp"
#include "core/integrators/guide_building.hpp"
#include "core/integrators/opacity.hpp"
#include "core/integrators/panes.hpp"
#include "core/integrators/vertex.hpp"
#include "core/sampling/sampler.hpp"

namespace tessera::core::integrators {
namespace {

// Paths are traced in this many parts. The first one decides whether there is something to learn.
constexpr std::uint32_t kParts = 48;
constexpr int kVertices = 4;         // of a path
constexpr std::uint32_t kLooks = 8;  // light samples of a vertex
// There is no guide if more of the environment's light arrives: light samples find it well.
constexpr double kOpen = 0.3;
// Nor is a cell guided from which more is seen.
constexpr double kOpenCell = 0.5;
// A cell that is lit by much else is guided a little, since the estimate of its share is rough. At most every
// other light sample is guided: what else a cell's light comes from may not have been met while it was
// learnt, as a patch of sun.
constexpr float kMinGuidedShare = 0.02f, kMaxGuidedShare = 0.5f;
// Light that is sampled with a higher density comes from less than the finest square of directions that a
// guide distinguishes. It is left to the environment's own distribution.
constexpr float kConcentratedPdf = 800;

class Observer {
 public:
  Observer(const Scene& scene, const lights::LightSampler& lights, lights::MisCompensation compensation,
           bool through_panes)
      : scene_(scene), lights_(lights), compensation_(compensation), through_panes_(through_panes) {}

  // What a part of the paths has seen.
  struct Seen {
    double open = 0, arriving = 0;  // the environment's light, without and with what is in the way
    std::vector<guiding::Photon> photons{};
  };
  Seen trace(std::uint32_t first_path, std::uint32_t paths) const {
    Looks looks;
    for (std::uint32_t i = 0; i < paths; ++i) trace_path(first_path + i, looks);
    const std::vector<float> shares = arriving(looks);
    Seen seen;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      guiding::Photon& photon = looks.photons[i];
      seen.open += static_cast<double>(photon.flux);
      photon.flux *= shares[i];
      if (!(photon.flux > 0) || !std::isfinite(photon.flux)) continue;
      seen.arriving += static_cast<double>(photon.flux);
      seen.photons.push_back(photon);
    }
    return seen;
  }

  // The share of a cell with the least noise where a light sample finds either what the guide has learnt or
  // other light.
  float share(const guiding::CellLight& cell) const {
    double open = 0, seen = 0, others = 0;
    std::uint32_t n = cell.cell * static_cast<std::uint32_t>(cell.places.size()) * kLooks;
    for (const guiding::Photon& place : cell.places) {
      for (std::uint32_t k = 0; k < kLooks; ++k, ++n) {
        const sampling::Sampler sampler(kGuideSeed, 0, kCellRow, n);
        const auto u = sampler.pad(0);
        if (const auto light = look(place.side_normal, {u[0], u[1]})) {
          const double value = irradiance(*light, place.side_normal);
          open += value;
          seen += value * static_cast<double>(arriving(ray_from(place, *light)));
        }
        const double other = other_light(place, sampler.pad(1));
        others += other * other;
      }
    }
    if (seen > kOpenCell * open) return 0;
    const auto probes = static_cast<double>(cell.places.size() * kLooks);
    const double guided = seen / probes, other = std::sqrt(others / probes);
    return other > 0
               ? std::clamp(static_cast<float>(guided / (guided + other)), kMinGuidedShare, kMaxGuidedShare)
               : kMaxGuidedShare;
  }

 private:
  struct Looks {
    Columns<Ray> rays{};
    std::vector<guiding::Photon> photons{};
    std::vector<Enclosure> enclosures{};
  };

  void trace_path(std::uint32_t index, Looks& looks) const {
    const sampling::Sampler sampler(kGuideSeed, 0, kCameraPathRow, index);
    const RenderSettings& settings = scene_.settings();
    const auto u = sampler.pad(sampling::kCameraPad);
    Ray ray = scene_.with_camera(kGuideTime, [&](const Camera& camera) {
      return camera.ray<float>(
          {u[0] * static_cast<float>(settings.width_px), u[1] * static_cast<float>(settings.height_px)},
          settings.width_px, settings.height_px, {u[2], u[3]});
    });
    ray.time = kGuideTime;
    Enclosure enclosure;
    Rgb throughput = Rgb::gray(1);
    for (int depth = 0; depth < kVertices; ++depth) {
      const Met met = meet_by_chance(scene_, origin_at_depth(depth), ray, sampler,
                                     static_cast<std::uint64_t>(depth), enclosure);
      if (!met.hit.found()) return;
      const PathVertex vertex(scene_, met.ray, met.hit, enclosure.boundary);
      const lights::LightSampleContext place = vertex.light_context();
      if (!vertex.is_delta() && !(place.normal == Vec3{}))
        look_around(vertex, place, index * kVertices + static_cast<std::uint32_t>(depth), enclosure, looks);
      const auto v = sampler.pad(sampling::scatter_pad(depth));
      const auto next = vertex.sample({v[0], v[1]}, v[2]);
      if (!next) return;
      throughput *= next->weight;
      const float survival = std::min(1.0f, max_component(throughput));
      if (v[3] >= survival) return;
      throughput *= 1 / survival;
      ray = vertex.ray_along(next->wi);
    }
  }

  void look_around(const PathVertex& vertex, const lights::LightSampleContext& place, std::uint32_t number,
                   const Enclosure& enclosure, Looks& looks) const {
    for (std::uint32_t k = 0; k < kLooks; ++k) {
      const auto u = sampling::Sampler(kGuideSeed, 0, kLookRow, number * kLooks + k).pad(0);
      const auto light = look(place.normal, {u[0], u[1]});
      if (!light) continue;
      looks.rays.push(vertex.ray_toward(*light));
      looks.photons.push_back({place.position, place.normal, light->wi,
                               std::numeric_limits<float>::infinity(), irradiance(*light, place.normal), 0});
      looks.enclosures.push_back(enclosure);
    }
  }

  // A light sample of the environment, but for what is concentrated.
  std::optional<lights::LightSample> look(Vec3 normal, Vec2 u) const {
    const auto light = scene_.environment().sample(normal, u);
    if (!light || light->pdf > kConcentratedPdf || !(dot(normal, light->wi) > 0)) return std::nullopt;
    return light;
  }

  static float irradiance(const lights::LightSample& light, Vec3 normal) {
    return luminance(light.radiance) * std::max(0.0f, dot(normal, light.wi)) / light.pdf;
  }

  // The irradiance that a sample of the light sampler finds, but for what look() finds.
  float other_light(const guiding::Photon& place, const std::array<float, 4>& u) const {
    const lights::LightSampleContext point{place.position, place.side_normal};
    const auto light = sample_any_light(scene_, lights_, point, u, compensation_);
    if (!light) return 0;
    if (light->light == scene_.environment_light() &&
        scene_.environment().pdf(point.normal, light->wi) <= kConcentratedPdf)
      return 0;
    const float value = irradiance(*light, point.normal);
    return value > 0 && std::isfinite(value) ? value * arriving(ray_from(place, *light)) : 0;
  }

  // A shadow ray from the surface towards the light.
  Ray ray_from(const guiding::Photon& place, const lights::LightSample& light) const {
    const Vec3 origin = origin_above(place.position, place.side_normal);
    if (!light.point) return {origin, light.wi, std::numeric_limits<float>::infinity(), kGuideTime};
    return {origin, offset_origin(*light.point, origin - light.point->position) - origin, 1, kGuideTime};
  }

  // The share of the light that arrives along a shadow ray.
  float arriving(const Ray& ray) const {
    std::uint64_t uncounted = 0;
    const Rgb share = transmittance(scene_, ray, {}, uncounted);
    return is_black(share) ? through_panes(ray) : luminance(share);
  }
  // The same for all looks.
  std::vector<float> arriving(const Looks& looks) const {
    std::vector<accel::Occlusion> occluded(looks.rays.size());
    scene_.occlusions(looks.rays.all(), occluded);
    std::vector<float> shares(occluded.size());
    Columns<Ray> rays;
    std::vector<Enclosure> enclosures;
    for (std::size_t i = 0; i < shares.size(); ++i) {
      if (occluded[i] == accel::Occlusion::kNone) shares[i] = 1;
      if (occluded[i] == accel::Occlusion::kFull) shares[i] = through_panes(looks.rays[i]);
      if (occluded[i] != accel::Occlusion::kPartial) continue;
      rays.push(looks.rays[i]);
      enclosures.push_back(looks.enclosures[i]);
    }
    std::vector<Rgb> partial(rays.size());
    find_transmittances(scene_, rays.all(), enclosures, partial);
    std::size_t next = 0;
    for (std::size_t i = 0; i < shares.size(); ++i)
      if (occluded[i] == accel::Occlusion::kPartial) shares[i] = luminance(partial[next++]);
    return shares;
  }
  float through_panes(const Ray& ray) const {
    if (!through_panes_ || std::isfinite(ray.t_max)) return 0;
    RenderCounters uncounted;
    return luminance(straight_transmittance(scene_, ray, scene_.closest_hit(ray),
                                            static_cast<int>(PanePassage::kMaxSurfaces), uncounted));
  }

  const Scene& scene_;
  const lights::LightSampler& lights_;
  lights::MisCompensation compensation_;
  bool through_panes_;
};

}  // namespace

EnvironmentGuide build_environment_guide(const Scene& scene, const lights::LightSampler& lights,
                                         lights::MisCompensation compensation, bool through_panes,
                                         int threads, std::uint32_t camera_paths) {
  if (scene.environment_light() == lights::kNoLight) return {};
  const Observer observer(scene, lights, compensation, through_panes);
  std::vector<guiding::Photon> photons;
  double open = 0, arriving = 0;
  const std::uint32_t paths = camera_paths / kParts;
  const auto trace = [&](std::uint32_t first, std::uint32_t end) {
    std::vector<Observer::Seen> parts(end - first);
    ParallelErrors errors;
#pragma omp parallel for num_threads(threads) schedule(dynamic)
    for (std::uint32_t part = first; part < end; ++part)
      errors.run([&] { parts[part - first] = observer.trace(part * paths, paths); });
    errors.rethrow();
    for (const Observer::Seen& part : parts) {
      open += part.open;
      arriving += part.arriving;
      photons.insert(photons.end(), part.photons.begin(), part.photons.end());
    }
  };
  trace(0, 1);
  if (!(arriving > 0) || arriving > kOpen * open) return {};
  trace(1, kParts);
  const auto share = [&](const guiding::CellLight& cell) { return observer.share(cell); };
  return EnvironmentGuide(guiding::LightGuide::build(photons, share, threads));
}

}  // namespace tessera::core::integrators
